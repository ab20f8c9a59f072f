// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The functions of one instruction set.
struct HalfKernels {
    const char* name = nullptr;
    bool (*to_float)(const void* from, float* to, std::size_t count) noexcept = nullptr;
    bool (*to_half)(const float* from, void* to, std::size_t count) noexcept = nullptr;
};
/// For each instruction set of this machine, best first.
[[nodiscard]] const std::vector<HalfKernels>& half_kernels();

/// Conversion between floats and the 16 bits of half floats by instructions of the processor:
/// nearest, ties to even, beyond the range infinity. Numbers are contiguous in memory, with any
/// alignment.
/// @param with   the functions of one instruction set
/// @returns  false, with nothing done, if the processor lacks such instructions (before AVX2)
[[nodiscard]] bool half_to_float(const void* from, float* to, std::size_t count,
                                 const HalfKernels& with = half_kernels().front()) noexcept;
[[nodiscard]] bool float_to_half(const float* from, void* to, std::size_t count,
                                 const HalfKernels& with = half_kernels().front()) noexcept;

TONEWRIGHT_NAMESPACE_END
