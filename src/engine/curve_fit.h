// SPDX-License-Identifier: Apache-2.0
//
// Fitting of compiled curves: the parts that segments (curve_segments.cpp) and rows
// (curve_rows.cpp) share.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "engine/compiled_curve.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace curves {

inline constexpr float kMostFloat = std::numeric_limits<float>::max();
inline constexpr double kFloatMax = static_cast<double>(kMostFloat);
/// All x below 2^kLowestExponent are in the first cell.
inline constexpr int kLowestExponent = -100;

inline float to_float(double x) { return static_cast<float>(x); }

inline constexpr std::size_t kMostNodes = CompiledCurve::kMaxDegree + 1;
using Coefficients = std::array<double, kMostNodes>;

/// Chebyshev nodes and polynomials, for interpolation at n points.
struct ChebyshevNumbers {
    Coefficients node{};                              // in [-1, 1]
    std::array<Coefficients, kMostNodes> cosine{};    // T_k at the nodes
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

inline double at(const CurveFunction& f, double x) {
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

/// The least number added so far, and how often it was added.
struct Least {
    double value = std::numeric_limits<double>::infinity();
    int times = 0;

    void add(double x) {
        if (x < value) times = 0;
        value = std::min(value, x);
        times += x == value ? 1 : 0;
    }
};

/// Least and largest value of a function that is sampled at many points.
class Ends {
  public:
    void add(double y) {
        least_.add(y);
        most_.add(-y);
    }
    /// Sets the curve's bounds. The samples may miss the lowest point of a dip, so the least value
    /// counts as a bound only if f has it at an end of its range or more than 8 times. The same
    /// holds for the largest value. Bounds are rounded outwards, so that they cut off no value of
    /// f.
    void set(CompiledCurve& curve, double first, double last) const {
        const bool has_least = least_.times > 8 || least_.value >= std::min(first, last);
        const bool has_most = most_.times > 8 || -most_.value <= std::max(first, last);
        curve.least = has_least ? -float_from(-least_.value) : -kMostFloat;
        curve.most = has_most ? float_from(-most_.value) : kMostFloat;
    }

  private:
    Least least_, most_;  // least values of f and of -f
};

/// A function to fit, with its kinks and its tolerance.
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

    /// True if polynomial(x) is within the tolerance over [begin, end]: at both ends, at and beside
    /// kinks, and between `steps` equal steps.
    template <class P>
    bool keeps(double begin, double end, int steps, const P& polynomial) {
        places_ = {begin, end};
        const auto behind = std::lower_bound(kinks_.begin(), kinks_.end(), to_float(begin));
        for (auto kink = behind; kink != kinks_.end(); ++kink) {
            if (static_cast<double>(*kink) > end) break;
            for (const float x :
                 {std::nextafter(*kink, 0.0F), *kink, std::nextafter(*kink, kMostFloat)}) {
                const auto place = static_cast<double>(x);
                if (place >= begin && place <= end) places_.push_back(place);
            }
        }
        // Ends and kinks come first, because the largest errors are most likely there.
        if (!keeps_at_places(polynomial)) return false;
        places_.clear();
        for (int i = 1; i < steps; ++i)
            places_.push_back(begin + (end - begin) * i / steps);
        if (begin == 0) {  // the tolerance may shrink with x
            for (double x = end; x > 0x1p-126; x *= 0.37)
                places_.push_back(x);
        }
        return keeps_at_places(polynomial);
    }

    /// A curve with the members that all forms have in common.
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
    std::vector<float> kinks_;  // ascending
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

[[nodiscard]] std::optional<CompiledCurve> fit_segments(const CurveFunction& f, double hi,
                                                        std::span<const double> kinks,
                                                        const CurveTolerance& tolerance,
                                                        bool is_precise);
[[nodiscard]] std::optional<CompiledCurve> fit_rows(const CurveFunction& f, double hi,
                                                    std::span<const double> kinks,
                                                    const CurveTolerance& tolerance,
                                                    bool is_precise, bool is_fused);

/// Value of a curve, computed in its form.
/// @param x  above lo, up to hi
[[nodiscard]] double value_by_segments(const CompiledCurve& curve, double x) noexcept;
[[nodiscard]] double value_by_rows(const CompiledCurve& curve, double x) noexcept;
/// Slope of a curve.
/// @param x  from lo to hi
[[nodiscard]] double slope_by_segments(const CompiledCurve& curve, double x) noexcept;
[[nodiscard]] double slope_by_rows(const CompiledCurve& curve, double x) noexcept;

}  // namespace curves
TONEWRIGHT_NAMESPACE_END
