// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "hwy/base.h"

// Highway 1.3 names "evex512" among Clang's target features. Clang 22 has no such feature and
// ignores them all, so that AVX-512 does not compile: there AVX2 is the best instruction set.
#if defined(__clang__) && __clang_major__ >= 22 && defined(HWY_MAJOR) && HWY_MAJOR == 1 && \
    HWY_MINOR <= 3
#define TONEWRIGHT_BROKEN_TARGETS HWY_AVX3
#else
#define TONEWRIGHT_BROKEN_TARGETS 0
#endif

// x86 processors without SSE4 (before 2008) run the scalar code, and AVX-512 of all processors is
// the same: no kernel has an instruction of a later one. Vectors of SVE and RISC-V have no size at
// compile time, so the kernels cannot hold them in structs and arrays; Arm processors run NEON.
#define HWY_DISABLED_TARGETS                                                                  \
    (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | (HWY_AVX3 - 1) | \
     TONEWRIGHT_BROKEN_TARGETS)
#include "hwy/targets.h"
#include "tonewright/version.h"

#if HWY_ARCH_X86
#include <cpuid.h>
#endif

TONEWRIGHT_NAMESPACE_BEGIN

/// The instruction sets that this processor and its system have: bits of Highway.
///
/// Highway's own function is in a library that measures the processor's clock when it is loaded,
/// which takes longer than the engine of a plain curve. So x86 does without that library.
inline std::int64_t targets_of_this_machine() {
#if HWY_ARCH_X86
    unsigned a = 0, b = 0, c1 = 0, c_extended = 0, d = 0;
    __get_cpuid(1, &a, &b, &c1, &d);
    __get_cpuid(0x80000001U, &a, &b, &c_extended, &d);
    const auto all = [](auto... features) { return (... && (features != 0)); };
    // These look at the system's part, too: it saves the registers.
    const bool has_sse4 = all(__builtin_cpu_supports("sse4.1"), __builtin_cpu_supports("sse4.2"),
                              __builtin_cpu_supports("popcnt"), __builtin_cpu_supports("aes"),
                              __builtin_cpu_supports("pclmul"));
    const bool has_avx2 =
        has_sse4 && all(__builtin_cpu_supports("avx2"), __builtin_cpu_supports("fma"),
                        __builtin_cpu_supports("bmi"), __builtin_cpu_supports("bmi2"),
                        c1 & bit_F16C, c_extended & bit_LZCNT);
    const bool has_avx3 =
        has_avx2 && all(__builtin_cpu_supports("avx512f"), __builtin_cpu_supports("avx512vl"),
                        __builtin_cpu_supports("avx512dq"), __builtin_cpu_supports("avx512bw"),
                        __builtin_cpu_supports("avx512cd"));
    return HWY_STATIC_TARGET | (has_sse4 ? HWY_SSE4 : 0) | (has_avx2 ? HWY_AVX2 : 0) |
           (has_avx3 ? HWY_AVX3 : 0);
#else
    const std::int64_t targets = hwy::SupportedTargets();
    // Highway 1.0 leaves its own choice without the restrictions of the application: write it
    // again, with them.
    hwy::GetChosenTarget().Update(targets);
    return targets;
#endif
}

/// Returns the kernels of a file that Highway compiles once for each instruction set: those for the
/// instruction sets of this machine, best first.
///
/// Highway's own dispatch keeps one choice for the whole process. With this list each engine makes
/// its own choice.
/// @tparam Compiled  its variable template `kernels<HWY_TARGET>` points to the kernels for one
///                   instruction set, a struct with a member `name`, which is set here; null if the
///                   file is not compiled for it
template <class Compiled>
[[nodiscard]] auto kernels_of_this_machine() {
    using Kernels = std::remove_cvref_t<decltype(*Compiled::template kernels<0>)>;
    std::vector<Kernels> result;
    const std::int64_t supported = targets_of_this_machine();
    const auto add = [&](std::int64_t target, const Kernels* kernels) {
        if (!kernels || (supported & target) == 0) return;
        result.push_back(*kernels);
        result.back().name = hwy::TargetName(target);
    };
    // The lower bit is the better instruction set.
    [&]<std::size_t... kBit>(std::index_sequence<kBit...>) {
        (add(std::int64_t{1} << kBit, Compiled::template kernels<(std::int64_t{1} << kBit)>), ...);
    }
    (std::make_index_sequence<63>());
    return result;
}

TONEWRIGHT_NAMESPACE_END
