// SPDX-License-Identifier: Apache-2.0
#include "engine/compiled_curve.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr double kHalfUlp = 0x1p-24;
constexpr double kFloatMax = static_cast<double>(std::numeric_limits<float>::max());
/// Exponents of x below this are not told apart.
constexpr int kLowestExponent = -100;

float to_float(double x) { return static_cast<float>(x); }

/// A number in every half octave from `from` up to `to`, with both.
std::vector<double> half_octaves(double from, double to) {
    std::vector<double> places = {from};
    for (double x = from * 1.5; x < to; x *= std::numbers::sqrt2)
        places.push_back(x);
    places.push_back(to);
    return places;
}

/// One piece of a curve under construction.
struct Segment {
    double begin, end;
    float scale, offset;
    std::array<float, CompiledCurve::kMaxDegree + 1> coefficients;
    float rest;
};

/// What the kernels compute. Of a precise curve x is a double, else a float.
/// @param coefficient  k -> that of t^k
template <class C>
double evaluate(double x, float scale, float offset, int degree, const C& coefficient, float rest,
                bool is_precise) {
    const float x_float = to_float(x);
    float t = std::fma(x_float, scale, offset);
    if (is_precise) t = std::fma(to_float(x - static_cast<double>(x_float)), scale, t);
    float y = coefficient(degree);
    for (int k = degree - 1; k >= 1; --k)
        y = std::fma(y, t, coefficient(k));
    if (!is_precise) return static_cast<double>(std::fma(y, t, coefficient(0)));
    return static_cast<double>(coefficient(0)) + static_cast<double>(std::fma(y, t, rest));
}

constexpr std::size_t kMostNodes = CompiledCurve::kMaxDegree + 1;
using Coefficients = std::array<double, kMostNodes>;

/// Numbers of the polynomials through n places.
struct ChebyshevNumbers {
    Coefficients node{};                              // the Chebyshev nodes of [-1, 1]
    std::array<Coefficients, kMostNodes> cosine{};    // of T_k at the nodes
    std::array<Coefficients, kMostNodes> monomial{};  // coefficients of T_k

    ChebyshevNumbers() = default;
    explicit ChebyshevNumbers(int n) {
        monomial[0][0] = 1;
        monomial[1][1] = 1;
        for (int k = 0; k < n; ++k) {
            const auto row = static_cast<std::size_t>(k);
            for (int i = 0; i < n; ++i) {
                const auto column = static_cast<std::size_t>(i);
                if (k == 0) node[column] = std::cos(std::numbers::pi * (i + 0.5) / n);
                cosine[row][column] = std::cos(std::numbers::pi * k * (i + 0.5) / n);
            }
            if (k < 2) continue;  // T_k = 2 t T_k-1 - T_k-2
            for (std::size_t j = 0; j < static_cast<std::size_t>(n); ++j) {
                monomial[row][j] =
                    (j > 0 ? 2 * monomial[row - 1][j - 1] : 0) - monomial[row - 2][j];
            }
        }
    }

    static const ChebyshevNumbers& of(int n) {
        static const auto all = [] {
            std::array<ChebyshevNumbers, kMostNodes + 1> numbers;
            for (int i = 1; i <= static_cast<int>(kMostNodes); ++i)
                numbers[static_cast<std::size_t>(i)] = ChebyshevNumbers(i);
            return numbers;
        }();
        return all[static_cast<std::size_t>(n)];
    }
};

double at(const CurveFunction& f, double x) {
    f({&x, 1});
    return x;
}

/// Monomial coefficients, in t, of the polynomial through f(place(t)) at the Chebyshev nodes of
/// [-1, 1].
template <class Place>
Coefficients interpolate(const CurveFunction& f, const Place& place, int degree) {
    const ChebyshevNumbers& numbers = ChebyshevNumbers::of(degree + 1);
    const auto n = static_cast<std::size_t>(degree) + 1;
    Coefficients value{};
    for (std::size_t i = 0; i < n; ++i)
        value[i] = place(numbers.node[i]);
    f(std::span(value).first(n));
    Coefficients sum{};
    for (std::size_t k = 0; k < n; ++k) {
        double c = 0;
        for (std::size_t i = 0; i < n; ++i)
            c += value[i] * numbers.cosine[k][i];
        c *= (k == 0 ? 1.0 : 2.0) / (degree + 1);
        for (std::size_t j = 0; j < n; ++j)
            sum[j] += c * numbers.monomial[k][j];
    }
    return sum;
}

constexpr float kNever = std::numeric_limits<float>::infinity();
constexpr float kMost = std::numeric_limits<float>::max();

/// The least number so far, and how often it came.
struct Least {
    double value = std::numeric_limits<double>::infinity();
    int times = 0;

    void add(double x) {
        if (x < value) times = 0;
        value = std::min(value, x);
        times += x == value ? 1 : 0;
    }
};

/// The ends of a function that is looked at in many places.
class Ends {
  public:
    void add(double y) {
        least_.add(y);
        most_.add(-y);
    }
    /// Between the places of a dip there may be a lower one, but what it has at its ends, or again
    /// and again, is an end. Rounded outwards: what it has there is not limited to less.
    void set(CompiledCurve& curve, double first, double last) const {
        const bool has_least = least_.times > 8 || least_.value >= std::min(first, last);
        const bool has_most = most_.times > 8 || -most_.value <= std::max(first, last);
        curve.least = has_least ? -float_from(-least_.value) : -kMost;
        curve.most = has_most ? float_from(-most_.value) : kMost;
    }

  private:
    Least least_, most_;  // of the function, and of the negative function
};

/// What a fit is to keep to.
class Fit {
  protected:
    Fit(const CurveFunction& f, double hi, std::span<const double> kinks,
        const CurveTolerance& tolerance, bool is_precise)
        : f_(f), hi_(hi), tolerance_(tolerance), is_precise_(is_precise) {
        for (const double kink : kinks) {
            if (kink > 0 && kink < hi) kinks_.push_back(float_from(kink));
        }
        std::sort(kinks_.begin(), kinks_.end());
        kinks_.erase(std::unique(kinks_.begin(), kinks_.end()), kinks_.end());
    }

    /// Whether polynomial(x) keeps to the tolerance over [begin, end]: at both ends, at and beside
    /// kinks, and between `steps` equal steps.
    template <class P>
    bool keeps(double begin, double end, int steps, const P& polynomial) {
        places_ = {begin, end};
        const auto behind = std::lower_bound(kinks_.begin(), kinks_.end(), to_float(begin));
        for (auto kink = behind; kink != kinks_.end(); ++kink) {
            if (static_cast<double>(*kink) > end) break;
            for (const float x :
                 {std::nextafter(*kink, 0.0F), *kink, std::nextafter(*kink, kMost)}) {
                const auto place = static_cast<double>(x);
                if (place >= begin && place <= end) places_.push_back(place);
            }
        }
        // Where it is most likely to be wrong.
        if (!keeps_at_places(polynomial)) return false;
        places_.clear();
        for (int i = 1; i < steps; ++i)
            places_.push_back(begin + (end - begin) * i / steps);
        if (begin == 0) {  // the tolerance is of the result, which may be proportional to x
            for (double x = end; x > 0x1p-126; x *= 0.37)
                places_.push_back(x);
        }
        return keeps_at_places(polynomial);
    }

    /// What all forms have in common.
    [[nodiscard]] CompiledCurve curve_without_polynomials() const {
        CompiledCurve result;
        result.hi = to_float(hi_);
        result.at_lo = at(f_, 0);
        ends_.set(result, result.at_lo, at(f_, hi_));
        result.is_precise = is_precise_;
        result.tolerance = tolerance_;
        return result;
    }

    const CurveFunction& f_;
    double hi_;
    std::vector<float> kinks_;  // rising
    const CurveTolerance& tolerance_;
    bool is_precise_;

  private:
    template <class P>
    bool keeps_at_places(const P& polynomial) {
        if (!is_precise_) {
            for (double& x : places_)
                x = static_cast<double>(to_float(x));
        }
        expected_ = places_;
        f_(expected_);
        for (std::size_t i = 0; i < places_.size(); ++i) {
            ends_.add(expected_[i]);
            const double error = std::fabs(polynomial(places_[i]) - expected_[i]);
            if (!(error <= tolerance_.at(places_[i], expected_[i]))) return false;
        }
        return true;
    }

    std::vector<double> places_, expected_;
    Ends ends_;
};

class CurveFit : Fit {
  public:
    CurveFit(const CurveFunction& f, double hi, std::span<const double> kinks,
             const CurveTolerance& tolerance, bool is_precise, int degree, int shift,
             std::size_t most_segments)
        : Fit(f, hi, kinks, tolerance, is_precise),
          degree_(degree),
          shift_(shift),
          most_segments_(most_segments) {}

    /// Segments of any length, without cells.
    std::optional<CompiledCurve> fit_free() {
        // Ends may be at kinks and at eighths of octaves.
        std::vector<double> ends;
        const std::uint32_t top = cell_of(to_float(hi_));
        for (std::uint32_t cell = cell_of(0x1p-60F); cell <= top; ++cell)
            ends.push_back(edge(cell));
        for (const float kink : kinks_)
            ends.push_back(static_cast<double>(kink));
        ends.push_back(hi_);
        std::sort(ends.begin(), ends.end());
        ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
        double begin = 0;
        std::size_t next = 0;     // of the ends, the first that is not behind us
        std::size_t stride = 64;  // how far the segment before went
        while (next < ends.size()) {
            const auto fits = [&](std::size_t i) {
                // Up to the float before, unless it is the last.
                const double end =
                    i + 1 == ends.size()
                        ? ends[i]
                        : static_cast<double>(std::nextafter(to_float(ends[i]), 0.0F));
                return try_segment(begin, end);
            };
            // Doubling the stride while it fits, then halving the rest.
            std::size_t good = next;
            if (!fits(good)) return std::nullopt;
            Segment best = tried_;
            std::size_t bad = ends.size();
            while (bad - good > 1) {
                const std::size_t reach = good + std::max<std::size_t>(stride, 1);
                const std::size_t i = reach < bad ? reach : good + (bad - good) / 2;
                if (fits(i)) {
                    best = tried_;
                    good = i;
                    stride *= 2;
                } else {
                    bad = i;
                    stride /= 2;
                }
            }
            stride = std::max<std::size_t>(good - next, 1);
            segments_.push_back(best);
            if (segments_.size() > most_segments_) return std::nullopt;
            begin = ends[good];
            next = good + 1;
        }
        return curve();
    }

    std::optional<CompiledCurve> fit() {
        // The first segment, from 0: as far up as one polynomial goes.
        const auto top = cell_of(to_float(hi_));
        std::uint32_t lowest = cell_of(to_float(std::ldexp(1.0, kLowestExponent)));
        if (!try_segment(0, std::min(edge(lowest + 1), hi_))) return std::nullopt;
        std::uint32_t failing = top + 2;
        while (failing - lowest > 1) {  // fits up to the end of `lowest`
            const std::uint32_t middle = lowest + (failing - lowest) / 2;
            (try_segment(0, std::min(edge(middle + 1), hi_)) ? lowest : failing) = middle;
        }
        lowest = std::min(lowest, top);
        if (top - lowest >= CompiledCurve::kMaxCells) return std::nullopt;
        first_cell_ = lowest;
        (void)try_segment(0, std::min(edge(lowest + 1), hi_));
        segments_.push_back(tried_);
        cells_.push_back({0, kNever});
        for (std::uint32_t cell = lowest + 1; cell <= top; ++cell) {
            if (!fit_cell(cell)) return std::nullopt;
            if (segments_.size() > most_segments_) return std::nullopt;
        }
        return curve();
    }

  private:
    struct Cell {
        int segment;
        float threshold;
    };

    [[nodiscard]] std::uint32_t cell_of(float x) const {
        return std::bit_cast<std::uint32_t>(x) >> shift_;
    }
    [[nodiscard]] double edge(std::uint32_t cell) const {
        const auto x = std::bit_cast<float>(cell << shift_);
        return std::isfinite(x) ? static_cast<double>(x) : kFloatMax;
    }

    /// The polynomial over [begin, end] into tried_; whether it keeps to the tolerance.
    bool try_segment(double begin, double end) {
        Segment s{};
        s.begin = begin;
        s.end = end;
        const double middle = 0.5 * (begin + end);
        const double half = std::max({0.5 * (end - begin), 1e-6 * end, 0x1p-110});
        s.scale = to_float(1 / half);
        s.offset = to_float(-middle / half);
        // In the t of the rounded scale and offset.
        const auto x_of = [&](double t) {
            return (t - static_cast<double>(s.offset)) / static_cast<double>(s.scale);
        };
        const Coefficients c = interpolate(
            f_, [&](double t) { return std::clamp(x_of(t), begin, end); }, degree_);
        for (int k = 0; k <= degree_; ++k) {
            const double coefficient = c[static_cast<std::size_t>(k)];
            if (!(std::fabs(coefficient) < kFloatMax)) return false;
            s.coefficients[static_cast<std::size_t>(k)] = to_float(coefficient);
        }
        s.rest = to_float(c[0] - static_cast<double>(s.coefficients[0]));
        tried_ = s;
        return keeps(begin, end, 5 * (degree_ + 1), [&](double x) {
            const auto of_power = [&](int k) {
                return s.coefficients[static_cast<std::size_t>(k)];
            };
            return evaluate(x, s.scale, s.offset, degree_, of_power, s.rest, is_precise_);
        });
    }

    bool fit_cell(std::uint32_t cell) {
        const double begin = edge(cell);
        const double end = std::min(edge(cell + 1), hi_);
        const auto current = static_cast<int>(segments_.size()) - 1;
        // The segment before may go on.
        if (extend(end)) {
            cells_.push_back({current, kNever});
            return true;
        }
        if (try_segment(begin, end)) {
            segments_.push_back(tried_);
            cells_.push_back({current + 1, kNever});
            return true;
        }
        // Two in this cell: the boundary at a kink, or in the middle.
        std::vector<double> boundaries;
        for (const float kink : kinks_)
            boundaries.push_back(static_cast<double>(kink));
        boundaries.push_back(static_cast<double>(float_from(0.5 * (begin + end))));
        for (const double boundary : boundaries) {
            if (!(boundary > begin && boundary < end)) continue;
            // The float before it is the last of the first segment.
            const double before = static_cast<double>(std::nextafter(to_float(boundary), 0.0F));
            if (!try_segment(boundary, end)) continue;
            const Segment second = tried_;
            if (extend(before)) {
                segments_.push_back(second);
                cells_.push_back({current, to_float(boundary)});
                return true;
            }
            if (!try_segment(begin, before)) continue;
            segments_.push_back(tried_);
            segments_.push_back(second);
            cells_.push_back({current + 1, to_float(boundary)});
            return true;
        }
        return false;
    }

    bool extend(double end) {
        Segment& last = segments_.back();
        // A polynomial over more than a few octaves is not worth trying.
        if (last.begin > 0 && end > 8 * last.begin) return false;
        if (!try_segment(last.begin, end)) return false;
        last = tried_;
        return true;
    }

    [[nodiscard]] CompiledCurve curve() const {
        CompiledCurve result = curve_without_polynomials();
        result.shift = shift_;
        result.first_cell = first_cell_;
        result.cell_floor = to_float(edge(first_cell_));
        result.degree = degree_;
        result.cells = cells_.size() <= 32 ? 32 : 64;
        result.segments = segments_.size() <= 16 ? 16 : segments_.size() <= 32 ? 32 : 64;
        if (cells_.empty()) {
            result.cells = 0;
            result.threshold.fill(kNever);
            for (std::size_t i = 0; i < segments_.size(); ++i)
                result.threshold[i] = to_float(segments_[i].begin);
        }
        for (std::size_t i = 0; i < result.threshold.size() && !cells_.empty(); ++i) {
            const Cell& cell = cells_[std::min(i, cells_.size() - 1)];
            result.threshold[i] = cell.threshold;
            result.segment[i] = cell.segment;
        }
        for (std::size_t i = 0; i < segments_.size(); ++i) {
            result.scale[i] = segments_[i].scale;
            result.offset[i] = segments_[i].offset;
            result.rest[i] = segments_[i].rest;
            for (std::size_t k = 0; k < segments_[i].coefficients.size(); ++k)
                result.coefficient[k][i] = segments_[i].coefficients[k];
        }
        return result;
    }

    int degree_;
    int shift_;
    std::size_t most_segments_;
    std::uint32_t first_cell_ = 0;
    Segment tried_{};
    std::vector<Segment> segments_;
    std::vector<Cell> cells_;
};

/// Of a row; of a precise curve, all but the first coefficient.
float polynomial(const CurveRows& rows, const float* row, float t, bool is_precise) {
    const int lowest = is_precise ? 1 : 0;
    float y = row[rows.length - 1];
    for (int k = rows.length - 2; k >= lowest; --k)
        y = rows.is_fused ? std::fma(y, t, row[k]) : y * t + row[k];
    return y;
}

/// A curve in rows, of one length and number of cells an octave.
class RowFit : Fit {
  public:
    RowFit(const CurveFunction& f, double hi, std::span<const double> kinks,
           const CurveTolerance& tolerance, bool is_precise, bool is_fused, int length, int shift)
        : Fit(f, hi, kinks, tolerance, is_precise) {
        rows_.is_fused = is_fused;
        rows_.length = length;
        rows_.shift = shift;
    }

    std::optional<CompiledCurve> fit() {
        // One kink that shows can lie between two cells of the same grid.
        if (!place_cells(0)) return std::nullopt;
        if (!rows_.restarts.empty() &&
            !place_cells(rows_.restarts.front().from & ((std::uint32_t{1} << rows_.shift) - 1)))
            return std::nullopt;
        return fit_cells();
    }

  private:
    using Row = std::array<float, 8>;

    /// With a restart, the first of its cells.
    struct Grid {
        std::uint32_t from, base, first_cell;
    };

    [[nodiscard]] std::uint32_t first_bits_of(std::uint32_t cell) const {
        auto grid = grids_.rbegin();
        while (grid->first_cell > cell)
            ++grid;
        return grid->base + (cell << rows_.shift);
    }
    [[nodiscard]] float begin_of(std::uint32_t cell) const {
        return std::bit_cast<float>(first_bits_of(cell));
    }
    /// The last float of a cell.
    [[nodiscard]] double end_of(std::uint32_t cell) const {
        std::uint32_t next = first_bits_of(cell) + (std::uint32_t{1} << rows_.shift);
        for (const Grid& grid : grids_) {
            if (grid.first_cell == cell + 1) next = grid.from;
        }
        return std::min(static_cast<double>(std::bit_cast<float>(next - 1)), hi_);
    }

    /// Chooses where cells begin, finds the first one, which reaches down to 0, and lets them begin
    /// anew at kinks that no polynomial passes.
    bool place_cells(std::uint32_t part) {
        const std::uint32_t unit = std::uint32_t{1} << rows_.shift;
        const auto cell_at = [&](double x) {
            return (std::bit_cast<std::uint32_t>(to_float(x)) - part) / unit;
        };
        const std::uint32_t top = cell_at(hi_);
        std::uint32_t lowest = cell_at(std::min(std::ldexp(1.0, kLowestExponent), hi_));
        const auto first_fits = [&](std::uint32_t cell) {
            rows_.base = cell * unit + part;
            grids_ = {{rows_.base, rows_.base, 0}};
            return try_row(0, end_of(0), 0);
        };
        if (!first_fits(lowest)) return false;
        std::uint32_t failing = top + 1;
        while (failing - lowest > 1) {
            const std::uint32_t middle = lowest + (failing - lowest) / 2;
            (first_fits(middle) ? lowest : failing) = middle;
        }
        if (top - lowest >= CurveRows::kMaxRows) return false;
        rows_.base = lowest * unit + part;
        grids_ = {{rows_.base, rows_.base, 0}};
        rows_.restarts.clear();
        for (const float kink : kinks_) {
            if (static_cast<double>(kink) <= end_of(0)) continue;
            const auto bits = std::bit_cast<std::uint32_t>(kink);
            const std::uint32_t cell = (bits - grids_.back().base) / unit;
            if (kink == begin_of(cell)) continue;
            if (try_row(static_cast<double>(begin_of(cell)), end_of(cell), cell)) continue;
            const std::uint32_t base = bits - (cell + 1) * unit;
            grids_.push_back({bits, base, cell + 1});
            rows_.restarts.push_back({bits, base});
        }
        count_ = (std::bit_cast<std::uint32_t>(to_float(hi_)) - grids_.back().base) / unit + 1;
        if (count_ > CurveRows::kMaxRows) return false;
        // What cannot be is seen soon: in one cell of each octave or two.
        constexpr std::uint32_t kStride = 13;
        for (std::uint32_t cell = kStride; cell < count_; cell += kStride) {
            if (!try_row(static_cast<double>(begin_of(cell)), end_of(cell), cell)) return false;
        }
        return true;
    }

    std::optional<CompiledCurve> fit_cells() {
        for (std::uint32_t cell = 0; cell < count_; ++cell) {
            const double begin = cell == 0 ? 0 : static_cast<double>(begin_of(cell));
            if (!try_row(begin, end_of(cell), cell)) return std::nullopt;
            rows_.numbers.insert(rows_.numbers.end(), tried_.begin(),
                                 tried_.begin() + rows_.length);
        }
        CompiledCurve result = curve_without_polynomials();
        result.rows = std::move(rows_);
        return result;
    }

    /// The polynomial over [begin, end] into tried_; whether it keeps to the tolerance.
    bool try_row(double begin, double end, std::uint32_t cell) {
        const auto x0 = static_cast<double>(begin_of(cell));
        const auto scale = static_cast<double>(CurveRows::scale_of(begin_of(cell)));
        const double middle = (0.5 * (begin + end) - x0) * scale;
        const double half = std::max(0.5 * (end - begin) * scale, 1e-6);
        const int degree = rows_.length - (is_precise_ ? 2 : 1);
        const Coefficients c = interpolate(
            f_, [&](double u) { return std::clamp(x0 + (middle + u * half) / scale, begin, end); },
            degree);
        // Powers of u = (t - middle) / half as powers of t, by Horner's rule.
        Coefficients in_t{c[static_cast<std::size_t>(degree)]};
        std::size_t powers = 1;
        for (auto k = static_cast<std::size_t>(degree); k-- > 0;) {
            ++powers;
            for (std::size_t j = powers; j-- > 0;)
                in_t[j] = ((j > 0 ? in_t[j - 1] : 0) - in_t[j] * middle) / half;
            in_t[0] += c[k];
        }
        tried_ = {};
        std::size_t next = 0;
        for (std::size_t power = 0; power < powers; ++power) {
            const double k = in_t[power];
            if (!(std::fabs(k) < static_cast<double>(kMost))) return false;
            tried_[next++] = to_float(k);
            if (is_precise_ && next == 1)
                tried_[next++] = to_float(k - static_cast<double>(to_float(k)));
        }
        return keeps(begin, end, 3 * rows_.length, [&](double x) {
            const float x_float = to_float(x);
            float distance = x_float - begin_of(cell);
            if (is_precise_) distance += to_float(x - static_cast<double>(x_float));
            const float y = polynomial(rows_, tried_.data(),
                                       distance * CurveRows::scale_of(begin_of(cell)), is_precise_);
            return static_cast<double>(y) + (is_precise_ ? static_cast<double>(tried_[0]) : 0);
        });
    }

    CurveRows rows_;
    std::vector<Grid> grids_;  // the first one, and one for each restart
    std::uint32_t count_ = 0;  // of cells
    Row tried_{};
};

/// The shortest rows that do it, and of these the fewest: they share the first-level cache with
/// pixels.
std::optional<CompiledCurve> fit_rows(const CurveFunction& f, double hi,
                                      std::span<const double> kinks,
                                      const CurveTolerance& tolerance, bool is_precise,
                                      bool is_fused) {
    for (const int length : {4, 8}) {
        if (length == 4 && is_precise) continue;
        for (int shift = 21; shift >= 16; --shift) {
            RowFit rows(f, hi, kinks, tolerance, is_precise, is_fused, length, shift);
            if (auto curve = rows.fit()) return curve;
        }
    }
    return std::nullopt;
}

}  // namespace

float float_from(double x) noexcept {
    const float nearest = to_float(x);
    return static_cast<double>(nearest) < x
               ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
               : nearest;
}

std::size_t CurveTolerance::exponent_of(double x) noexcept {
    return std::bit_cast<std::uint32_t>(std::fabs(to_float(x))) >> 23;
}

double CurveTolerance::at(double x, double y) const noexcept {
    return std::max(half_ulps * kHalfUlp * std::fabs(y),
                    static_cast<double>(floor[exponent_of(x)]));
}

std::size_t CompiledCurve::segment_of(float x) const noexcept {
    if (cells == 0) {
        const auto behind = std::upper_bound(threshold.begin() + 1, threshold.end(), x);
        return static_cast<std::size_t>(behind - threshold.begin()) - 1;
    }
    const auto cell = static_cast<std::size_t>(
        (std::bit_cast<std::uint32_t>(std::max(x, cell_floor)) >> shift) - first_cell);
    return static_cast<std::size_t>(segment[cell]) + (x >= threshold[cell] ? 1 : 0);
}

std::vector<float> CompiledCurve::segment_begins() const {
    // The bits of floats that are not negative rise with them.
    std::vector<float> begins = {lo};
    const std::size_t last = segment_of(hi);
    for (std::size_t s = segment_of(lo) + 1; s <= last; ++s) {
        auto below = std::bit_cast<std::uint32_t>(begins.back());
        auto at = std::bit_cast<std::uint32_t>(hi);
        while (at - below > 1) {
            const std::uint32_t middle = below + (at - below) / 2;
            (segment_of(std::bit_cast<float>(middle)) < s ? below : at) = middle;
        }
        begins.push_back(std::bit_cast<float>(at));
    }
    return begins;
}

std::uint32_t CurveRows::base_of(std::uint32_t bits) const noexcept {
    std::uint32_t last = base;
    for (const Restart& restart : restarts) {
        if (bits >= restart.from) last = restart.base;
    }
    return last;
}

CurveRows::Place CurveRows::find(float x) const noexcept {
    const auto bits = std::bit_cast<std::uint32_t>(std::max(x, std::bit_cast<float>(base)));
    const std::uint32_t start = base_of(bits);
    const std::uint32_t cell = (bits - start) >> shift;
    const auto x0 = std::bit_cast<float>(start + (cell << shift));
    return {numbers.data() + std::size_t{cell} * static_cast<std::size_t>(length), x0,
            scale_of(x0)};
}

float CurveRows::scale_of(float x0) noexcept {
    return std::bit_cast<float>(0x7F000000U - (std::bit_cast<std::uint32_t>(x0) & 0x7F800000U));
}

double CompiledCurve::operator()(double x) const noexcept {
    if (!(x > static_cast<double>(lo)))  // NaN, too
        return is_precise ? at_lo : static_cast<double>(to_float(at_lo));
    x = std::min(x, static_cast<double>(hi));
    if (rows) {
        const float x_float = to_float(x);
        const CurveRows::Place place = rows->find(x_float);
        float distance = x_float - place.x0;
        if (is_precise) distance += to_float(x - static_cast<double>(x_float));
        const float y = polynomial(*rows, place.row, distance * place.scale, is_precise);
        return std::clamp(
            static_cast<double>(y) + (is_precise ? static_cast<double>(place.row[0]) : 0),
            static_cast<double>(least), static_cast<double>(most));
    }
    const std::size_t s = segment_of(to_float(x));
    const auto of_power = [&](int k) { return coefficient[static_cast<std::size_t>(k)][s]; };
    const double y = evaluate(x, scale[s], offset[s], degree, of_power, rest[s], is_precise);
    return std::clamp(y, static_cast<double>(least), static_cast<double>(most));
}

double CompiledCurve::slope(double x) const noexcept {
    if (!(x >= static_cast<double>(lo) && x <= static_cast<double>(hi))) return 0;
    if (rows) {
        const CurveRows::Place place = rows->find(to_float(x));
        const auto per_x = static_cast<double>(place.scale);
        const double t = (x - static_cast<double>(place.x0)) * per_x;
        const int first = is_precise ? 1 : 0;  // behind it, number k belongs to power k - first
        double y = 0;
        for (int k = rows->length - 1; k > first; --k)
            y = y * t + (k - first) * static_cast<double>(place.row[k]);
        return y * per_x;
    }
    const std::size_t s = segment_of(static_cast<float>(x));
    const double t = x * static_cast<double>(scale[s]) + static_cast<double>(offset[s]);
    double y = 0;
    for (auto k = static_cast<std::size_t>(degree) + 1; k-- > 1;)
        y = y * t + static_cast<double>(k) * static_cast<double>(coefficient[k][s]);
    return y * static_cast<double>(scale[s]);
}

int CompiledCurve::cost() const noexcept {
    if (rows) {
        return 36 + (rows->length > 4 ? 28 : 0) + 4 * static_cast<int>(rows->restarts.size()) +
               (is_precise ? 24 : 0);
    }
    const int steps =
        static_cast<int>(std::bit_width(static_cast<unsigned>(segments))) - 1;  // of the search
    const int of_cells = cells == 0 ? steps * (segments <= 32 ? 4 : 8) : 2 * (cells <= 32 ? 1 : 3);
    const int of_segments = (degree + 3) * (segments <= 32 ? 1 : 3);
    const int of_doubles = is_precise ? 24 : 0;
    return 12 + of_cells + of_segments + degree + of_doubles;
}

std::optional<CompiledCurve> compile_curve(const CurveFunction& f, std::array<double, 2> range,
                                           std::span<const double> kinks,
                                           const CurveTolerance& tolerance, CurveForm form,
                                           bool is_precise) {
    const double at_zero = at(f, 0);
    if (!std::isfinite(at_zero)) return std::nullopt;
    const auto is_near = [&](const std::vector<double>& places, double value, double share) {
        std::vector<double> y = places;
        f(y);
        for (std::size_t i = 0; i < y.size(); ++i) {
            if (!(std::fabs(y[i] - value) <= share * tolerance.at(places[i], value))) return false;
        }
        return true;
    };
    const auto is_constant = [&](double from, double to, double value) {
        std::vector<double> places = half_octaves(from, to);
        for (const double kink : kinks) {
            if (!(kink >= from && kink <= to)) continue;
            const auto near = static_cast<double>(to_float(kink));
            for (const double x : {near * (1 - 1e-6), near, near * (1 + 1e-6)})
                places.push_back(std::clamp(x, from, to));
        }
        return is_near(places, value, 0.5);
    };
    if (range[0] < 0) {
        std::vector<double> places = half_octaves(0x1p-126, -std::max(range[0], -kFloatMax));
        for (double& x : places)
            x = -x;
        if (!is_near(places, at_zero, 1)) return std::nullopt;
    }
    double hi = std::min(range[1], kFloatMax);
    if (!(hi > 0)) return std::nullopt;
    hi = static_cast<double>(to_float(hi));
    const double at_top = at(f, hi);
    if (!std::isfinite(at_top)) return std::nullopt;
    while (hi > 0x1p-60 && is_constant(hi / 2, hi, at_top))
        hi = static_cast<double>(to_float(hi / 2));

    if (form != CurveForm::segments) {
        // What is constant from a kink on ends there: one kink less.
        for (const double kink : kinks) {
            const auto end = static_cast<double>(float_from(kink));
            if (end > 0x1p-60 && end < hi && is_constant(end, hi, at_top)) hi = end;
        }
        return fit_rows(f, hi, kinks, tolerance, is_precise, form == CurveForm::rows);
    }

    // Eighths of octaves are what segments without cells end at.
    constexpr int kFree = 20;
    const auto fit = [&](int degree, int shift, std::size_t most_segments) {
        CurveFit curve(f, hi, kinks, tolerance, is_precise, degree, shift, most_segments);
        return shift == kFree ? curve.fit_free() : curve.fit();
    };
    // Segments above 32 cost three times as much, a degree one instruction for its coefficient and
    // one more: the lowest degree with 32 segments at most is the best.
    for (const int shift : {23, 22, kFree}) {
        std::optional<CompiledCurve> best =
            fit(CompiledCurve::kMaxDegree, shift, CompiledCurve::kMaxSegments);
        if (!best) continue;
        const std::size_t most = best->segments <= 32 ? 32 : CompiledCurve::kMaxSegments;
        int too_low = CompiledCurve::kMinDegree - 1;
        while (best->degree - too_low > 1) {
            const int degree = too_low + (best->degree - too_low) / 2;
            if (const auto lower = fit(degree, shift, most)) {
                best = lower;
            } else {
                too_low = degree;
            }
        }
        return best;
    }
    return std::nullopt;
}

TONEWRIGHT_NAMESPACE_END
