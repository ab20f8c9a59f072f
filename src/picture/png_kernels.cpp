// SPDX-License-Identifier: Apache-2.0
//
// Compiled by Highway once for each instruction set.
#include "picture/png_kernels.h"

#include <array>
#include <bit>
#include <cstring>

#if defined(__GNUC__) && !defined(__clang__)
// GCC's AVX-512 header passes an undefined vector to instructions that do not read it.
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include "engine/kernel_targets.h"

#ifndef TONEWRIGHT_PNG_KERNELS_ONCE
#define TONEWRIGHT_PNG_KERNELS_ONCE
TONEWRIGHT_NAMESPACE_BEGIN
namespace {
/// See kernels_of_this_machine().
struct CompiledPngKernels {
    template <std::int64_t kTarget>
    static constexpr const PngKernels* kernels = nullptr;
};
}  // namespace
TONEWRIGHT_NAMESPACE_END
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "picture/png_kernels.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
TONEWRIGHT_NAMESPACE_BEGIN
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Bytes = hn::ScalableTag<std::uint8_t>;
using ByteVector = hn::Vec<Bytes>;
using Sums = hn::Repartition<std::uint64_t, Bytes>;
using Floats = hn::ScalableTag<float>;
using FloatVector = hn::Vec<Floats>;
using Ints = hn::RebindToSigned<Floats>;

/// Nearest whole numbers of [0, most], ties up.
HWY_INLINE hn::Vec<Ints> codes_of(FloatVector x, float most) {
    const Floats d;
    const auto zero = hn::Zero(d);
    x = hn::Mul(x, hn::Set(d, most));
    x = hn::Min(hn::IfThenElse(hn::Gt(x, zero), x, zero), hn::Set(d, most));  // NaN: 0
    const auto even = hn::Round(x);
    const auto is_tie_below = hn::Eq(hn::Sub(x, even), hn::Set(d, 0.5F));
    const auto up = hn::IfThenElse(is_tie_below, hn::Set(d, 1.0F), zero);
    return hn::ConvertTo(Ints(), hn::Add(even, up));
}

/// convert(from, to) for whole vectors of floats; the rest goes through buffers of one vector.
template <class To, class F>
HWY_INLINE void in_vectors(const float* from, To* to, std::size_t count, F convert) {
    const std::size_t lanes = hn::Lanes(Floats());
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes)
        convert(from + i, to + i);
    if (i == count) return;
    float last[hn::MaxLanes(Floats())] = {};
    To converted[hn::MaxLanes(Floats())];
    std::memcpy(last, from + i, (count - i) * sizeof(float));
    convert(last, converted);
    std::memcpy(to + i, converted, (count - i) * sizeof(To));
}

void to_codes_8(const float* from, std::uint8_t* to, std::size_t count) noexcept {
    in_vectors(from, to, count, [](const float* floats, std::uint8_t* codes) HWY_ATTR {
        const hn::Rebind<std::uint8_t, Floats> d;
        hn::StoreU(hn::DemoteTo(d, codes_of(hn::LoadU(Floats(), floats), 255)), d, codes);
    });
}

void to_codes_16(const float* from, std::uint8_t* to, std::size_t count) noexcept {
    using Code = std::array<std::uint8_t, 2>;
    in_vectors(from, reinterpret_cast<Code*>(to), count,
               [](const float* floats, Code* codes) HWY_ATTR {
                   const hn::Rebind<std::uint16_t, Floats> d;
                   auto code = hn::DemoteTo(d, codes_of(hn::LoadU(Floats(), floats), 65535));
                   if constexpr (std::endian::native == std::endian::little)
                       code = hn::Or(hn::ShiftLeft<8>(code), hn::ShiftRight<8>(code));
                   std::uint16_t stored[hn::MaxLanes(d)];
                   hn::StoreU(code, d, stored);
                   std::memcpy(codes, stored, hn::Lanes(d) * sizeof(Code));
               });
}

/// A vector of bytes and its neighbors.
struct Neighbors {
    ByteVector x, left, above, above_left;
};
HWY_INLINE Neighbors neighbors_at(const std::uint8_t* row, const std::uint8_t* above,
                                  std::size_t pixel_bytes) {
    const Bytes d;
    return {hn::LoadU(d, row), hn::LoadU(d, row - pixel_bytes), hn::LoadU(d, above),
            hn::LoadU(d, above - pixel_bytes)};
}

// The filters, by their numbers.
struct None {
    static HWY_INLINE ByteVector of(const Neighbors& n) { return n.x; }
};
struct Sub {
    static HWY_INLINE ByteVector of(const Neighbors& n) { return hn::Sub(n.x, n.left); }
};
struct Up {
    static HWY_INLINE ByteVector of(const Neighbors& n) { return hn::Sub(n.x, n.above); }
};
struct Average {
    static HWY_INLINE ByteVector of(const Neighbors& n) {
        // The instruction rounds up.
        const auto odd = hn::And(hn::Xor(n.left, n.above), hn::Set(Bytes(), 1));
        return hn::Sub(n.x, hn::Sub(hn::AverageRound(n.left, n.above), odd));
    }
};
struct Paeth {
    static HWY_INLINE ByteVector of(const Neighbors& n) {
        const Bytes d;
        const auto [x, a, b, c] = n;
        const auto b_over_c = hn::SaturatedSub(b, c);
        const auto c_over_b = hn::SaturatedSub(c, b);
        const auto a_over_c = hn::SaturatedSub(a, c);
        const auto c_over_a = hn::SaturatedSub(c, a);
        const auto to_a = hn::Or(b_over_c, c_over_b);  // |a + b - c - a|
        const auto to_b = hn::Or(a_over_c, c_over_a);
        // If a and b lie on different sides of c, their distances to it are subtracted. On one
        // side they are added, and c is never the nearest.
        const auto zero = hn::Zero(d);
        const auto differs = hn::And(hn::Eq(hn::Min(b_over_c, a_over_c), zero),
                                     hn::Eq(hn::Min(c_over_b, c_over_a), zero));
        const auto distance = hn::Or(hn::SaturatedSub(to_a, to_b), hn::SaturatedSub(to_b, to_a));
        const auto to_c = hn::IfThenElse(differs, distance, hn::Set(d, 255));
        const auto b_or_c = hn::IfThenElse(hn::Eq(hn::Min(to_b, to_c), to_b), b, c);
        const auto is_a = hn::Eq(hn::Min(to_a, hn::Min(to_b, to_c)), to_a);
        return hn::Sub(x, hn::IfThenElse(is_a, a, b_or_c));
    }
};

template <class Filter>
HWY_INLINE void add(const Neighbors& n, hn::Mask<Bytes> is_inside, hn::Vec<Sums>& sum) {
    const Bytes d;
    const auto difference = hn::IfThenElseZero(is_inside, Filter::of(n));
    const auto size = hn::Min(difference, hn::Sub(hn::Zero(d), difference));
    sum = hn::Add(sum, hn::SumsOf8(size));
}

template <class Filter>
HWY_INLINE void write(const std::uint8_t* row, const std::uint8_t* above, std::size_t bytes,
                      std::size_t pixel_bytes, std::uint8_t* to) {
    const Bytes d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    for (; i + lanes <= bytes; i += lanes)
        hn::StoreU(Filter::of(neighbors_at(row + i, above + i, pixel_bytes)), d, to + i);
    std::uint8_t last[hn::MaxLanes(Bytes())];
    hn::StoreU(Filter::of(neighbors_at(row + i, above + i, pixel_bytes)), d, last);
    std::memcpy(to + i, last, bytes - i);
}

void filter(const std::uint8_t* row, const std::uint8_t* above, std::size_t bytes,
            std::size_t pixel_bytes, std::uint8_t* to) noexcept {
    const Bytes d;
    const Sums ds;
    auto none = hn::Zero(ds), sub = none, up = none, average = none, paeth = none;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t i = 0; i < bytes; i += lanes) {
        const Neighbors n = neighbors_at(row + i, above + i, pixel_bytes);
        // Highway 1.0 converts the number to the type of the lanes.
        const auto is_inside = hn::FirstN(d, bytes - i < lanes ? bytes - i : lanes);
        add<None>(n, is_inside, none);
        add<Sub>(n, is_inside, sub);
        add<Up>(n, is_inside, up);
        add<Average>(n, is_inside, average);
        add<Paeth>(n, is_inside, paeth);
    }
    std::uint8_t best = 0;
    std::uint64_t least = hn::GetLane(hn::SumOfLanes(ds, none));
    const auto compare = [&](std::uint8_t number, hn::Vec<Sums> sums) HWY_ATTR {
        const std::uint64_t sum = hn::GetLane(hn::SumOfLanes(ds, sums));
        if (sum >= least) return;
        least = sum;
        best = number;
    };
    compare(1, sub);
    compare(2, up);
    compare(3, average);
    compare(4, paeth);
    *to++ = best;
    switch (best) {
        case 0:
            return write<None>(row, above, bytes, pixel_bytes, to);
        case 1:
            return write<Sub>(row, above, bytes, pixel_bytes, to);
        case 2:
            return write<Up>(row, above, bytes, pixel_bytes, to);
        case 3:
            return write<Average>(row, above, bytes, pixel_bytes, to);
        default:
            return write<Paeth>(row, above, bytes, pixel_bytes, to);
    }
}

constexpr PngKernels kPngKernels = {
    .to_codes_8 = to_codes_8, .to_codes_16 = to_codes_16, .filter = filter};

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace HWY_NAMESPACE

template <>
constexpr const PngKernels* CompiledPngKernels::kernels<HWY_TARGET> = &HWY_NAMESPACE::kPngKernels;

TONEWRIGHT_NAMESPACE_END
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
TONEWRIGHT_NAMESPACE_BEGIN

const std::vector<PngKernels>& png_kernels() {
    static const std::vector<PngKernels> all = kernels_of_this_machine<CompiledPngKernels>();
    return all;
}

TONEWRIGHT_NAMESPACE_END
#endif  // HWY_ONCE
