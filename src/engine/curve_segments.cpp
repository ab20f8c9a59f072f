// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "engine/curve_fit.h"

TONEWRIGHT_NAMESPACE_BEGIN

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
    // Floats that are not negative have the same order as their bits.
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

namespace curves {
namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();

/// One piece of a curve under construction.
struct Segment {
    double begin, end;
    float scale, offset;
    std::array<float, CompiledCurve::kMaxDegree + 1> coefficients;
    float rest;
};

/// The polynomial at x, with the arithmetic of the kernels. x is a double for a precise curve and a
/// float for any other.
/// @param coefficient  coefficient(k): the coefficient of t^k
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

class CurveFit : Fit {
  public:
    CurveFit(const CurveFunction& f, double hi, std::span<const double> kinks,
             const CurveTolerance& tolerance, bool is_precise, int degree, int shift,
             std::size_t most_segments)
        : Fit(f, hi, kinks, tolerance, is_precise),
          degree_(degree),
          shift_(shift),
          most_segments_(most_segments) {}

    /// Fits segments of any length, without cells.
    std::optional<CompiledCurve> fit_free() {
        // Segments end at kinks and at eighths of octaves.
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
        std::size_t next = 0;     // index of the first end above begin
        std::size_t stride = 64;  // length of the previous segment, in ends
        while (next < ends.size()) {
            const auto fits = [&](std::size_t i) {
                // A segment ends with the float before its end, but for the last segment.
                const double end =
                    i + 1 == ends.size()
                        ? ends[i]
                        : static_cast<double>(std::nextafter(to_float(ends[i]), 0.0F));
                return try_segment(begin, end);
            };
            // Doubles the stride while the segment fits, then bisects.
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
        // The first segment begins at 0 and reaches as far up as one polynomial fits.
        const auto top = cell_of(to_float(hi_));
        std::uint32_t lowest = cell_of(to_float(std::ldexp(1.0, kLowestExponent)));
        if (!try_segment(0, std::min(edge(lowest + 1), hi_))) return std::nullopt;
        std::uint32_t failing = top + 2;
        while (failing - lowest > 1) {  // the polynomial fits up to the end of `lowest`
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

    /// Fits a polynomial over [begin, end] into tried_. Returns true if it is within the tolerance.
    bool try_segment(double begin, double end) {
        Segment s{};
        s.begin = begin;
        s.end = end;
        const double middle = 0.5 * (begin + end);
        const double half = std::max({0.5 * (end - begin), 1e-6 * end, 0x1p-110});
        s.scale = to_float(1 / half);
        s.offset = to_float(-middle / half);
        // x as a function of t, with the rounded scale and offset.
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
        // The previous segment is extended if its polynomial fits.
        if (extend(end)) {
            cells_.push_back({current, kNever});
            return true;
        }
        if (try_segment(begin, end)) {
            segments_.push_back(tried_);
            cells_.push_back({current + 1, kNever});
            return true;
        }
        // Two segments in this cell, divided at a kink or in the middle.
        std::vector<double> boundaries;
        for (const float kink : kinks_)
            boundaries.push_back(static_cast<double>(kink));
        boundaries.push_back(static_cast<double>(float_from(0.5 * (begin + end))));
        for (const double boundary : boundaries) {
            if (!(boundary > begin && boundary < end)) continue;
            // The first segment ends with the float before the boundary.
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
        // A polynomial over more than three octaves rarely fits.
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

}  // namespace

std::optional<CompiledCurve> fit_segments(const CurveFunction& f, double hi,
                                          std::span<const double> kinks,
                                          const CurveTolerance& tolerance, bool is_precise) {
    // Shift for segments without cells, which end at eighths of octaves.
    constexpr int kFree = 20;
    const auto fit = [&](int degree, int shift, std::size_t most_segments) {
        CurveFit curve(f, hi, kinks, tolerance, is_precise, degree, shift, most_segments);
        return shift == kFree ? curve.fit_free() : curve.fit();
    };
    // With more than 32 segments, each coefficient costs three times as much. A degree costs its
    // coefficient and one instruction. So the lowest degree with at most 32 segments is the best.
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

double value_by_segments(const CompiledCurve& curve, double x) noexcept {
    const std::size_t s = curve.segment_of(to_float(x));
    const auto of_power = [&](int k) { return curve.coefficient[static_cast<std::size_t>(k)][s]; };
    return evaluate(x, curve.scale[s], curve.offset[s], curve.degree, of_power, curve.rest[s],
                    curve.is_precise);
}

double slope_by_segments(const CompiledCurve& curve, double x) noexcept {
    const std::size_t s = curve.segment_of(to_float(x));
    const auto scale = static_cast<double>(curve.scale[s]);
    const double t = x * scale + static_cast<double>(curve.offset[s]);
    double y = 0;
    for (auto k = static_cast<std::size_t>(curve.degree) + 1; k-- > 1;)
        y = y * t + static_cast<double>(k) * static_cast<double>(curve.coefficient[k][s]);
    return y * scale;
}

}  // namespace curves
TONEWRIGHT_NAMESPACE_END
