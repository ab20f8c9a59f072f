// SPDX-License-Identifier: Apache-2.0
#include "ocio/lower.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/format_number.h"
#include "lut/half_domain.h"
#include "ocio/aces_20/hue_cube.h"
#include "ocio/cross_talk_cube.h"
#include "ocio/fixed_functions.h"
#include "ocio/hexcone.h"
#include "pipeline/hue_structure.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Range of each channel after the stages so far.
struct Domain {
    double lo = -kHalfMax;
    double hi = kHalfMax;
};

constexpr ClampStage kUnlimited = {-kInfinity, kInfinity};

class Lowering {
  public:
    explicit Lowering(const LowerOptions& options) : options_(options) {}

    Lowered run(const Pipeline& stages) {
        for (std::size_t i = 0; i < stages.size(); ++i) {
            const auto* clamp =
                i + 1 < stages.size() ? std::get_if<ClampStage>(&stages[i + 1]) : nullptr;
            behind_ = clamp ? *clamp : kUnlimited;
            std::visit([&](const auto& stage) { lower(stage); }, stages[i]);
        }
        flush_curves();
        return std::move(result_);
    }

  private:
    void lower(const MatrixStage& stage) {
        flush_curves();
        emit(MatrixOp{stage.m}, "matrix");
        double largest_sum = 0;
        bool adds_only = domain_.lo >= 0;
        for (const auto& row : stage.m) {
            adds_only = adds_only && std::min({row[0], row[1], row[2]}) >= 0;
            largest_sum = std::max(largest_sum, row[0] + row[1] + row[2]);
        }
        domain_ = adds_only ? Domain{0, std::min(largest_sum * domain_.hi, kHalfMax)} : Domain{};
    }

    void lower(const ClampStage& stage) {
        flush_curves(stage);
        // NaN must not survive the first clamp: Range maps it to its lower end, if it has one.
        emit(RangeOp{stage.lo, stage.hi}, "range");
        domain_.lo = std::max(domain_.lo, stage.lo);
        domain_.hi = std::min(domain_.hi, stage.hi);
    }

    /// Equidistant tables over [0, 1] that are the whole curve: a half LUT would round their
    /// corners.
    static std::array<const Table*, 3> tables_of(const CurveStage& stage) {
        std::array<const Table*, 3> tables{};
        for (std::size_t c = 0; c < 3; ++c) {
            const Expr& f = stage.f[c];
            if (f.op() != ExprOp::lookup || !same(f.operand(0), Expr::input())) return {};
            tables[c] = f.table().get();
            const bool is_alike = tables[c]->positions.empty() &&
                                  tables[c]->interpolation == Table::Interpolation::linear &&
                                  tables[c]->samples.size() == tables[0]->samples.size();
            if (!is_alike) return {};
        }
        return tables;
    }

    void emit_tables(const std::array<const Table*, 3>& tables) {
        flush_curves();
        std::array<std::vector<float>, 3> values;
        domain_ = {kHalfMax, -kHalfMax};
        for (std::size_t c = 0; c < 3; ++c) {
            const std::vector<double>& samples = tables[c]->samples;
            values[c].assign(samples.begin(), samples.end());
            const auto [lo, hi] = std::minmax_element(samples.begin(), samples.end());
            domain_ = {std::min(domain_.lo, *lo), std::max(domain_.hi, *hi)};
        }
        Lut1DOp lut = lut_1d(values);
        lut.is_half_domain = false;
        emit(std::move(lut), "1D table");
    }

    void lower(const CurveStage& stage) {
        if (const auto tables = tables_of(stage); tables[0]) {
            emit_tables(tables);
            return;
        }
        if (!pending_) {
            pending_ = stage.f;
            return;
        }
        for (std::size_t c = 0; c < 3; ++c)
            (*pending_)[c] = substitute(stage.f[c], std::span(&(*pending_)[c], 1));
    }

    void lower(const ToneScaleStage& stage) {
        flush_curves();
        if (auto ops = domain_.lo >= 0 ? find_fixed_function(stage) : std::nullopt) {
            append(result_.ops, std::move(*ops));
            note("fixed function");
            domain_ = largest_scaled(stage, evaluate(stage.f, domain_.hi));
            return;
        }
        const Expr x = Expr::input();
        // The norm of colors in the domain is in the domain, too (the weights of a luminance sum to
        // 1). For channels >= 0, hue and saturation are in [0, 1], and so are x and y.
        const auto identity = domain_.lo >= 0 ? sample_half_domain(x, 0, 1)
                                              : sample_half_domain(x, -kHalfMax, kHalfMax);
        const auto f = sample_half_domain(stage.f, std::max(domain_.lo, 0.0), domain_.hi);
        const auto kept = domain_.lo >= 0 ? unused_entries(identity, 0, 1)
                                          : unused_entries(identity, -kHalfMax, kHalfMax);
        const Lut1DOp table = lut_1d({identity, identity, f},
                                     {kept, kept, unused_entries(f, domain_.lo, domain_.hi)});
        const bool is_max = stage.norm == ToneScaleStage::Norm::max_rgb;
        if (is_max) {
            // HSV loses negative channels.
            require_clamp_at_0("tone scale on the largest channel");
            emit(FixedFunctionOp{"RGB_TO_HSV"}, "HSV");
            emit(table, "half LUT on V");
            emit(FixedFunctionOp{"RGB_TO_HSV"}, "HSV inverse", true);
        } else {
            // xyY scales all three channels by Y'/Y for any other two rows. Of the tested bases,
            // this one has the least cancellation in 1-x-y and in the inverse matrix.
            const Matrix3 basis = {
                {{0.5, 0, 0}, {stage.weights[0], stage.weights[1], stage.weights[2]}, {0, 0, 1}}};
            emit(MatrixOp{basis}, "matrix to (R/2, L, B)");
            emit(FixedFunctionOp{"XYZ_TO_xyY"}, "xyY");
            emit(table, "half LUT on Y");
            emit(FixedFunctionOp{"XYZ_TO_xyY"}, "xyY inverse", true);
            emit(MatrixOp{inverse(basis)}, "matrix back");
        }
        domain_ = largest_scaled(stage, static_cast<double>(*std::max_element(f.begin(), f.end())));
    }

    /// Domain after a tone scale with norms up to `largest`: a channel is at most the norm divided
    /// by its weight.
    [[nodiscard]] Domain largest_scaled(const ToneScaleStage& stage, double largest) const {
        const double weight = stage.norm == ToneScaleStage::Norm::max_rgb
                                  ? 1
                                  : *std::min_element(stage.weights.begin(), stage.weights.end());
        return domain_.lo >= 0 && weight > 0 ? Domain{0, largest / weight} : Domain{};
    }

    void lower(const HuePreservingStage& stage) {
        flush_curves();
        require_clamp_at_0("hue-preserving curve");
        // OCIO's shader inverts the hue where the curve falls; its CPU path does not.
        if (!is_rising(sample_half_domain(stage.f, domain_.lo, domain_.hi), domain_)) {
            emit_cube({apply_stage(stage, {Expr::input(0), Expr::input(1), Expr::input(2)})},
                      kUnlimited, false);
            return;
        }
        // A gain does not change the relative position of the middle channel.
        emit_curve({stage.f, stage.f, stage.f}, true);
    }

    void lower(const HexconeStage& stage) {
        flush_curves();
        require_clamp_at_0("hexcone stage");
        LoweredOps ops = lower_hexcone(stage, domain_.hi);
        const auto luts = std::count_if(ops.begin(), ops.end(), [](const LoweredOp& op) {
            return std::holds_alternative<Lut1DOp>(op.op);
        });
        append(result_.ops, std::move(ops));
        note("HSV, " + std::to_string(luts) + " half LUTs with matrices between, HSV inverse");
        domain_ = {};
    }

    void lower(const GridStage& stage) {
        // OCIO clamps the input of a 3D LUT to [0, 1] like Grid; a half LUT would round that
        // corner.
        lower(curve_stage(stage.shaper));
        flush_curves();
        const std::vector<double>& nodes = stage.grid->nodes();
        emit(Lut3DOp{stage.grid->edge(), {nodes.begin(), nodes.end()}},
             std::to_string(stage.grid->edge()) + "^3 3D LUT");
        // Powers of two, so that similar 3D LUTs share the tables after them.
        const auto [lo, hi] = std::minmax_element(nodes.begin(), nodes.end());
        const auto outwards = [](double x) {
            return x > 0 ? std::exp2(std::ceil(std::log2(x))) : 0.0;
        };
        const double largest = outwards(std::max(-*lo, *hi));
        domain_ = {*lo < 0 ? -largest : 0, largest};
    }

    void lower(const CrossTalkStage& stage) {
        flush_curves();
        const FixedFunctions* const functions = find_fixed_functions(stage);
        if (!functions) {
            const auto structure = options_.fits_cubes ? find_hue_structure(stage) : nullptr;
            if (structure) {
                emit_hue_cube(stage, *structure);
            } else {
                emit_cube(stage, behind_, options_.fits_cubes);
            }
            return;
        }
        const bool has_own_space = functions->to_space != kIdentity3;
        if (has_own_space) emit(MatrixOp{functions->to_space}, "matrix");
        for (const FixedFunctionOp& function : functions->functions)
            emit(function, function.style);
        if (has_own_space) emit(MatrixOp{inverse(functions->to_space)}, "matrix");
        result_.is_exact = result_.is_exact && functions->is_exact;
        domain_ = {};
    }

    /// @param behind  the clamp after it: the 3D LUT is free outside the clamp's interval
    void emit_cube(const CrossTalkStage& stage, const ClampStage& behind, bool is_fitted) {
        result_.loses_negatives = result_.loses_negatives || !(domain_.lo >= 0);
        const double top = cross_talk_top(stage, behind, domain_.hi, is_fitted);
        const auto cube = cross_talk_cube(stage, behind, top,
                                          {.edge = options_.cube_edge,
                                           .primaries = options_.primaries,
                                           .is_fitted = is_fitted,
                                           .cache_folder = options_.cache_folder});
        emit(RangeOp{0, top}, "range");
        const std::vector<float> shaper = sample_half_domain(cube->shaper, 0, top);
        const std::vector<signed char> slack = unused_entries(shaper, 0, top);
        emit(lut_1d({shaper, shaper, shaper}, {slack, slack, slack}), "half LUT shaper");
        emit(Lut3DOp{options_.cube_edge, cube->nodes}, std::to_string(options_.cube_edge) +
                                                           "^3 3D LUT to " + shortest(top) +
                                                           (is_fitted ? ", fitted" : ""));
        result_.is_exact = false;
        domain_ = {};
        lower(curve_stage(srgb_decode(Expr::input())));
    }

    /// A 3D LUT over hue, saturation and value of the declared axes of the stage.
    void emit_hue_cube(const CrossTalkStage& stage, const HueStructure& structure) {
        result_.loses_negatives = result_.loses_negatives || !(domain_.lo >= 0);
        const double top = cross_talk_top(stage, behind_, domain_.hi, true);
        const auto cube =
            hue_cube(stage, structure, top, options_.primaries, options_.cache_folder);
        emit(RangeOp{0, top}, "range");
        domain_ = {0, top};
        for (const Stage& part : structure.to_axes)
            std::visit([&](const auto& s) { lower(s); }, part);
        flush_curves();
        emit(MatrixOp{scale(kIdentity3, cube->gain)}, "scale");
        emit(FixedFunctionOp{"RGB_TO_HSV"}, "HSV");
        const auto emit_table = [&](const Table3& table, const std::string& what) {
            Lut1DOp lut{3, table};
            lut.is_half_domain = false;
            emit(std::move(lut), what);
        };
        const auto emit_affine = [&](const AffineStep& step) {
            emit(MatrixOp{step.m, step.offset}, "matrix");
        };
        emit_table(cube->spread, "LUT of hue and value");
        emit_affine(cube->less_sum);
        emit_table(cube->back, "LUT of hue");
        emit_affine(cube->plus_hue);
        emit_table(cube->place, "LUT of positions");
        emit(Lut3DOp{cube->edge, cube->nodes, HueCube::kUnit},
             std::to_string(cube->edge) + "^3 3D LUT of hues to " + shortest(top) + ", fitted");
        emit_table(cube->light, "LUT of light");
        emit_affine(cube->ratios);
        emit(FixedFunctionOp{"XYZ_TO_xyY"}, "xyY inverse", true);
        emit(MatrixOp{cube->to_rgb}, "matrix");
        result_.is_exact = false;
        domain_ = {};
    }

    void require_clamp_at_0(const char* stage) const {
        if (!(domain_.lo >= 0))
            throw Error("ocio: " + std::string(stage) + " without a clamp at 0 before it");
    }

    template <class Op>
    void emit(Op op, const std::string& what, bool is_inverse = false) {
        result_.ops.push_back({std::move(op), is_inverse});
        note(what);
    }

    void note(const std::string& what) {
        result_.summary += (result_.summary.empty() ? "" : ", ") + what;
    }

    /// @param behind  clamp of the result
    void flush_curves(const ClampStage& behind = kUnlimited) {
        if (!pending_) return;
        const std::array<Expr, 3> f = *pending_;
        pending_.reset();
        emit_curve(f, false, behind);
    }

    void emit_curve(std::array<Expr, 3> f, bool keeps_hue, const ClampStage& behind = kUnlimited) {
        Domain domain = domain_;
        // If the slope at black is infinite (the power of a display), the first cells of a
        // half-float table are too coarse. Half floats have many exponents below 1 and few above
        // the range of this curve, so the input is scaled up by a power of two, which is exact.
        const double gain = std::exp2(std::floor(std::log2(kHalfMax / domain.hi)));
        if (domain.lo >= 0 && gain > 1 && is_steep_at_black(f)) {
            emit(MatrixOp{scale(kIdentity3, gain)}, "scale");
            const Expr scaled = Expr::input() / gain;
            for (Expr& channel : f)
                channel = substitute(channel, std::span(&scaled, 1));
            domain = {domain.lo * gain, domain.hi * gain};
        }
        std::array<std::vector<float>, 3> tables;
        std::array<std::vector<signed char>, 3> slack;
        domain_ = {kHalfMax, -kHalfMax};
        for (std::size_t c = 0; c < 3; ++c) {
            const bool known = c > 0 && same(f[c], f[0]);
            tables[c] = known ? tables[0] : sample_half_domain(f[c], domain.lo, domain.hi);
            const auto [lo, hi] = std::minmax_element(tables[c].begin(), tables[c].end());
            domain_.lo = std::min(domain_.lo, static_cast<double>(*lo));
            domain_.hi = std::max(domain_.hi, static_cast<double>(*hi));
            slack[c] = unused_entries(tables[c], domain.lo, domain.hi);
        }
        for (std::size_t c = 0; c < 3; ++c)
            clip(tables[c], slack[c], behind);
        Lut1DOp lut = lut_1d(tables, slack);
        lut.keeps_hue = keeps_hue;
        emit(std::move(lut), keeps_hue ? "half LUT that keeps hue" : "half LUT");
    }

    /// Sets entries to the limit if they and their neighbors exceed it.
    static void clip(std::vector<float>& table, std::vector<signed char>& slack,
                     const ClampStage& limit) {
        const auto lo = static_cast<float>(limit.lo);
        const auto hi = static_cast<float>(limit.hi);
        // The neighbor of -0 is the smallest negative number, but the adjacent entry is infinity.
        std::vector<signed char> beyond(table.size());
        for (std::size_t i = 0; i < table.size(); ++i)
            beyond[i] = static_cast<signed char>((table[i] >= hi) - (table[i] <= lo));
        for (std::size_t i = 1; i + 1 < table.size(); ++i) {
            const bool is_alone = beyond[i - 1] != beyond[i] || beyond[i] != beyond[i + 1];
            if (beyond[i] == 0 || is_alone || i == 0x8000 || slack[i] != 0) continue;
            table[i] = beyond[i] > 0 ? hi : lo;
            slack[i] = beyond[i];
        }
    }

    /// True from half float to half float of the domain, except for rounding.
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
    ClampStage behind_ = kUnlimited;  // clamp after the current stage
    std::optional<std::array<Expr, 3>> pending_;
};

}  // namespace

Lowered lower_to_ocio(const Pipeline& pipeline, const LowerOptions& options) {
    return Lowering(options).run(simplify(pipeline));
}

TONEWRIGHT_NAMESPACE_END
