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
#define TONEWRIGHT_BROKEN_TARGETS (HWY_AVX3 | (HWY_AVX3 - 1))
#else
#define TONEWRIGHT_BROKEN_TARGETS 0
#endif

// x86 processors without SSE4 (before 2008) run the scalar code. Vectors of SVE and RISC-V have no
// size at compile time, so the kernels cannot hold them in structs and arrays; Arm processors run
// NEON.
#define HWY_DISABLED_TARGETS                                                 \
    (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | \
     TONEWRIGHT_BROKEN_TARGETS)
#include "hwy/targets.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

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
    const std::int64_t supported = hwy::SupportedTargets();
    // Highway 1.0 leaves its own choice without the restrictions of the application: write it
    // again, with them.
    hwy::GetChosenTarget().Update(supported);
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
