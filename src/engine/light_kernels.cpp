// SPDX-License-Identifier: Apache-2.0
//
// Metering, once for each instruction set.
//
// Logarithms are not computed pixel by pixel: the sum of the logarithms of a span is the logarithm
// of a product, whose exponent is added up apart from its mantissa. One rounding of 2^-53 for each
// pixel, none of them of the size of a logarithm.
#include "engine/light_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/light_kernels.cpp"
// As simd_kernels.cpp.
#define HWY_DISABLED_TARGETS HWY_SSSE3
#include "hwy/foreach_target.h"  // IWYU pragma: keep

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace tonewright::light {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Every sum has this many lanes. Where a vector has fewer, the span is gone through once for each
/// part of them, so that the same numbers meet everywhere.
constexpr std::size_t kLanes = 8;
using DD = hn::CappedTag<double, kLanes>;
using DF = hn::Rebind<float, DD>;
using DU = hn::RebindToUnsigned<DD>;
using VD = hn::Vec<DD>;
using VU = hn::Vec<DU>;

void split(const float* pixels, int channels, std::size_t count, Planes& to) {
    const DD dd;
    const DF df;
    const std::size_t lanes = hn::Lanes(dd);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) {
        hn::Vec<DF> r, g, b;
        if (channels == 4) {
            hn::Vec<DF> a;
            hn::LoadInterleaved4(df, pixels + 4 * i, r, g, b, a);
            hn::StoreU(hn::PromoteTo(dd, a), dd, to[3].data() + i);
        } else {
            hn::LoadInterleaved3(df, pixels + 3 * i, r, g, b);
        }
        hn::StoreU(hn::PromoteTo(dd, r), dd, to[0].data() + i);
        hn::StoreU(hn::PromoteTo(dd, g), dd, to[1].data() + i);
        hn::StoreU(hn::PromoteTo(dd, b), dd, to[2].data() + i);
    }
    const auto step = static_cast<std::size_t>(channels);
    for (; i < count; ++i) {
        for (std::size_t c = 0; c < step; ++c)
            to[c][i] = static_cast<double>(pixels[step * i + c]);
    }
}

Kinds kinds(Planes& planes, std::size_t count, bool has_alpha) {
    const DD d;
    const std::size_t lanes = hn::Lanes(d);
    const VD zero = hn::Zero(d);
    const VD one = hn::Set(d, 1.0);
    VD bad = zero;
    auto clear = hn::Lt(one, zero);
    auto veiled = clear;
    for (std::size_t i = 0; i < padded(count); i += lanes) {
        // x - x is NaN for NaN and infinities, else 0.
        for (std::size_t c = 0; c < 3; ++c) {
            const VD x = hn::LoadU(d, planes[c].data() + i);
            bad = hn::Or(bad, hn::Sub(x, x));
        }
        if (!has_alpha) continue;
        const VD a = hn::LoadU(d, planes[3].data() + i);
        clear = hn::Or(clear, hn::Or(hn::Eq(a, zero), hn::Ne(hn::Sub(a, a), zero)));
        veiled = hn::Or(veiled, hn::Ne(a, one));
    }
    return {hn::AllTrue(d, hn::Eq(bad, zero)), hn::AllFalse(d, clear), hn::AllFalse(d, veiled)};
}

void divide_by_alpha(Planes& planes, std::size_t count) {
    const DD d;
    for (std::size_t i = 0; i < padded(count); i += hn::Lanes(d)) {
        const VD a = hn::LoadU(d, planes[3].data() + i);
        for (std::size_t c = 0; c < 3; ++c) {
            double* x = planes[c].data() + i;
            hn::StoreU(hn::Div(hn::LoadU(d, x), a), d, x);
        }
    }
}

/// A row of a matrix times a color, added up from left to right.
HWY_INLINE VD weighted(const Vector3& row, VD r, VD g, VD b) {
    const DD d;
    return hn::Add(hn::Add(hn::Mul(hn::Set(d, row[0]), r), hn::Mul(hn::Set(d, row[1]), g)),
                   hn::Mul(hn::Set(d, row[2]), b));
}

void weigh(Planes& planes, std::size_t count, const Matrix3* to_rec709, double* luminance) {
    const DD d;
    const auto limit = [&](VD x, double least) HWY_ATTR {
        return hn::Min(hn::Max(x, hn::Set(d, least)), hn::Set(d, kHalfMax));
    };
    for (std::size_t i = 0; i < padded(count); i += hn::Lanes(d)) {
        VD r = hn::LoadU(d, planes[0].data() + i);
        VD g = hn::LoadU(d, planes[1].data() + i);
        VD b = hn::LoadU(d, planes[2].data() + i);
        if (to_rec709) {
            const VD x = limit(r, -kHalfMax), y = limit(g, -kHalfMax), z = limit(b, -kHalfMax);
            r = weighted((*to_rec709)[0], x, y, z);
            g = weighted((*to_rec709)[1], x, y, z);
            b = weighted((*to_rec709)[2], x, y, z);
        }
        r = limit(r, 0);
        g = limit(g, 0);
        b = limit(b, 0);
        hn::StoreU(r, d, planes[0].data() + i);
        hn::StoreU(g, d, planes[1].data() + i);
        hn::StoreU(b, d, planes[2].data() + i);
        hn::StoreU(weighted(kRec709Weights, r, g, b), d, luminance + i);
    }
}

/// D. Knuth, The Art of Computer Programming 2, 4.2.2, theorem B: the sum and its rounding error.
HWY_INLINE void add_compensated(VD x, VD& sum, VD& lost) {
    const VD total = hn::Add(sum, x);
    const VD part = hn::Sub(total, sum);
    lost = hn::Add(lost, hn::Add(hn::Sub(sum, hn::Sub(total, part)), hn::Sub(x, part)));
    sum = total;
}

/// @param exponent  biased, added up
HWY_INLINE void multiply(VD x, VD& mantissa, VU& exponent) {
    const DD d;
    const DU du;
    const VU bits = hn::BitCast(du, x);
    exponent = hn::Add(exponent, hn::ShiftRight<52>(bits));
    const VU digits = hn::And(bits, hn::Set(du, 0xFFFFFFFFFFFFFULL));
    mantissa = hn::Mul(mantissa, hn::BitCast(d, hn::Or(digits, hn::BitCast(du, hn::Set(d, 1.0)))));
}

void add_up(const Planes& planes, const double* luminance, std::size_t count, double delta,
            SpanLight& light) {
    const DD d;
    const DU du;
    const std::size_t lanes = hn::Lanes(d);
    const VD zero = hn::Zero(d);
    const VD one = hn::Set(d, 1.0);
    const VD infinity = hn::Set(d, std::numeric_limits<double>::infinity());
    const VD offset = hn::Set(d, delta);
    const std::size_t end = padded(count);
    // For each of the eight lanes, wherever it was.
    std::array<std::array<double, kLanes>, 3> sum, lost, top;
    std::array<double, kLanes> maximum, minimum, lit, lit_mantissa, delta_mantissa;
    std::array<std::uint64_t, kLanes> lit_exponent, delta_exponent;
    for (std::size_t lane = 0; lane < kLanes; lane += lanes) {
        for (std::size_t c = 0; c < 3; ++c) {
            VD s = zero, e = zero, m = zero;
            for (std::size_t i = lane; i < end; i += kBlock) {
                const double* p = planes[c].data() + i;
                const VD x0 = hn::LoadU(d, p), x1 = hn::LoadU(d, p + 8);
                const VD x2 = hn::LoadU(d, p + 16), x3 = hn::LoadU(d, p + 24);
                const VD x4 = hn::LoadU(d, p + 32), x5 = hn::LoadU(d, p + 40);
                const VD x6 = hn::LoadU(d, p + 48), x7 = hn::LoadU(d, p + 56);
                add_compensated(hn::Add(hn::Add(hn::Add(x0, x1), hn::Add(x2, x3)),
                                        hn::Add(hn::Add(x4, x5), hn::Add(x6, x7))),
                                s, e);
                m = hn::Max(m, hn::Max(hn::Max(hn::Max(x0, x1), hn::Max(x2, x3)),
                                       hn::Max(hn::Max(x4, x5), hn::Max(x6, x7))));
            }
            hn::StoreU(s, d, sum[c].data() + lane);
            hn::StoreU(e, d, lost[c].data() + lane);
            hn::StoreU(m, d, top[c].data() + lane);
        }
        VD largest = zero, smallest = infinity, lit_count = zero;
        VD lit_product = one, delta_product = one;
        VU lit_exponents = hn::Zero(du), delta_exponents = hn::Zero(du);
        for (std::size_t i = lane; i < end; i += 4 * kLanes) {
            // Four luminances at once stay far from the ends of double's range.
            VD p = one, q = one;
            for (std::size_t k = 0; k < 4; ++k) {
                const VD y = hn::LoadU(d, luminance + i + k * kLanes);
                const auto is_lit = hn::Gt(y, zero);
                largest = hn::Max(largest, y);
                smallest = hn::Min(smallest, hn::IfThenElse(is_lit, y, infinity));
                lit_count = hn::Add(lit_count, hn::IfThenElseZero(is_lit, one));
                p = hn::Mul(p, hn::IfThenElse(is_lit, y, one));
                q = hn::Mul(q, hn::IfThenElse(hn::Ge(y, zero), hn::Add(y, offset), one));
            }
            multiply(p, lit_product, lit_exponents);
            multiply(q, delta_product, delta_exponents);
        }
        hn::StoreU(largest, d, maximum.data() + lane);
        hn::StoreU(smallest, d, minimum.data() + lane);
        hn::StoreU(lit_count, d, lit.data() + lane);
        hn::StoreU(lit_product, d, lit_mantissa.data() + lane);
        hn::StoreU(delta_product, d, delta_mantissa.data() + lane);
        hn::StoreU(lit_exponents, du, lit_exponent.data() + lane);
        hn::StoreU(delta_exponents, du, delta_exponent.data() + lane);
    }
    light.minimum_lit = std::numeric_limits<double>::infinity();
    const auto bias = static_cast<std::int64_t>(1023 * (end / (4 * kLanes)));
    for (std::size_t k = 0; k < kLanes; ++k) {
        for (std::size_t c = 0; c < 3; ++c) {
            CompensatedSum& all = light.rgb[c];
            const double total = all.sum + sum[c][k];
            const double part = total - all.sum;
            all.lost += ((all.sum - (total - part)) + (sum[c][k] - part)) + lost[c][k];
            all.sum = total;
            light.maximum_rgb[c] = std::max(light.maximum_rgb[c], top[c][k]);
        }
        light.maximum = std::max(light.maximum, maximum[k]);
        light.minimum_lit = std::min(light.minimum_lit, minimum[k]);
        light.lit_count += static_cast<std::size_t>(lit[k]);
        light.lit.mantissa *= lit_mantissa[k];
        light.lit.exponent += static_cast<std::int64_t>(lit_exponent[k]) - bias;
        light.with_delta.mantissa *= delta_mantissa[k];
        light.with_delta.exponent += static_cast<std::int64_t>(delta_exponent[k]) - bias;
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace tonewright::light
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tonewright::light {
namespace {

HWY_EXPORT(split);
HWY_EXPORT(kinds);
HWY_EXPORT(divide_by_alpha);
HWY_EXPORT(weigh);
HWY_EXPORT(add_up);

void fill_up(std::array<double, kSpan>& plane, std::size_t count, double with) {
    std::fill(plane.begin() + static_cast<std::ptrdiff_t>(count),
              plane.begin() + static_cast<std::ptrdiff_t>(padded(count)), with);
}

}  // namespace

void split(const float* pixels, int channels, std::size_t count, Planes& to) noexcept {
    HWY_DYNAMIC_DISPATCH(split)(pixels, channels, count, to);
}

Kinds kinds(Planes& planes, std::size_t count, bool has_alpha) noexcept {
    for (std::size_t c = 0; c < 4; ++c)
        fill_up(planes[c], count, c < 3 ? 0 : 1);
    return HWY_DYNAMIC_DISPATCH(kinds)(planes, count, has_alpha);
}

void divide_by_alpha(Planes& planes, std::size_t count) noexcept {
    HWY_DYNAMIC_DISPATCH(divide_by_alpha)(planes, count);
}

void weigh(Planes& planes, std::size_t count, const Matrix3* to_rec709,
           std::array<double, kSpan>& luminance) noexcept {
    for (std::size_t c = 0; c < 3; ++c)
        fill_up(planes[c], count, 0);
    HWY_DYNAMIC_DISPATCH(weigh)(planes, count, to_rec709, luminance.data());
    fill_up(luminance, count, kNoPixel);
}

SpanLight add_up(const Planes& planes, const std::array<double, kSpan>& luminance,
                 std::size_t count, double delta) noexcept {
    SpanLight light;
    HWY_DYNAMIC_DISPATCH(add_up)(planes, luminance.data(), count, delta, light);
    // Four of these together could leave double's range: pictures of doubles have such.
    if (light.minimum_lit < 0x1p-250) {
        std::array<double, kSpan> lit{};
        std::size_t n = 0;
        for (std::size_t i = 0; i < count; ++i) {
            if (luminance[i] > 0) lit[n++] = luminance[i];
        }
        light.lit = product_of(lit.data(), n);
    }
    return light;
}

Product product_of(const double* values, std::size_t count) noexcept {
    Product product;
    for (std::size_t i = 0; i < count; ++i) {
        int exponent = 0;
        product.mantissa *= std::frexp(values[i], &exponent);
        product.exponent += exponent;
        int carried = 0;
        product.mantissa = std::frexp(product.mantissa, &carried);
        product.exponent += carried;
    }
    return product;
}

}  // namespace tonewright::light
#endif  // HWY_ONCE
