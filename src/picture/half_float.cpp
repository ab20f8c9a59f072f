// SPDX-License-Identifier: Apache-2.0
//
// Compiled by Highway once for each instruction set.
#include "picture/half_float.h"

#include <cstring>

#if defined(__GNUC__) && !defined(__clang__)
// GCC's AVX-512 header passes an undefined vector to instructions that do not read it.
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include "engine/kernel_targets.h"

#ifndef TONEWRIGHT_HALF_FLOAT_ONCE
#define TONEWRIGHT_HALF_FLOAT_ONCE
TONEWRIGHT_NAMESPACE_BEGIN
namespace {
/// See kernels_of_this_machine().
struct CompiledHalfKernels {
    template <std::int64_t kTarget>
    static constexpr const HalfKernels* kernels = nullptr;
};
}  // namespace
TONEWRIGHT_NAMESPACE_END
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "picture/half_float.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
TONEWRIGHT_NAMESPACE_BEGIN
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Below AVX2, Highway emulates the instructions, which is no faster than a table.
#if HWY_TARGET <= HWY_AVX2

using Floats = hn::ScalableTag<float>;
using Halves = hn::Rebind<hwy::float16_t, Floats>;

/// convert(from, to) for whole vectors; the rest goes through buffers of one vector.
template <class From, class To, class F>
HWY_INLINE void in_vectors(const From* from, To* to, std::size_t count, F convert) {
    const std::size_t lanes = hn::Lanes(Floats());
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes)
        convert(from + i, to + i);
    if (i == count) return;
    From last[hn::MaxLanes(Floats())] = {};
    To converted[hn::MaxLanes(Floats())];
    std::memcpy(last, from + i, (count - i) * sizeof(From));
    convert(last, converted);
    std::memcpy(to + i, converted, (count - i) * sizeof(To));
}

bool to_float(const void* from, float* to, std::size_t count) noexcept {
    in_vectors(static_cast<const hwy::float16_t*>(from), to, count,
               [](const hwy::float16_t* halves, float* floats) HWY_ATTR {
                   const Floats d;
                   hn::StoreU(hn::PromoteTo(d, hn::LoadU(Halves(), halves)), d, floats);
               });
    return true;
}
bool to_half(const float* from, void* to, std::size_t count) noexcept {
    in_vectors(from, static_cast<hwy::float16_t*>(to), count,
               [](const float* floats, hwy::float16_t* halves) HWY_ATTR {
                   const Halves d;
                   hn::StoreU(hn::DemoteTo(d, hn::LoadU(Floats(), floats)), d, halves);
               });
    return true;
}

#else

bool to_float(const void*, float*, std::size_t) noexcept { return false; }
bool to_half(const float*, void*, std::size_t) noexcept { return false; }

#endif

constexpr HalfKernels kHalfKernels = {.to_float = to_float, .to_half = to_half};

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace HWY_NAMESPACE

template <>
constexpr const HalfKernels* CompiledHalfKernels::kernels<HWY_TARGET> =
    &HWY_NAMESPACE::kHalfKernels;

TONEWRIGHT_NAMESPACE_END
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
TONEWRIGHT_NAMESPACE_BEGIN

const std::vector<HalfKernels>& half_kernels() {
    static const std::vector<HalfKernels> all = kernels_of_this_machine<CompiledHalfKernels>();
    return all;
}

bool half_to_float(const void* from, float* to, std::size_t count,
                   const HalfKernels& with) noexcept {
    return with.to_float(from, to, count);
}
bool float_to_half(const float* from, void* to, std::size_t count,
                   const HalfKernels& with) noexcept {
    return with.to_half(from, to, count);
}

TONEWRIGHT_NAMESPACE_END
#endif  // HWY_ONCE
