// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/typedesc.h>

#include <cstddef>

#include "tonewright/version.h"

/// Access to one channel of interleaved pixels of any type. Types are converted here only, so that
/// one kernel serves all pairs of pixel types.
TONEWRIGHT_NAMESPACE_BEGIN

/// Reading and writing of one pixel type. Conversions are OIIO's: integers represent [0, 1] (or
/// [-1, 1]), rounded and clamped when written.
struct PixelAccess {
    /// `stride` is the distance between pixels in bytes; `count` values are read or written.
    void (*load_float)(const std::byte* from, std::ptrdiff_t stride, float* to,
                       std::size_t count) noexcept;
    void (*store_float)(const float* from, std::byte* to, std::ptrdiff_t stride,
                        std::size_t count) noexcept;
    void (*load_double)(const std::byte* from, std::ptrdiff_t stride, double* to,
                        std::size_t count) noexcept;
    void (*store_double)(const double* from, std::byte* to, std::ptrdiff_t stride,
                         std::size_t count) noexcept;
    /// A fast path for values that are contiguous in memory.
    void (*run_to_float)(const std::byte* from, float* to, std::size_t count) noexcept;
    void (*run_from_float)(const float* from, std::byte* to, std::size_t count) noexcept;
    /// Copies the bits of one value.
    void (*copy)(const std::byte* from, std::ptrdiff_t from_stride, std::byte* to,
                 std::ptrdiff_t to_stride, std::size_t count) noexcept;
};

/// Null for types that cannot be pixels (64-bit integers, strings, pointers).
[[nodiscard]] const PixelAccess* pixel_access(const OIIO::TypeDesc& type) noexcept;

TONEWRIGHT_NAMESPACE_END
