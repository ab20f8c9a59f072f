// SPDX-License-Identifier: Apache-2.0
//
// Metering, once for each instruction set.
//
// The sum of the logarithms of a span is the logarithm of a product. Its exponent is summed
// separately from its mantissa. Each pixel adds one rounding of 2^-53, much less than the rounding
// of a logarithm.
#include "image/metering_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/kernel_targets.h"

#ifndef TONEWRIGHT_METERING_KERNELS_ONCE
#define TONEWRIGHT_METERING_KERNELS_ONCE
TONEWRIGHT_NAMESPACE_BEGIN
namespace light {
namespace {
/// See kernels_of_this_machine().
struct Compiled {
    template <std::int64_t kTarget>
    static constexpr const Kernels* kernels = nullptr;
};
}  // namespace
}  // namespace light
TONEWRIGHT_NAMESPACE_END
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "image/metering_kernels.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
TONEWRIGHT_NAMESPACE_BEGIN
namespace light {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Every sum has this many lanes. If a vector has fewer, the span is read once for each part of the
/// lanes, so that the same numbers are added everywhere.
constexpr std::size_t kLanes = 8;
using DD = hn::CappedTag<double, kLanes>;
using DF = hn::Rebind<float, DD>;
using DU = hn::RebindToUnsigned<DD>;
using VD = hn::Vec<DD>;
using VU = hn::Vec<DU>;

void split(const float* pixels, int channels, std::size_t count, Planes& to) noexcept {
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

Kinds kinds(Planes& planes, std::size_t count, bool has_alpha) noexcept {
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
        // Not Ne(), which is false for NaN on some instruction sets.
        clear = hn::Or(clear, hn::Or(hn::Eq(a, zero), hn::Not(hn::Eq(hn::Sub(a, a), zero))));
        veiled = hn::Or(veiled, hn::Not(hn::Eq(a, one)));
    }
    return {hn::AllTrue(d, hn::Eq(bad, zero)), hn::AllFalse(d, clear), hn::AllFalse(d, veiled)};
}

bool are_plain(const float* pixels, int channels, std::size_t count, bool has_alpha) noexcept {
    const std::size_t all = count * static_cast<std::size_t>(channels);
    std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
    const hn::ScalableTag<float> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    const std::size_t lanes = hn::Lanes(d);
    const auto fourth = hn::Set(du, channels == 4 ? 3U : 4U);
    const auto is_fourth =
        hn::RebindMask(d, hn::Eq(hn::And(hn::Iota(du, 0), hn::Set(du, 3U)), fourth));
    // Bits that must be 0: those of x - x, which is NaN for NaN and infinities, or of alpha - 1.
    auto wrong = hn::Zero(d);
    for (; i + lanes <= all; i += lanes) {
        const auto x = hn::LoadU(d, pixels + i);
        const auto of_fourth = has_alpha ? hn::Sub(x, hn::Set(d, 1.0F)) : hn::Zero(d);
        wrong = hn::Or(wrong, hn::IfThenElse(is_fourth, of_fourth, hn::Sub(x, x)));
    }
    if (!hn::AllTrue(du, hn::Eq(hn::BitCast(du, wrong), hn::Zero(du)))) return false;
#endif
    for (; i < all; ++i) {
        const bool is_fourth_one = channels == 4 && i % 4 == 3;
        if (is_fourth_one ? has_alpha && pixels[i] != 1 : !std::isfinite(pixels[i])) return false;
    }
    return true;
}

/// divisor_of() of source_picture.h, with the same roundings.
HWY_INLINE VD divisor_of(VD alpha, VD most, VD limit) {
    const DD d;
    const VD one = hn::Set(d, 1.0);
    const VD surface = hn::Mul(limit, hn::Abs(alpha));
    const VD share = hn::Div(hn::Sub(most, surface), most);
    const VD mixed = hn::Add(alpha, hn::Mul(hn::Sub(one, alpha), share));
    const VD of_emission = hn::IfThenElse(hn::Lt(alpha, hn::Zero(d)), one, mixed);
    const auto is_emission = hn::And(hn::Gt(most, surface), hn::Lt(alpha, one));
    return hn::IfThenElse(is_emission, of_emission, alpha);
}

void divide_by_alpha(Planes& planes, std::size_t count, double limit) noexcept {
    const DD d;
    for (std::size_t i = 0; i < padded(count); i += hn::Lanes(d)) {
        const auto plane = [&](std::size_t c) { return hn::LoadU(d, planes[c].data() + i); };
        // Not Max(), whose result for NaN depends on the instruction set.
        VD most = hn::Set(d, -std::numeric_limits<double>::infinity());
        for (std::size_t c = 0; c < 3; ++c)
            most = hn::IfThenElse(hn::Lt(most, plane(c)), plane(c), most);
        const VD a = divisor_of(plane(3), most, hn::Set(d, limit));
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

/// Pixels of a block: planes of doubles.
struct PlaneBlock {
    const double *red, *green, *blue;

    HWY_INLINE void load(std::size_t i, VD& r, VD& g, VD& b) const {
        const DD d;
        r = hn::LoadU(d, red + i);
        g = hn::LoadU(d, green + i);
        b = hn::LoadU(d, blue + i);
    }
};
struct PlanePixels {
    const Planes& planes;

    HWY_INLINE PlaneBlock block(std::size_t begin) const {
        return {planes[0].data() + begin, planes[1].data() + begin, planes[2].data() + begin};
    }
};

/// Interleaved floats.
template <std::size_t kChannels>
struct PackedBlock {
    const float* pixels;

    HWY_INLINE void load(std::size_t i, VD& r, VD& g, VD& b) const {
        const DD dd;
        const DF df;
        hn::Vec<DF> red, green, blue, alpha;
        if constexpr (kChannels == 4) {
            hn::LoadInterleaved4(df, pixels + 4 * i, red, green, blue, alpha);
        } else {
            hn::LoadInterleaved3(df, pixels + 3 * i, red, green, blue);
        }
        r = hn::PromoteTo(dd, red);
        g = hn::PromoteTo(dd, green);
        b = hn::PromoteTo(dd, blue);
    }
};
template <std::size_t kChannels>
class PackedPixels {
  public:
    /// An incomplete last block is copied, so that it can be read as a whole.
    PackedPixels(const float* pixels, std::size_t count)
        : pixels_(pixels), whole_(count / kBlock * kBlock) {
        if (whole_ < count)
            std::copy(pixels + kChannels * whole_, pixels + kChannels * count, rest_.begin());
    }
    HWY_INLINE PackedBlock<kChannels> block(std::size_t begin) const {
        return {begin < whole_ ? pixels_ + kChannels * begin : rest_.data()};
    }

  private:
    const float* pixels_;
    std::size_t whole_;
    std::array<float, kChannels * kBlock> rest_{};
};

template <bool kConverts, class Pixels>
HWY_INLINE void add_up(const Pixels& pixels, std::size_t count, const Weighing& weighing,
                       double* luminance, SpanLight& light) {
    const DD d;
    const DU du;
    const std::size_t lanes = hn::Lanes(d);
    const VD zero = hn::Zero(d);
    const VD one = hn::Set(d, 1.0);
    const VD infinity = hn::Set(d, std::numeric_limits<double>::infinity());
    const VD offset = hn::Set(d, weighing.delta);
    const auto limit = [](VD x, double least) HWY_ATTR {
        return hn::Min(hn::Max(x, hn::Set(DD(), least)), hn::Set(DD(), kLargestLight));
    };
    // For each of the eight lanes, in any vector.
    std::array<std::array<double, kLanes>, 3> sum, lost, top;
    std::array<double, kLanes> maximum, minimum, lit, lit_mantissa, delta_mantissa;
    std::array<std::uint64_t, kLanes> lit_exponent, delta_exponent;
    for (std::size_t lane = 0; lane < kLanes; lane += lanes) {
        VD sums[3] = {zero, zero, zero}, errors[3] = {zero, zero, zero};
        VD tops[3] = {zero, zero, zero};
        VD largest = zero, smallest = infinity, lit_count = zero;
        VD lit_product = one, delta_product = one;
        VU lit_exponents = hn::Zero(du), delta_exponents = hn::Zero(du);
        const auto add_block = [&](std::size_t begin, auto is_whole) HWY_ATTR {
            const auto block = pixels.block(begin);
            VD of_block[3] = {zero, zero, zero};
            // Four luminances at once stay far from the ends of double's range.
            VD p = one, q = one;
            for (std::size_t k = lane; k < kBlock; k += kLanes) {
                VD r, g, b;
                block.load(k, r, g, b);
                if constexpr (kConverts) {
                    const VD x = limit(r, -kLargestLight), y = limit(g, -kLargestLight);
                    const VD z = limit(b, -kLargestLight);
                    r = weighted((*weighing.to_rec709)[0], x, y, z);
                    g = weighted((*weighing.to_rec709)[1], x, y, z);
                    b = weighted((*weighing.to_rec709)[2], x, y, z);
                }
                const VD rgb[3] = {limit(r, 0), limit(g, 0), limit(b, 0)};
                for (std::size_t c = 0; c < 3; ++c) {
                    of_block[c] = hn::Add(of_block[c], rgb[c]);
                    tops[c] = hn::Max(tops[c], rgb[c]);
                }
                const VD y = weighted(kRec709Weights, rgb[0], rgb[1], rgb[2]);
                hn::StoreU(y, d, luminance + begin + k);
                const auto is_lit = hn::Gt(y, zero);
                largest = hn::Max(largest, y);
                smallest = hn::Min(smallest, hn::IfThenElse(is_lit, y, infinity));
                lit_count = hn::Add(lit_count, hn::IfThenElseZero(is_lit, one));
                p = hn::Mul(p, hn::IfThenElse(is_lit, y, one));
                VD with_delta = hn::Add(y, offset);
                if constexpr (!is_whole) {
                    const auto place = hn::Iota(d, static_cast<double>(begin + k));
                    with_delta = hn::IfThenElse(
                        hn::Lt(place, hn::Set(d, static_cast<double>(count))), with_delta, one);
                }
                q = hn::Mul(q, with_delta);
                if (k / kLanes % 4 != 3) continue;
                multiply(p, lit_product, lit_exponents);
                multiply(q, delta_product, delta_exponents);
                p = one;
                q = one;
            }
            for (std::size_t c = 0; c < 3; ++c)
                add_compensated(of_block[c], sums[c], errors[c]);
        };
        const std::size_t whole = count / kBlock * kBlock;
        for (std::size_t i = 0; i < whole; i += kBlock)
            add_block(i, std::true_type());
        if (whole < count) add_block(whole, std::false_type());
        for (std::size_t c = 0; c < 3; ++c) {
            hn::StoreU(sums[c], d, sum[c].data() + lane);
            hn::StoreU(errors[c], d, lost[c].data() + lane);
            hn::StoreU(tops[c], d, top[c].data() + lane);
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
    const auto bias = static_cast<std::int64_t>(1023 * (padded(count) / (4 * kLanes)));
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

template <class Pixels>
HWY_INLINE void add_up_any(const Pixels& pixels, std::size_t count, const Weighing& weighing,
                           double* luminance, SpanLight& light) {
    if (weighing.to_rec709) return add_up<true>(pixels, count, weighing, luminance, light);
    add_up<false>(pixels, count, weighing, luminance, light);
}

void add_up_planes(const Planes& planes, std::size_t count, const Weighing& weighing,
                   double* luminance, SpanLight& light) noexcept {
    add_up_any(PlanePixels{planes}, count, weighing, luminance, light);
}

void add_up_packed(const float* pixels, int channels, std::size_t count, const Weighing& weighing,
                   double* luminance, SpanLight& light) noexcept {
    if (channels == 4)
        return add_up_any(PackedPixels<4>(pixels, count), count, weighing, luminance, light);
    add_up_any(PackedPixels<3>(pixels, count), count, weighing, luminance, light);
}

constexpr Kernels kKernels = {.split = split,
                              .kinds = kinds,
                              .are_plain = are_plain,
                              .divide_by_alpha = divide_by_alpha,
                              .add_up_planes = add_up_planes,
                              .add_up_packed = add_up_packed};

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace HWY_NAMESPACE

template <>
constexpr const Kernels* Compiled::kernels<HWY_TARGET> = &HWY_NAMESPACE::kKernels;

}  // namespace light
TONEWRIGHT_NAMESPACE_END
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
TONEWRIGHT_NAMESPACE_BEGIN
namespace light {
namespace {

void fill_up(std::array<double, kSpan>& plane, std::size_t count, double with) {
    std::fill(plane.begin() + static_cast<std::ptrdiff_t>(count),
              plane.begin() + static_cast<std::ptrdiff_t>(padded(count)), with);
}

/// Four very small luminances together could leave double's range: pictures of doubles have such.
SpanLight in_range(SpanLight light, const std::array<double, kSpan>& luminance,
                   std::size_t count) noexcept {
    if (light.minimum_lit >= 0x1p-250) return light;
    std::array<double, kSpan> lit{};
    const auto end =
        std::copy_if(luminance.begin(), luminance.begin() + static_cast<std::ptrdiff_t>(count),
                     lit.begin(), [](double y) { return y > 0; });
    light.lit = product_of(lit.data(), static_cast<std::size_t>(end - lit.begin()));
    return light;
}

}  // namespace

const std::vector<Kernels>& kernels() {
    static const std::vector<Kernels> all = kernels_of_this_machine<Compiled>();
    return all;
}
const Kernels& best_kernels() {
    static const Kernels& best = kernels().front();
    return best;
}

void split(const float* pixels, int channels, std::size_t count, Planes& to,
           const Kernels& with) noexcept {
    with.split(pixels, channels, count, to);
}

Kinds kinds(Planes& planes, std::size_t count, bool has_alpha, const Kernels& with) noexcept {
    for (std::size_t c = 0; c < 4; ++c)
        fill_up(planes[c], count, c < 3 ? 0 : 1);
    return with.kinds(planes, count, has_alpha);
}

bool are_plain(const float* pixels, int channels, std::size_t count, bool has_alpha,
               const Kernels& with) noexcept {
    return with.are_plain(pixels, channels, count, has_alpha);
}

void divide_by_alpha(Planes& planes, std::size_t count, double limit,
                     const Kernels& with) noexcept {
    with.divide_by_alpha(planes, count, limit);
}

SpanLight add_up(Planes& planes, std::size_t count, const Weighing& weighing,
                 std::array<double, kSpan>& luminance, const Kernels& with) noexcept {
    for (std::size_t c = 0; c < 3; ++c)
        fill_up(planes[c], count, 0);
    SpanLight light;
    with.add_up_planes(planes, count, weighing, luminance.data(), light);
    return in_range(light, luminance, count);
}

SpanLight add_up(const float* pixels, int channels, std::size_t count, const Weighing& weighing,
                 std::array<double, kSpan>& luminance, const Kernels& with) noexcept {
    SpanLight light;
    with.add_up_packed(pixels, channels, count, weighing, luminance.data(), light);
    return in_range(light, luminance, count);
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

}  // namespace light
TONEWRIGHT_NAMESPACE_END
#endif  // HWY_ONCE
