// SPDX-License-Identifier: Apache-2.0
//
// Compiled by Highway once for each instruction set.
#include "picture/row_kernels.h"

#include <cstring>

#if defined(__GNUC__) && !defined(__clang__)
// GCC's AVX-512 header passes an undefined vector to instructions that do not read it.
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include "engine/kernel_targets.h"

#ifndef TONEWRIGHT_ROW_KERNELS_ONCE
#define TONEWRIGHT_ROW_KERNELS_ONCE
TONEWRIGHT_NAMESPACE_BEGIN
namespace {
/// See kernels_of_this_machine().
struct CompiledRowKernels {
    template <std::int64_t kTarget>
    static constexpr const RowKernels* kernels = nullptr;
};
}  // namespace
TONEWRIGHT_NAMESPACE_END
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "picture/row_kernels.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
TONEWRIGHT_NAMESPACE_BEGIN
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Bytes = hn::ScalableTag<std::uint8_t>;
constexpr std::uint8_t kBias = 128;

void differences(std::uint8_t* bytes, std::size_t count) noexcept {
    // From the end, because each difference needs the byte before it unchanged.
    const Bytes d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t end = count;
    for (; end > lanes; end -= lanes) {
        std::uint8_t* const at = bytes + end - lanes;
        const auto difference = hn::Sub(hn::LoadU(d, at), hn::LoadU(d, at - 1));
        hn::StoreU(hn::Xor(difference, hn::Set(d, kBias)), d, at);
    }
    for (std::size_t i = end; i-- > 1;)
        bytes[i] = static_cast<std::uint8_t>(bytes[i] - bytes[i - 1] + kBias);
}

void undo_differences(std::uint8_t* bytes, std::size_t count) noexcept {
    if (count > 0) bytes[0] ^= kBias;  // the loops undo it
    std::uint8_t before = 0;
    std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
    // The sums of a block need no result of the block before it, so that blocks overlap in time.
    constexpr std::size_t kBlock = 16;  // within which bytes are shifted
    const hn::FixedTag<std::uint8_t, kBlock> d;
    for (; i + kBlock <= count; i += kBlock) {
        auto sums = hn::Xor(hn::LoadU(d, bytes + i), hn::Set(d, kBias));
        sums = hn::Add(sums, hn::ShiftLeftBytes<1>(d, sums));
        sums = hn::Add(sums, hn::ShiftLeftBytes<2>(d, sums));
        sums = hn::Add(sums, hn::ShiftLeftBytes<4>(d, sums));
        sums = hn::Add(sums, hn::ShiftLeftBytes<8>(d, sums));
        hn::StoreU(hn::Add(sums, hn::Set(d, before)), d, bytes + i);
        before = static_cast<std::uint8_t>(before + hn::ExtractLane(sums, kBlock - 1));
    }
#endif
    for (; i < count; ++i)
        before = bytes[i] = static_cast<std::uint8_t>(before + (bytes[i] ^ kBias));
}

void join_bytes(const std::uint8_t* first, const std::uint8_t* second, std::size_t pairs,
                std::uint8_t* to) noexcept {
    const Bytes d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    for (; i + lanes <= pairs; i += lanes)
        hn::StoreInterleaved2(hn::LoadU(d, first + i), hn::LoadU(d, second + i), d, to + 2 * i);
    for (; i < pairs; ++i) {
        to[2 * i] = first[i];
        to[2 * i + 1] = second[i];
    }
}

void split_bytes(const std::uint8_t* from, std::size_t pairs, std::uint8_t* first,
                 std::uint8_t* second) noexcept {
    const Bytes d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    for (; i + lanes <= pairs; i += lanes) {
        hn::Vec<Bytes> low;
        hn::Vec<Bytes> high;
        hn::LoadInterleaved2(d, from + 2 * i, low, high);
        hn::StoreU(low, d, first + i);
        hn::StoreU(high, d, second + i);
    }
    for (; i < pairs; ++i) {
        first[i] = from[2 * i];
        second[i] = from[2 * i + 1];
    }
}

template <class T>
void interleave(const std::uint8_t* const* planes, std::size_t channels, std::size_t width,
                std::uint8_t* pixels) noexcept {
    const hn::ScalableTag<T> d;
    const std::size_t lanes = hn::Lanes(d);
    const auto plane = [&](std::size_t c, std::size_t x) HWY_ATTR {
        return hn::LoadU(d, reinterpret_cast<const T*>(planes[c]) + x);
    };
    T* const to = reinterpret_cast<T*>(pixels);
    std::size_t x = 0;
    if (channels == 3) {
        for (; x + lanes <= width; x += lanes)
            hn::StoreInterleaved3(plane(0, x), plane(1, x), plane(2, x), d, to + 3 * x);
    } else if (channels == 4) {
        for (; x + lanes <= width; x += lanes)
            hn::StoreInterleaved4(plane(0, x), plane(1, x), plane(2, x), plane(3, x), d,
                                  to + 4 * x);
    }
    for (std::size_t c = 0; c < channels; ++c) {
        for (std::size_t i = x; i < width; ++i)
            std::memcpy(to + i * channels + c, planes[c] + i * sizeof(T), sizeof(T));
    }
}

template <class T>
void separate(const std::uint8_t* pixels, std::size_t channels, std::size_t width,
              std::uint8_t* const* planes) noexcept {
    using Tag = hn::ScalableTag<T>;
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    const auto store = [&](hn::Vec<Tag> values, std::size_t c, std::size_t x)
                           HWY_ATTR { hn::StoreU(values, d, reinterpret_cast<T*>(planes[c]) + x); };
    const T* const from = reinterpret_cast<const T*>(pixels);
    hn::Vec<Tag> v0, v1, v2, v3;
    std::size_t x = 0;
    if (channels == 3) {
        for (; x + lanes <= width; x += lanes) {
            hn::LoadInterleaved3(d, from + 3 * x, v0, v1, v2);
            store(v0, 0, x);
            store(v1, 1, x);
            store(v2, 2, x);
        }
    } else if (channels == 4) {
        for (; x + lanes <= width; x += lanes) {
            hn::LoadInterleaved4(d, from + 4 * x, v0, v1, v2, v3);
            store(v0, 0, x);
            store(v1, 1, x);
            store(v2, 2, x);
            store(v3, 3, x);
        }
    }
    for (std::size_t c = 0; c < channels; ++c) {
        for (std::size_t i = x; i < width; ++i)
            std::memcpy(planes[c] + i * sizeof(T), from + i * channels + c, sizeof(T));
    }
}

constexpr RowKernels kRowKernels = {.differences = differences,
                                    .undo_differences = undo_differences,
                                    .join_bytes = join_bytes,
                                    .split_bytes = split_bytes,
                                    .interleave_16 = interleave<std::uint16_t>,
                                    .interleave_32 = interleave<std::uint32_t>,
                                    .separate_16 = separate<std::uint16_t>,
                                    .separate_32 = separate<std::uint32_t>};

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace HWY_NAMESPACE

template <>
constexpr const RowKernels* CompiledRowKernels::kernels<HWY_TARGET> = &HWY_NAMESPACE::kRowKernels;

TONEWRIGHT_NAMESPACE_END
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
TONEWRIGHT_NAMESPACE_BEGIN

const std::vector<RowKernels>& row_kernels() {
    static const std::vector<RowKernels> all = kernels_of_this_machine<CompiledRowKernels>();
    return all;
}

TONEWRIGHT_NAMESPACE_END
#endif  // HWY_ONCE
