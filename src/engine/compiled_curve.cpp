// SPDX-License-Identifier: Apache-2.0
#include "engine/compiled_curve.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <vector>

namespace tonewright {
namespace {

constexpr std::size_t kCoefficients = CompiledCurve::kDegree + 1;
using Coefficients = std::array<double, kCoefficients>;

/// Octaves below 1 are so many; x below is covered by one polynomial in any case.
constexpr int kLowestOctave = -24;

std::size_t entry(int exponent) {
    return static_cast<std::size_t>(exponent + 127) % CompiledCurve::kEntries;
}

/// Interpolates f at the Chebyshev nodes of [a, b], in powers of u.
Coefficients interpolate(const std::function<double(double)>& f, double a, double b,
                         std::size_t degree) {
    // Newton's divided differences, then expanded.
    std::array<double, kCoefficients> node{}, difference{};
    const auto n = static_cast<double>(degree + 1);
    for (std::size_t i = 0; i <= degree; ++i) {
        const double t = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.5) / n);
        node[i] = 0.5 * (a + b) + 0.5 * (b - a) * t;
        difference[i] = f(node[i]);
    }
    for (std::size_t k = 1; k <= degree; ++k) {
        for (std::size_t i = degree; i >= k; --i) {
            difference[i] = (difference[i] - difference[i - 1]) / (node[i] - node[i - k]);
        }
    }
    Coefficients c{};
    c[0] = difference[degree];
    for (std::size_t k = degree; k-- > 0;) {  // c = c (u - node[k]) + difference[k]
        for (std::size_t i = degree; i > 0; --i)
            c[i] = c[i - 1] - node[k] * c[i];
        c[0] = difference[k] - node[k] * c[0];
    }
    return c;
}

class CurveCompiler {
  public:
    CurveCompiler(const CurveFunction& f, const std::function<double(int)>& tolerance)
        : f_(f), tolerance_(tolerance) {}

    std::optional<CompiledCurve> compile(double x_max) {
        const double last = f_(x_max).y;
        int top = std::ilogb(x_max);
        while (top > kLowestOctave &&
               is_level(top, std::min(x_max, std::ldexp(1.0, top + 1)), last))
            --top;
        // All above the top octave holds the value at its end.
        curve_.highest =
            std::min(static_cast<float>(x_max), std::nextafter(std::ldexp(1.0F, top + 1), 0.0F));
        curve_.at_zero = static_cast<float>(f_(0).y);

        int lowest = top;
        while (!add_segment(lowest, 0, end_of(lowest))) {
            if (--lowest < kLowestOctave) return std::nullopt;
        }
        curve_.lowest_exponent = lowest;
        curve_.boundary[entry(lowest)] = std::numeric_limits<float>::infinity();
        if (top - lowest >= static_cast<int>(CompiledCurve::kEntries)) return std::nullopt;
        for (int e = lowest + 1; e <= top; ++e) {
            if (!add_octave(e)) return std::nullopt;
        }
        return curve_;
    }

  private:
    static float start_of(int exponent) { return std::ldexp(1.0F, exponent); }
    [[nodiscard]] float end_of(int exponent) const {
        return std::min(curve_.highest, std::nextafter(std::ldexp(1.0F, exponent + 1), 0.0F));
    }

    /// f is `level` from the start of the octave to x_max.
    [[nodiscard]] bool is_level(int exponent, double x_max, double level) const {
        for (double x = std::ldexp(1.0, exponent); x < x_max; x *= 1.05) {
            if (!(std::fabs(f_(x).y - level) <= 1e-9 * std::fabs(level))) return false;
        }
        return true;
    }

    bool add_octave(int e) {
        const float a = start_of(e);
        const float b = end_of(e);
        float boundary = std::numeric_limits<float>::infinity();
        curve_.segment[entry(e)] = static_cast<std::int32_t>(segment_count_);
        bool is_held = false;
        if (const std::optional<float> kink = first_kink(a, b)) {
            boundary = *kink;
        } else {
            is_held = add_segment(e, a, b);
            if (!is_held) boundary = 1.5F * a;
        }
        curve_.boundary[entry(e)] = boundary;
        return is_held ||
               (add_segment(e, a, std::nextafter(boundary, 0.0F)) && add_segment(e, boundary, b));
    }

    /// The first float in (a, b] on whose side the branches differ from those at a.
    [[nodiscard]] std::optional<float> first_kink(float a, float b) const {
        const std::uint64_t sides = f_(static_cast<double>(a)).sides;
        constexpr int kSteps = 64;
        float before = a;
        for (int i = 1; i <= kSteps; ++i) {
            float after = a + (b - a) * (static_cast<float>(i) / kSteps);
            if (f_(static_cast<double>(after)).sides == sides) {
                before = after;
                continue;
            }
            while (std::nextafter(before, after) < after) {
                const float middle = before + 0.5F * (after - before);
                (f_(static_cast<double>(middle)).sides == sides ? before : after) = middle;
            }
            return after;
        }
        return std::nullopt;
    }

    /// Appends the polynomial of [a, b] when one holds f there; lower degrees where the interval is
    /// so short that the higher ones round badly.
    bool add_segment(int exponent, float a, float b) {
        if (segment_count_ == CompiledCurve::kEntries) return false;
        const double scale = std::ldexp(1.0, -exponent);
        const auto of_u = [&](double u) { return f_((u + 1.5) / scale).y; };
        for (const std::size_t degree : {7, 6, 5, 4, 3, 2, 1, 0}) {
            const Coefficients c = interpolate(of_u, static_cast<double>(a) * scale - 1.5,
                                               static_cast<double>(b) * scale - 1.5, degree);
            for (std::size_t k = 0; k < kCoefficients; ++k) {
                curve_.coefficient[k][segment_count_] = static_cast<float>(c[k]);
            }
            if (is_within_tolerance(exponent, a, b)) {
                ++segment_count_;
                return true;
            }
        }
        return false;
    }

    [[nodiscard]] bool is_within_tolerance(int exponent, float a, float b) const {
        constexpr int kSamples = 96;
        const float inverse = std::ldexp(1.0F, -exponent);
        for (int i = 0; i <= kSamples; ++i) {
            const float x = std::clamp(a + (b - a) * (static_cast<float>(i) / kSamples), a, b);
            if (!(x > 0)) continue;
            const double truth = f_(static_cast<double>(x)).y;
            const float u = std::fma(x, inverse, -1.5F);
            float y = curve_.coefficient[CompiledCurve::kDegree][segment_count_];
            for (std::size_t k = CompiledCurve::kDegree; k-- > 0;) {
                y = std::fma(y, u, curve_.coefficient[k][segment_count_]);
            }
            // The lowest polynomial goes down to 0.
            const int e = std::min(exponent, std::ilogb(x));
            if (!(std::fabs(static_cast<double>(y) - truth) <= tolerance_(e))) return false;
        }
        return true;
    }

    const CurveFunction& f_;
    const std::function<double(int)>& tolerance_;
    CompiledCurve curve_;
    std::size_t segment_count_ = 0;
};

}  // namespace

float CompiledCurve::operator()(float x) const noexcept {
    if (!(x > 0)) return at_zero;
    x = std::min(x, highest);
    const int e = std::max(std::ilogb(x), lowest_exponent);
    const std::size_t i = entry(e);
    const auto s = static_cast<std::size_t>(segment[i]) + (x >= boundary[i] ? 1 : 0);
    const float u = std::fma(x, std::ldexp(1.0F, -e), -1.5F);
    float y = coefficient[kDegree][s];
    for (std::size_t k = kDegree; k-- > 0;)
        y = std::fma(y, u, coefficient[k][s]);
    return y;
}

std::optional<CompiledCurve> compile_curve(const CurveFunction& f, double x_max,
                                           const std::function<double(int)>& tolerance) {
    return CurveCompiler(f, tolerance).compile(x_max);
}

}  // namespace tonewright
