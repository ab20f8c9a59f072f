// SPDX-License-Identifier: Apache-2.0
#include "ocio/lower.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/format_number.h"
#include "lut/fit.h"
#include "lut/half_domain.h"
#include "tonewright/engine.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr unsigned long kHalfCount = 65536;
constexpr double kSmallestHalf = 0x1p-24;

OCIO::MatrixTransformRcPtr make_matrix(const Matrix3& m) {
    std::array<double, 16> m44{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j)
            m44[4 * i + j] = m[i][j];
    }
    m44[15] = 1;
    OCIO::MatrixTransformRcPtr t = OCIO::MatrixTransform::Create();
    t->setMatrix(m44.data());
    return t;
}

OCIO::RangeTransformRcPtr make_range(double lo, double hi) {
    OCIO::RangeTransformRcPtr t = OCIO::RangeTransform::Create();
    // OCIO 2.1 writes whole numbers with a point behind them, "1e+18." too, which is no GLSL.
    // Tables over half floats hold at 65504 in any case.
    constexpr double largest = 1e15;
    if (lo > -largest) {
        t->setMinInValue(lo);
        t->setMinOutValue(lo);
    }
    if (hi < largest) {
        t->setMaxInValue(hi);
        t->setMaxOutValue(hi);
    }
    return t;
}

OCIO::FixedFunctionTransformRcPtr make_fixed(OCIO::FixedFunctionStyle style,
                                             OCIO::TransformDirection direction) {
    OCIO::FixedFunctionTransformRcPtr t = OCIO::FixedFunctionTransform::Create(style);
    t->setDirection(direction);
    return t;
}

OCIO::FixedFunctionTransformRcPtr make_fixed(const FixedFunction& function) {
    const auto style = OCIO::FixedFunctionStyleFromString((function.style).c_str());
    OCIO::FixedFunctionTransformRcPtr t =
        function.parameters.empty()
            ? OCIO::FixedFunctionTransform::Create(style)
            : OCIO::FixedFunctionTransform::Create(style, function.parameters.data(),
                                                   function.parameters.size());
    return t;
}

OCIO::Lut1DTransformRcPtr make_half_lut(const std::array<std::vector<float>, 3>& channels) {
    OCIO::Lut1DTransformRcPtr t = OCIO::Lut1DTransform::Create(kHalfCount, true);
    t->setInterpolation(OCIO::INTERP_LINEAR);
    t->setFileOutputBitDepth(OCIO::BIT_DEPTH_F32);
    for (unsigned long i = 0; i < kHalfCount; ++i) {
        t->setValue(i, channels[0][i], channels[1][i], channels[2][i]);
    }
    return t;
}

/// @param color  of node i, blue fastest
template <class F>
OCIO::Lut3DTransformRcPtr make_cube(unsigned long edge, const F& color) {
    OCIO::Lut3DTransformRcPtr cube = OCIO::Lut3DTransform::Create(edge);
    cube->setInterpolation(OCIO::INTERP_TETRAHEDRAL);
    cube->setFileOutputBitDepth(OCIO::BIT_DEPTH_F32);
    for (unsigned long i = 0; i < edge * edge * edge; ++i) {
        const Vector3 v = color(i);
        cube->setValue(i / (edge * edge), i / edge % edge, i % edge, static_cast<float>(v[0]),
                       static_cast<float>(v[1]), static_cast<float>(v[2]));
    }
    return cube;
}

/// Widest to narrowest of what stages so far let through, per channel.
struct Domain {
    double lo = -kHalfMax;
    double hi = kHalfMax;
};

/// Smallest power of two t such that limiting every channel to [0, t] moves no colour of a ramp to
/// 65504 (greys, primaries and secondaries, saturated and not) by more than a quarter of a 10-bit
/// code: where the operator saturates, a cube's nodes beyond would be wasted.
/// @param codes  light -> the code values that are stored, limited as behind the cube
double saturation_point(const Pipeline& codes) {
    const ReferenceEngine engine(codes);
    const auto moved = [&](double top) {
        double worst = 0;
        for (int direction = 1; direction < 8; ++direction) {
            for (const double low : {0.0, 0.1, 0.5}) {
                for (double light = top; light <= kHalfMax; light *= 2) {
                    Vector3 v{};
                    Vector3 limited{};
                    for (std::size_t c = 0; c < 3; ++c) {
                        v[c] = (direction >> c & 1) ? light : low * light;
                        limited[c] = std::min(v[c], top);
                    }
                    const Vector3 a = engine(v);
                    const Vector3 b = engine(limited);
                    for (std::size_t c = 0; c < 3; ++c)
                        worst = std::max(worst, std::fabs(a[c] - b[c]));
                }
            }
        }
        return worst;
    };
    double top = 1;
    while (top < 65536 && moved(top) > 0.25 / 1023)
        top *= 2;
    return std::min(top, kHalfMax);
}

/// A cube: where light stands on its axes, and what its nodes hold.
struct Cube {
    CubeAxis axis;
    std::vector<double> nodes;
};

/// The cube of a problem whose axis is not chosen yet; of one asked for before, what was computed
/// then.
/// @param top  of the axis
std::shared_ptr<const Cube> cube_of(CubeProblem problem, double top, bool is_fitted) {
    struct Entry {
        std::array<Expr, 3> codes;  // equal expressions are the same node, as long as one lives
        double lo, hi, top;
        int edge;
        bool is_fitted;
        Primaries primaries;
        std::shared_ptr<const Cube> cube;
    };
    static std::mutex mutex;
    static std::vector<Entry> entries;
    const std::array<Expr, 3> codes = compose(problem.pipeline);
    const std::lock_guard lock(mutex);
    for (const Entry& e : entries) {
        if (std::equal(e.codes.begin(), e.codes.end(), codes.begin(), same) && e.lo == problem.lo &&
            e.hi == problem.hi && e.top == top && e.edge == problem.edge &&
            e.is_fitted == is_fitted && e.primaries == problem.primaries)
            return e.cube;
    }
    problem.axis = is_fitted ? choose_log_axis(problem, top) : make_log_axis(top, problem.edge);
    const auto cube = std::make_shared<const Cube>(
        Cube{problem.axis, is_fitted ? fit_cube(problem) : sample_cube(problem)});
    entries.push_back(
        {codes, problem.lo, problem.hi, top, problem.edge, is_fitted, problem.primaries, cube});
    return cube;
}

class Lowering {
  public:
    explicit Lowering(const LowerOptions& options) : options_(options) {
        result_.transform = OCIO::GroupTransform::Create();
    }

    void matrix(const Matrix3& m) {
        flush_curves();
        emit(make_matrix(m), "matrix");
        double largest_sum = 0;
        bool adds_only = domain_.lo >= 0;
        for (const auto& row : m) {
            adds_only = adds_only && std::min({row[0], row[1], row[2]}) >= 0;
            largest_sum = std::max(largest_sum, row[0] + row[1] + row[2]);
        }
        domain_ = adds_only ? Domain{0, std::min(largest_sum * domain_.hi, kHalfMax)} : Domain{};
    }

    void clamp(double lo, double hi) {
        flush_curves();
        // NaN must not survive the first clamp: Range takes it to its lower end, if it has one.
        emit(make_range(lo, hi), "range");
        domain_.lo = std::max(domain_.lo, lo);
        domain_.hi = std::min(domain_.hi, hi);
    }

    void curve(const std::array<Expr, 3>& f) {
        if (!pending_) {
            pending_ = f;
            return;
        }
        for (std::size_t c = 0; c < 3; ++c) {
            (*pending_)[c] = substitute(f[c], std::span(&(*pending_)[c], 1));
        }
    }

    void tone_scale(const ToneScaleStage& stage) {
        flush_curves();
        const Expr x = Expr::input();
        // The norm of what the domain holds is in the domain too (weights of a luminance sum to 1).
        // Of light, hue and saturation are in [0, 1], and so are x and y.
        const auto identity = domain_.lo >= 0 ? sample_half_domain(x, 0, 1)
                                              : sample_half_domain(x, -kHalfMax, kHalfMax);
        const auto f = sample_half_domain(stage.f, std::max(domain_.lo, 0.0), domain_.hi);
        const auto lut = make_half_lut({identity, identity, f});
        if (stage.norm == ToneScaleStage::Norm::max_rgb) {
            // HSV of a negative channel loses it.
            if (!(domain_.lo >= 0)) {
                throw Error(
                    "ocio: tone scale on the largest channel without a clamp at 0 before it");
            }
            emit(make_fixed(OCIO::FIXED_FUNCTION_RGB_TO_HSV, OCIO::TRANSFORM_DIR_FORWARD), "HSV");
            emit(lut, "half LUT on V");
            emit(make_fixed(OCIO::FIXED_FUNCTION_RGB_TO_HSV, OCIO::TRANSFORM_DIR_INVERSE),
                 "HSV inverse");
        } else {
            // xyY scales all three by Y'/Y whatever the other two rows are; of the bases tried,
            // this one cancels least in 1-x-y and in the matrix back.
            const Matrix3 basis = {
                {{0.5, 0, 0}, {stage.weights[0], stage.weights[1], stage.weights[2]}, {0, 0, 1}}};
            emit(make_matrix(basis), "matrix to (R/2, L, B)");
            emit(make_fixed(OCIO::FIXED_FUNCTION_XYZ_TO_xyY, OCIO::TRANSFORM_DIR_FORWARD), "xyY");
            emit(lut, "half LUT on Y");
            emit(make_fixed(OCIO::FIXED_FUNCTION_XYZ_TO_xyY, OCIO::TRANSFORM_DIR_INVERSE),
                 "xyY inverse");
            emit(make_matrix(inverse(basis)), "matrix back");
        }
        // A channel is at most the norm divided by its weight; so is what it is scaled to.
        const auto largest = static_cast<double>(*std::max_element(f.begin(), f.end()));
        const double weight = stage.norm == ToneScaleStage::Norm::max_rgb
                                  ? 1
                                  : *std::min_element(stage.weights.begin(), stage.weights.end());
        domain_ = domain_.lo >= 0 && weight > 0 ? Domain{0, largest / weight} : Domain{};
    }

    void hue_preserving(const HuePreservingStage& stage) {
        flush_curves();
        if (!(domain_.lo >= 0)) {
            throw Error("ocio: hue-preserving curve without a clamp at 0 before it");
        }
        // OCIO's shader turns the hue around where the curve falls, its CPU path does not.
        if (!is_rising(sample_half_domain(stage.f, domain_.lo, domain_.hi), domain_)) {
            map3({apply_stage(stage, {Expr::input(0), Expr::input(1), Expr::input(2)})});
            return;
        }
        // HUE_DW3: OCIO looks up the largest and the smallest channel and puts the middle one where
        // it was between them. The place between them does not change with a gain.
        emit_curve({stage.f, stage.f, stage.f}, OCIO::HUE_DW3);
    }

    void hexcone(const HexconeStage& stage);

    void lattice(const LatticeStage& stage) {
        // OCIO limits what enters a cube to [0, 1] as the lattice does; between half floats such a
        // corner would be blunt.
        curve({stage.shaper, stage.shaper, stage.shaper});
        flush_curves();
        const auto edge = static_cast<unsigned long>(stage.lattice->edge());
        const std::vector<double>& nodes = stage.lattice->nodes();
        emit(make_cube(edge,
                       [&](unsigned long i) {
                           return Vector3{nodes[3 * i], nodes[3 * i + 1], nodes[3 * i + 2]};
                       }),
             std::to_string(edge) + "^3 lattice");
        // Powers of two: lattices of about the same numbers share the tables behind them.
        const auto [lo, hi] = std::minmax_element(nodes.begin(), nodes.end());
        const auto outwards = [](double x) {
            return x > 0 ? std::exp2(std::ceil(std::log2(x))) : 0.0;
        };
        const double largest = outwards(std::max(-*lo, *hi));
        domain_ = {*lo < 0 ? -largest : 0, largest};
    }

    /// @param behind  what limits the result: outside of it the cube may hold anything
    void map3(const CrossTalkStage& stage, const ClampStage& behind = {-kInfinity, kInfinity}) {
        flush_curves();
        if (!stage.ocio.empty()) {
            for (const FixedFunction& function : stage.ocio)
                emit(make_fixed(function), function.style);
            result_.is_exact = result_.is_exact && stage.is_ocio_exact;
            domain_ = {};
            return;
        }
        result_.loses_negatives = result_.loses_negatives || !(domain_.lo >= 0);
        const Expr x = Expr::input();
        const Expr code = srgb_encode(x);  // smooth, signed: negatives follow the straight part
        CubeProblem problem;
        problem.edge = options_.cube_edge;
        problem.pipeline = {stage, curve_stage(code)};
        problem.primaries = options_.primaries;
        const double lo = std::max(behind.lo, -kHalfMax);
        const double hi = std::min(behind.hi, kHalfMax);
        problem.lo = evaluate(code, lo);
        problem.hi = evaluate(code, hi);
        // A fitted cube may hold anything where the display clips; for a sampled one the corners
        // of the clip would be a fault like any other.
        Pipeline seen = problem.pipeline;
        if (stage.is_cube_fitted) seen.insert(seen.begin() + 1, ClampStage{lo, hi});
        const double top = std::min(saturation_point(seen), domain_.hi);
        const auto cube = cube_of(problem, top, stage.is_cube_fitted);

        const auto shaper = sample_half_domain(cube->axis.place, 0, top);
        emit(make_range(0, top), "range");
        emit(make_half_lut({shaper, shaper, shaper}), "half LUT shaper");
        const std::vector<double>& nodes = cube->nodes;
        emit(make_cube(static_cast<unsigned long>(problem.edge),
                       [&](unsigned long i) {
                           return Vector3{nodes[3 * i], nodes[3 * i + 1], nodes[3 * i + 2]};
                       }),
             std::to_string(problem.edge) + "^3 cube to " + shortest(top) +
                 (stage.is_cube_fitted ? ", fitted" : ""));
        result_.is_exact = false;
        domain_ = {};
        curve({srgb_decode(x), srgb_decode(x), srgb_decode(x)});
    }

    Lowered finish() {
        flush_curves();
        return result_;
    }

  private:
    void emit(const OCIO::TransformRcPtr& transform, const std::string& what) {
        result_.transform->appendTransform(transform);
        note(what);
    }

    void note(const std::string& what) {
        result_.summary += (result_.summary.empty() ? "" : ", ") + what;
    }

    void flush_curves() {
        if (!pending_) return;
        const std::array<Expr, 3> f = *pending_;
        pending_.reset();
        emit_curve(f, OCIO::HUE_NONE);
    }

    void emit_curve(std::array<Expr, 3> f, OCIO::Lut1DHueAdjust hue) {
        Domain domain = domain_;
        // Where the slope at black is infinite (the power of a display), the first cells of a table
        // over half floats are too coarse. Their exponents go much further below 1 than above what
        // this curve is given, so the curve moves up: a power of two loses nothing.
        const double gain = std::exp2(std::floor(std::log2(kHalfMax / domain.hi)));
        if (domain.lo >= 0 && gain > 1 && is_steep_at_black(f)) {
            emit(make_matrix(scale(kIdentity3, gain)), "scale");
            const Expr scaled = Expr::input() / gain;
            for (Expr& channel : f)
                channel = substitute(channel, std::span(&scaled, 1));
            domain = {domain.lo * gain, domain.hi * gain};
        }
        std::array<std::vector<float>, 3> tables;
        for (std::size_t c = 0; c < 3; ++c) {
            const bool known = c > 0 && same(f[c], f[0]);
            tables[c] = known ? tables[0] : sample_half_domain(f[c], domain.lo, domain.hi);
        }
        const OCIO::Lut1DTransformRcPtr lut = make_half_lut(tables);
        lut->setHueAdjust(hue);
        emit(lut, hue == OCIO::HUE_DW3 ? "half LUT keeping hue" : "half LUT");
        domain_ = {kHalfMax, -kHalfMax};
        for (const std::vector<float>& table : tables) {
            const auto [lo, hi] = std::minmax_element(table.begin(), table.end());
            domain_.lo = std::min(domain_.lo, static_cast<double>(*lo));
            domain_.hi = std::max(domain_.hi, static_cast<double>(*hi));
        }
    }

    /// From half float to half float of the domain, but for rounding.
    static bool is_rising(const std::vector<float>& table, const Domain& domain) {
        double largest = -kInfinity;
        for (unsigned bits = 0; bits <= 0x7BFF; ++bits) {
            if (half_value(bits) < domain.lo || half_value(bits) > domain.hi) continue;
            const auto y = static_cast<double>(table[bits]);
            if (y < largest - 1e-6 * std::max(1.0, std::fabs(largest))) return false;
            largest = std::max(largest, y);
        }
        return true;
    }

    static bool is_steep_at_black(const std::array<Expr, 3>& f) {
        constexpr double kSteep = 64;  // sRGB has 12.92, a 2.2 power 5000
        return std::any_of(f.begin(), f.end(), [&](const Expr& channel) {
            return evaluate(derivative(channel), kSmallestHalf) > kSteep;
        });
    }

    LowerOptions options_;
    Lowered result_;
    Domain domain_;
    std::optional<std::array<Expr, 3>> pending_;
};

// ---------------------------------------------------------------------------------------------
// Hexcone

// Works on OCIO's hue, saturation and value. Hue passes through; of the other two channels every
// step is a table of each or a matrix that adds one to the other, so a product is a sum of
// logarithms.
//
// OCIO's shader finds the place in a half-domain table with a float between 0 and 65536 that grows
// with the input's exponent and, by half of that, with a negative sign: numbers are kept positive
// and small where precision counts.

/// What a stop is in a channel.
constexpr double kStop = 0x1p-8;

/// A number for every half float, in the order of the bit patterns.
using Column = std::vector<double>;

/// The half floats themselves; NaN as 0, infinities as the largest.
const Column& halves() {
    static const Column all = [] {
        Column column(kHalfCount);
        for (unsigned bits = 0; bits < kHalfCount; ++bits)
            column[bits] = sanitise(half_value(bits));
        return column;
    }();
    return all;
}

template <class F>
Column map(const Column& in, const F& f) {
    Column out(in.size());
    std::transform(in.begin(), in.end(), out.begin(), f);
    return out;
}

Column map(const Column& in, const Expr& f) {
    Column out(in.size());
    ReferenceEngine({curve_stage(f)})
        .run({in.data(), in.data(), in.data()}, {out.data(), out.data(), out.data()}, in.size());
    return out;
}

std::vector<float> to_table(const Column& column) {
    std::vector<float> table(column.begin(), column.end());
    table[0x8000] = table[0];
    return table;
}

/// The table, which is asked for nothing outside [lo, hi] and holds the values at the ends there:
/// as short numbers, for smaller files. The next half float on either side is interpolated with.
std::vector<float> with_short_ends(std::vector<float> table, double lo, double hi) {
    const Column& x = halves();
    const auto is_outside = [&](unsigned bits) { return x[bits] < lo || x[bits] > hi; };
    for (unsigned bits = 1; bits < kHalfCount; ++bits) {
        const bool is_next =
            !is_outside(bits - 1) || (bits + 1 < kHalfCount && !is_outside(bits + 1));
        if (is_outside(bits) && !is_next && bits != 0x8000)
            table[bits] = std::strtof(fmt::format("{:.3g}", table[bits]).c_str(), nullptr);
    }
    return table;
}

/// A table of f, which is asked for nothing outside [lo, hi]: there the value at the end is held.
template <class F>
std::vector<float> table_of(double lo, double hi, const F& f) {
    return with_short_ends(
        to_table(map(halves(), [&](double x) { return f(std::clamp(x, lo, hi)); })), lo, hi);
}

/// Light in stops below `unit`: positive where it is darker. Below the smallest half float, where a
/// table is a straight line to black, so is the scale: there and back is the same.
class Stops {
  public:
    /// @param to_black  stops from the smallest half float to black
    Stops(double unit, double to_black)
        : unit_(unit), last_(std::log2(unit / kSmallestHalf)), to_black_(to_black) {}

    [[nodiscard]] double of(double light) const {
        return light >= kSmallestHalf
                   ? std::log2(unit_ / light)
                   : last_ + to_black_ * (1 - std::max(light, 0.0) / kSmallestHalf);
    }
    [[nodiscard]] double light(double stops) const {
        // Black comes some cells of a table earlier, so that there no light is interpolated in.
        return stops <= last_
                   ? unit_ * std::exp2(-stops)
                   : kSmallestHalf * std::max(0.0, 1 - (stops - last_) / (to_black_ - 0x1p-4));
    }
    /// Of the smallest half float.
    [[nodiscard]] double last() const { return last_; }

  private:
    double unit_;
    double last_;
    double to_black_;
};

/// Adds a function h of the channel `value` to another channel, and keeps `value`, with a strictly
/// monotone function of it, n(value) = sign (k value + h(value)): to the other, times sign, add n;
/// n -> value; take times sign again, and subtract k value.
struct AddedFunction {
    double k = 0;
    double sign = 1;              // such that n falls: it is positive where value is negative
    std::vector<float> forward;   // value -> n
    std::vector<float> backward;  // n -> value

    /// `value` as the tables give it back: near the half floats, if n is steep enough.
    [[nodiscard]] Column round_trip() const {
        Lut lut;
        lut.dimension = 1;
        lut.size = static_cast<int>(kHalfCount);
        lut.channels = 1;
        lut.is_half_domain = true;
        lut.values = backward;
        return map(Column(forward.begin(), forward.end()), [&](double n) {
            return interpolate(lut, {n, n, n})[0];
        });
    }
};

/// @param h       of the half floats.
/// @param lo, hi  where `value` is; half floats beyond, by one stop, are in the tables, too.
/// @param margin  least slope of n. The flatter n is somewhere, the coarser is its inverse there;
///                the larger k is, the coarser is the sum that k value is subtracted from.
AddedFunction add_function(const Column& h, double lo, double hi, double margin) {
    const Column& value = halves();
    std::vector<unsigned> ascending;
    const auto take = [&](unsigned bits) {
        if (value[bits] >= lo - kStop && value[bits] <= hi + kStop) ascending.push_back(bits);
    };
    for (unsigned bits = 0xFBFF; bits > 0x8000; --bits)
        take(bits);
    for (unsigned bits = 0; bits <= 0x7BFF; ++bits)
        take(bits);

    double steepest = 0;
    double least = 0;
    for (std::size_t i = 1; i < ascending.size(); ++i) {
        const unsigned a = ascending[i - 1];
        const unsigned b = ascending[i];
        const double slope = (h[b] - h[a]) / (value[b] - value[a]);
        steepest = std::max(steepest, slope);
        least = std::min(least, slope);
    }
    AddedFunction result;
    result.k = steepest <= -least ? -steepest - margin : margin - least;
    result.sign = result.k < 0 ? 1 : -1;
    Column n(kHalfCount);
    for (unsigned bits = 0; bits < kHalfCount; ++bits) {
        n[bits] =
            result.sign * (result.k * std::clamp(value[bits], lo - kStop, hi + kStop) + h[bits]);
    }
    result.forward = with_short_ends(to_table(n), lo - kStop, hi + kStop);

    // The inverse of what the table holds, its float roundings included.
    std::vector<std::pair<double, double>> pairs;
    pairs.reserve(ascending.size());
    for (const unsigned bits : ascending)
        pairs.emplace_back(static_cast<double>(result.forward[bits]), value[bits]);
    std::reverse(pairs.begin(), pairs.end());
    const auto is_less = [](const auto& a, const auto& b) { return a.first < b.first; };
    result.backward = table_of(pairs.front().first, pairs.back().first, [&](double x) {
        const auto [first, last] =
            std::equal_range(pairs.begin(), pairs.end(), std::pair(x, 0.0), is_less);
        if (first != last) return (first->second + (last - 1)->second) / 2;
        const auto& [x0, y0] = *(first - 1);
        const auto& [x1, y1] = *first;
        return y0 + (x - x0) / (x1 - x0) * (y1 - y0);
    });
    return result;
}

/// Where value or chroma bend most. Half floats are finest around 0, so stops are counted from
/// there.
double sharpest_bend(const HexconeStage& stage) {
    double best = 1;
    double sharpest = -1;
    for (const Expr& f : {stage.value, stage.chroma}) {
        const Expr slope = derivative(f);
        for (const double x : kinks(f, 0x1p-8, 0x1p8)) {
            const double jump =
                std::fabs(evaluate(slope, x * (1 + 0x1p-30)) - evaluate(slope, x * (1 - 0x1p-30)));
            const double bend = jump > 1e-6 ? jump : 0;  // less is rounding
            if (!(bend > sharpest)) continue;
            sharpest = bend;
            best = x;
        }
    }
    return best;
}

/// What a hexcone stage does, for every half float of a channel that holds stops of p.
///
/// With m for what the offset leaves of the smallest channel, saturation is (p - m)/p; it becomes
/// (p - m) chroma/value, so it is multiplied by chroma p/value: in stops, it loses.
struct HexconeColumns {
    Stops stops;
    Column p;
    Column value;
    Column loss;
};

constexpr double kNone = 64;     // stops below 1 of what is 0
constexpr double kAllLost = 22;  // stops below 1 of a saturation that counts as 0

/// @param hi      largest value of a channel.
/// @throws Error  when a channel would become negative, which HSV does not show.
HexconeColumns columns_of(const HexconeStage& stage, double hi) {
    const Stops stops(sharpest_bend(stage), 16);
    // Behind the clamp the functions go on for a cell of the tables, where they can: or the kink of
    // holding the value at the end would show inside.
    double top = std::min(hi * std::exp2(std::fabs(stops.of(hi)) * 0x1p-9), kHalfMax);
    if (!std::isfinite(evaluate(stage.value, top)) || !std::isfinite(evaluate(stage.chroma, top)))
        top = hi;
    const auto light = [&](double x) { return std::min(stops.light(x / kStop), top); };
    // Below the smallest half float p is a straight line to 0, where there is no saturation.
    const auto seen = [&](double x) { return std::max(light(x), kSmallestHalf); };
    HexconeColumns result = {stops, map(halves(), light), map(map(halves(), light), stage.value),
                             Column(kHalfCount, kAllLost)};
    const Column p = map(halves(), seen);
    const Column value = map(p, stage.value);
    const Column chroma = map(p, stage.chroma);
    for (unsigned bits = 0; bits < kHalfCount; ++bits) {
        const double kept = chroma[bits] * p[bits];
        if (!(kept >= 0 && kept <= value[bits] * (1 + 1e-9))) {
            throw Error("ocio: hexcone stage that makes negative light of p = " +
                        shortest(p[bits]) + "; expected 0 <= chroma(p) p <= value(p)");
        }
        if (kept > 0) result.loss[bits] = std::clamp(std::log2(value[bits] / kept), 0.0, kAllLost);
    }
    return result;
}

/// The loss as a function that can be added.
/// @throws Error  when it is too steep, up and down: no k gives an n that its table inverts.
AddedFunction add_loss(const HexconeColumns& columns, const HexconeStage& stage, double at_bend,
                       double hi) {
    const Column h = map(columns.loss, [&](double x) { return kStop * (x - at_bend); });
    const double brightest = kStop * columns.stops.of(hi);
    for (const double margin : {0.125, 0.5, 2.0}) {
        AddedFunction added = add_function(h, brightest, kStop * columns.stops.of(0), margin);
        const Column back = added.round_trip();
        const Column light =
            map(back, [&](double x) { return std::min(columns.stops.light(x / kStop), hi); });
        const Column value = map(light, stage.value);
        bool is_good = true;
        for (unsigned bits = 0; bits < kHalfCount; ++bits) {
            // The loss bends where the domain ends; next to it nothing is tested.
            const double x = halves()[bits];
            if (x < brightest + kStop / 8 || columns.p[bits] < kSmallestHalf) continue;
            constexpr double kTolerance = 4e-6;
            const double stops = added.k * (back[bits] - x) / kStop;
            const double wanted = columns.value[bits];
            is_good = is_good && std::fabs(stops) * std::exp2(-columns.loss[bits]) <= kTolerance &&
                      std::fabs(value[bits] - wanted) <= kTolerance * std::max(1.0, wanted);
        }
        if (is_good) return added;
    }
    throw Error(
        "ocio: hexcone stage whose chroma p/value goes up and down too steeply; expected it to be "
        "smoother");
}

void Lowering::hexcone(const HexconeStage& stage) {
    flush_curves();
    if (!(domain_.lo >= 0)) throw Error("ocio: hexcone stage without a clamp at 0 before it");
    const HexconeColumns columns = columns_of(stage, domain_.hi);
    // n is 0 where half floats are finest; unless all is lost at that place.
    const double at_bend = std::min(columns.loss[0], 1.0);
    const AddedFunction added = add_loss(columns, stage, at_bend, domain_.hi);

    // Each table reaches as far as it is used, and some more.
    const auto same_number = [](double x) { return x; };
    const std::vector<float> hue = table_of(0, 1, same_number);
    int luts = 0;
    const auto lut = [&](const std::vector<float>& s, const std::vector<float>& v) {
        result_.transform->appendTransform(make_half_lut({s, v, hue}));
        ++luts;
    };
    // What saturation and value become of themselves and each other.
    const auto mix = [&](double ss, double sv, double vs, double vv, double s_offset = 0) {
        const OCIO::MatrixTransformRcPtr m = make_matrix({{{ss, sv, 0}, {vs, vv, 0}, {0, 0, 1}}});
        m->setOffset(std::array{s_offset, 0.0, 0.0, 0.0}.data());
        result_.transform->appendTransform(m);
    };
    constexpr double kUnseen = 48;  // stops below 1 of what has no effect
    const auto lost = [&](double s) {
        return added.sign * kStop * (s > 0 ? -std::log2(s) : kNone);
    };
    const std::vector<float> to_p_stops =
        table_of(0, kHalfMax, [&](double x) { return columns.stops.of(x); });

    emit(make_fixed(OCIO::FIXED_FUNCTION_RGB_TO_HSV, OCIO::TRANSFORM_DIR_FORWARD), "HSV");
    // Saturation, value, hue: where OpenColorIO 2.1 inverts a falling half-domain table, it makes 0
    // of all that is negative in the third channel. Hue is not.
    const Matrix3 hue_last = {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}};
    result_.transform->appendTransform(make_matrix(hue_last));
    if (stage.offset.is_constant(0)) {
        // (saturation, p) -> stops -> (stops of saturation, n). One table from p to n would be
        // coarser.
        lut(table_of(0, 1, lost), to_p_stops);
        mix(1, 0, 0, kStop);
        lut(table_of(-kNone * kStop, kNone * kStop, same_number), added.forward);
    } else {
        // (saturation, value) = (1 - min/max, max) -> (min/max, max)
        mix(-1, 0, 0, 1, 1);
        // -> stops -> (stops of min, stops of max) -> (min, max)
        const Stops stops(1, 1);
        const auto to_stops = [&](double x) { return kStop * stops.of(x); };
        lut(table_of(0, 1, [&](double x) { return x > 0 ? to_stops(x) : kStop * kNone; }),
            table_of(0, kHalfMax, to_stops));
        mix(1, 1, 0, 1);
        const std::vector<float> to_light = table_of(
            -17 * kStop, kUnseen * kStop, [&](double x) { return stops.light(x / kStop); });
        lut(to_light, to_light);
        // -> (min, max - min) -> (m, max - min) -> (m, p)
        mix(1, 0, -1, 1);
        lut(sample_half_domain(Expr::input() - stage.offset, 0, domain_.hi),
            table_of(0, kHalfMax, same_number));
        mix(1, 0, 1, 1);
        // -> stops -> (stops of m/p, stops of p)
        lut(to_p_stops, to_p_stops);
        mix(1, -1, 0, kStop);
        // -> (stops of saturation, n)
        lut(table_of(0, kUnseen, [&](double x) { return lost(-std::expm1(-x * std::log(2.0))); }),
            added.forward);
    }
    // -> (stops of saturation + n, n) -> (stops of saturation + loss, stops of p)
    mix(1, 1, 0, 1);
    const double largest = kStop * kNone * (2 + std::fabs(added.k));
    lut(table_of(-largest, largest, same_number), added.backward);
    mix(added.sign, -added.k, 0, 1);
    // -> (saturation, value)
    lut(table_of(-kStop, kAllLost * kStop,
                 [&](double x) {
                     const double stops = at_bend + x / kStop;
                     return stops < kAllLost - 0.5 ? std::exp2(-std::max(stops, 0.0)) : 0;
                 }),
        to_table(columns.value));
    result_.transform->appendTransform(make_matrix(inverse(hue_last)));
    note(std::to_string(luts) + " half LUTs with matrices between");
    emit(make_fixed(OCIO::FIXED_FUNCTION_RGB_TO_HSV, OCIO::TRANSFORM_DIR_INVERSE), "HSV inverse");
    domain_ = {};
}

}  // namespace

Lowered lower_to_ocio(const Pipeline& pipeline, const LowerOptions& options) {
    Lowering lowering(options);
    const Pipeline stages = simplify(pipeline);
    for (std::size_t i = 0; i < stages.size(); ++i) {
        const Stage& stage = stages[i];
        if (const auto* m = std::get_if<MatrixStage>(&stage)) lowering.matrix(m->m);
        if (const auto* c = std::get_if<ClampStage>(&stage)) lowering.clamp(c->lo, c->hi);
        if (const auto* c = std::get_if<CurveStage>(&stage)) lowering.curve(c->f);
        if (const auto* t = std::get_if<ToneScaleStage>(&stage)) lowering.tone_scale(*t);
        if (const auto* h = std::get_if<HuePreservingStage>(&stage)) lowering.hue_preserving(*h);
        if (const auto* h = std::get_if<HexconeStage>(&stage)) lowering.hexcone(*h);
        if (const auto* m = std::get_if<CrossTalkStage>(&stage)) {
            const auto* behind =
                i + 1 < stages.size() ? std::get_if<ClampStage>(&stages[i + 1]) : nullptr;
            lowering.map3(*m, behind ? *behind : ClampStage{-kInfinity, kInfinity});
        }
        if (const auto* l = std::get_if<LatticeStage>(&stage)) lowering.lattice(*l);
    }
    return lowering.finish();
}

OcioCpu::OcioCpu(const OCIO::ConstProcessorRcPtr& processor, OCIO::OptimizationFlags flags)
    : cpu_(processor->getOptimizedCPUProcessor(flags)) {}

void OcioCpu::run_rgb(const float* in, float* out, std::size_t pixel_count) const {
    constexpr std::size_t kChunk = std::size_t{1} << 20;
    std::copy_n(in, 3 * pixel_count, out);
    for (std::size_t begin = 0; begin < pixel_count; begin += kChunk) {
        const std::size_t n = std::min(kChunk, pixel_count - begin);
        OCIO::PackedImageDesc image(out + 3 * begin, static_cast<long>(n), 1, 3);
        cpu_->apply(image);
    }
}

OCIO::ConstProcessorRcPtr make_processor(const Lowered& lowered) {
    OCIO::ConfigRcPtr config = OCIO::Config::CreateRaw()->createEditableCopy();
    config->setProcessorCacheFlags(OCIO::PROCESSOR_CACHE_OFF);
    return config->getProcessor(lowered.transform);
}

TONEWRIGHT_NAMESPACE_END
