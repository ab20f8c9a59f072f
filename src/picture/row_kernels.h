// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Steps between interleaved rows and what OpenEXR compresses, for one instruction set. Buffers do
/// not overlap, unless stated; any alignment.
struct RowKernels {
    const char* name = nullptr;
    /// OpenEXR's predictor, in place: every byte but the first becomes its difference from the one
    /// before it, plus 128.
    void (*differences)(std::uint8_t* bytes, std::size_t count) noexcept = nullptr;
    void (*undo_differences)(std::uint8_t* bytes, std::size_t count) noexcept = nullptr;
    /// Pairs of bytes, whose first bytes lie in one buffer and second bytes in another.
    void (*join_bytes)(const std::uint8_t* first, const std::uint8_t* second, std::size_t pairs,
                       std::uint8_t* to) noexcept = nullptr;
    void (*split_bytes)(const std::uint8_t* from, std::size_t pairs, std::uint8_t* first,
                        std::uint8_t* second) noexcept = nullptr;
    /// Rows of one channel each, of `width` numbers of 16 or 32 bits, to pixels; and back.
    void (*interleave_16)(const std::uint8_t* const* planes, std::size_t channels,
                          std::size_t width, std::uint8_t* pixels) noexcept = nullptr;
    void (*interleave_32)(const std::uint8_t* const* planes, std::size_t channels,
                          std::size_t width, std::uint8_t* pixels) noexcept = nullptr;
    void (*separate_16)(const std::uint8_t* pixels, std::size_t channels, std::size_t width,
                        std::uint8_t* const* planes) noexcept = nullptr;
    void (*separate_32)(const std::uint8_t* pixels, std::size_t channels, std::size_t width,
                        std::uint8_t* const* planes) noexcept = nullptr;
};
/// For each instruction set of this machine, best first.
[[nodiscard]] const std::vector<RowKernels>& row_kernels();

TONEWRIGHT_NAMESPACE_END
