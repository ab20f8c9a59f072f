// SPDX-License-Identifier: Apache-2.0
#include "engine/compiled_curve.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/curve_fit.h"

TONEWRIGHT_NAMESPACE_BEGIN
using curves::kFloatMax;
using curves::to_float;
namespace {

constexpr double kHalfUlp = 0x1p-24;

/// Numbers from `from` to `to`, both included, one in every half octave.
std::vector<double> half_octaves(double from, double to) {
    std::vector<double> places = {from};
    for (double x = from * 1.5; x < to; x *= std::numbers::sqrt2)
        places.push_back(x);
    places.push_back(to);
    return places;
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

double CompiledCurve::operator()(double x) const noexcept {
    if (!(x > static_cast<double>(lo)))  // NaN, too
        return is_precise ? at_lo : static_cast<double>(to_float(at_lo));
    x = std::min(x, static_cast<double>(hi));
    const double y = rows ? curves::value_by_rows(*this, x) : curves::value_by_segments(*this, x);
    return std::clamp(y, static_cast<double>(least), static_cast<double>(most));
}

double CompiledCurve::slope(double x) const noexcept {
    if (!(x >= static_cast<double>(lo) && x <= static_cast<double>(hi))) return 0;
    return rows ? curves::slope_by_rows(*this, x) : curves::slope_by_segments(*this, x);
}

int CompiledCurve::cost() const noexcept {
    if (rows) {
        return 36 + (rows->length > 4 ? 28 : 0) + 4 * static_cast<int>(rows->restarts.size()) +
               (is_precise ? 24 : 0);
    }
    const int steps = static_cast<int>(std::bit_width(static_cast<unsigned>(segments))) -
                      1;  // steps of the search
    const int of_cells = cells == 0 ? steps * (segments <= 32 ? 4 : 8) : 2 * (cells <= 32 ? 1 : 3);
    const int of_segments = (degree + 3) * (segments <= 32 ? 1 : 3);
    const int of_doubles = is_precise ? 24 : 0;
    return 12 + of_cells + of_segments + degree + of_doubles;
}

std::optional<CompiledCurve> compile_curve(const CurveFunction& f, std::array<double, 2> range,
                                           std::span<const double> kinks,
                                           const CurveTolerance& tolerance, CurveForm form,
                                           bool is_precise) {
    const double at_zero = curves::at(f, 0);
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
    const double at_top = curves::at(f, hi);
    if (!std::isfinite(at_top)) return std::nullopt;
    while (hi > 0x1p-60 && is_constant(hi / 2, hi, at_top))
        hi = static_cast<double>(to_float(hi / 2));

    if (form == CurveForm::segments)
        return curves::fit_segments(f, hi, kinks, tolerance, is_precise);
    // A curve ends at a kink above which f is constant, so the fit has one kink less.
    for (const double kink : kinks) {
        const auto end = static_cast<double>(float_from(kink));
        if (end > 0x1p-60 && end < hi && is_constant(end, hi, at_top)) hi = end;
    }
    return curves::fit_rows(f, hi, kinks, tolerance, is_precise, form == CurveForm::rows);
}

TONEWRIGHT_NAMESPACE_END
