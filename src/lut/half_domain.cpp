// SPDX-License-Identifier: Apache-2.0
#include "lut/half_domain.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {
constexpr unsigned kSignBit = 0x8000;
constexpr unsigned kLargestFinite = 0x7BFF;
}  // namespace

std::vector<signed char> unused_entries(const std::vector<float>& table, double lo, double hi) {
    std::vector<signed char> slack(kHalfCount);
    if (lo <= -kHalfMax && hi >= kHalfMax) return slack;
    std::vector<char> is_used(kHalfCount);
    float at_lo = 0;
    float at_hi = 0;
    double lowest = kInfinity;
    double highest = -kInfinity;
    for (unsigned bits = 0; bits < kHalfCount; ++bits) {
        const double h = half_value(bits);
        is_used[bits] = h >= lo && h <= hi ? 1 : 0;
        if (!is_used[bits]) continue;
        if (h < lowest) {
            lowest = h;
            at_lo = table[bits];
        }
        if (h > highest) {
            highest = h;
            at_hi = table[bits];
        }
    }
    const signed char above = at_lo <= at_hi ? 1 : -1;
    for (unsigned bits = 0; bits < kHalfCount; ++bits) {
        const bool is_next =
            (bits > 0 && is_used[bits - 1]) || (bits + 1 < kHalfCount && is_used[bits + 1]);
        if (is_used[bits] || is_next || bits == kSignBit || bits == 0) continue;
        slack[bits] = static_cast<signed char>(half_value(bits) < lo ? -above : above);
    }
    return slack;
}

std::vector<float> sample_half_domain(const Expr& f, double lo, double hi) {
    lo = std::max(lo, -kHalfMax);
    hi = std::min(hi, kHalfMax);
    const ReferenceEngine engine({curve_stage(f)});
    // Interpolation reaches a bound between two half floats from the entry beyond it. That entry
    // keeps the value of the curve; a held value would show a kink inside the interval.
    const auto neighbor_is_inside = [&](unsigned bits) {
        const unsigned sign = bits & kSignBit;
        const unsigned magnitude = bits & ~kSignBit;
        const auto inside = [&](unsigned m) {
            const double h = half_value(sign | m);
            return h > lo && h < hi;
        };
        return (magnitude > 0 && inside(magnitude - 1)) ||
               (magnitude < kLargestFinite && inside(magnitude + 1));
    };
    std::vector<double> x(kHalfCount);
    for (unsigned bits = 0; bits < kHalfCount; ++bits) {
        const double h = sanitize(half_value(bits));
        const bool keep = h >= lo && h <= hi;
        x[bits] = keep || (neighbor_is_inside(bits) && std::isfinite(evaluate(f, h)))
                      ? h
                      : std::clamp(h, lo, hi);
    }
    std::vector<double> y(kHalfCount);
    engine.run({x.data(), x.data(), x.data()}, {y.data(), y.data(), y.data()}, kHalfCount);
    // Overflow becomes the largest float, because an infinite entry makes its neighbors NaN.
    constexpr auto largest = static_cast<double>(std::numeric_limits<float>::max());
    for (double& value : y)
        value = std::clamp(value, -largest, largest);
    std::vector<float> table(y.begin(), y.end());
    table[kSignBit] = table[0];
    return table;
}

TONEWRIGHT_NAMESPACE_END
