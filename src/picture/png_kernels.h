// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Bytes before each row that filter() gets. They are zero: W3C PNG (third edition), 9.2, has no
/// pixel left of the first one.
inline constexpr std::size_t kPngLead = 8;
/// Bytes behind each row that filter() may read.
inline constexpr std::size_t kPngSlack = 64;

/// Functions over rows of a PNG file.
struct PngKernels {
    const char* name = nullptr;
    /// Code values of 8 bits, from 0 to 1 as OpenImageIO rounds them: the nearest, ties up. NaN
    /// gives 0.
    void (*to_codes_8)(const float* from, std::uint8_t* to, std::size_t count) noexcept;
    /// Code values of 16 bits, the high byte first.
    void (*to_codes_16)(const float* from, std::uint8_t* to, std::size_t count) noexcept;
    /// Writes the number of a filter and the filtered row: the filter with the least sum of
    /// absolute differences. W3C PNG (third edition), 9.2 and 12.7.
    /// @param row    bytes, with kPngLead zeros before them and kPngSlack behind them
    /// @param above  the row above, alike; zeros above the first
    /// @param to     bytes + 1
    void (*filter)(const std::uint8_t* row, const std::uint8_t* above, std::size_t bytes,
                   std::size_t pixel_bytes, std::uint8_t* to) noexcept;
};

/// Those for the instruction sets of this machine, best first.
[[nodiscard]] const std::vector<PngKernels>& png_kernels();

TONEWRIGHT_NAMESPACE_END
