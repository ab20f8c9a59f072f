// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "tonewright/pipeline.h"

/// Metering of every pixel, as vector code. Sums go into eight lanes on every instruction set,
/// without fused operations, so the results are the same bits on all of them.
TONEWRIGHT_NAMESPACE_BEGIN
namespace light {

/// Pixels that are processed at a time: four double planes of them stay in the first-level cache.
inline constexpr std::size_t kSpan = 512;
/// Planes have whole blocks of this many pixels.
inline constexpr std::size_t kBlock = 64;

[[nodiscard]] constexpr std::size_t padded(std::size_t count) {
    return (count + kBlock - 1) / kBlock * kBlock;
}

/// Largest channel: the largest float. Products of four luminances have their place in a double.
inline constexpr auto kLargestLight = static_cast<double>(std::numeric_limits<float>::max());

/// r, g, b, alpha.
using Planes = std::array<std::array<double, kSpan>, 4>;

struct Kernels;
/// For each instruction set of this machine, best first. All give the same bits. The functions
/// below take the best by default, and tests compare the others with it.
[[nodiscard]] const std::vector<Kernels>& kernels();
[[nodiscard]] const Kernels& best_kernels();

/// Interleaved floats into planes.
/// @param channels  3 or 4, of each pixel in memory and of `to`
void split(const float* pixels, int channels, std::size_t count, Planes& to,
           const Kernels& with = best_kernels()) noexcept;

/// Special values among the pixels.
struct Kinds {
    bool all_finite;  // r, g, b
    bool all_cover;   // alpha is finite and not 0
    bool all_opaque;  // alpha is 1
};
/// Fills the last block. Without `has_alpha`, all pixels are opaque.
[[nodiscard]] Kinds kinds(Planes& planes, std::size_t count, bool has_alpha,
                          const Kernels& with = best_kernels()) noexcept;

/// True if all interleaved floats are finite, and opaque.
/// @param channels  3 or 4; without `has_alpha`, the fourth is ignored.
[[nodiscard]] bool are_plain(const float* pixels, int channels, std::size_t count, bool has_alpha,
                             const Kernels& with = best_kernels()) noexcept;

/// Color divided by divisor_of() its alpha, of whole blocks of finite numbers.
/// @param limit  of surface_limit()
void divide_by_alpha(Planes& planes, std::size_t count, double limit,
                     const Kernels& with = best_kernels()) noexcept;

/// The sum of logarithms of a span as the logarithm of a product: mantissa 2^exponent.
struct Product {
    double mantissa = 1;
    std::int64_t exponent = 0;
};

/// A sum and its rounding error.
struct CompensatedSum {
    double sum = 0;
    double lost = 0;
};

/// Sums of a span.
struct SpanLight {
    std::array<CompensatedSum, 3> rgb;
    Vector3 maximum_rgb{};
    double maximum = 0;
    double minimum_lit = 0;  // infinity: all is black
    std::size_t lit_count = 0;
    Product lit;         // of luminances above 0
    Product with_delta;  // of luminances and delta
};
/// Conversion of colors to metered luminances.
struct Weighing {
    const Matrix3* to_rec709;  // null: colors are in Rec.709
    double delta;              // added to luminances inside the logarithm, [1e-12, 1]
};
/// For colors without NaN, which become colors of Rec.709, [0, kLargestLight].
/// @param luminance  of each pixel
[[nodiscard]] SpanLight add_up(Planes& planes, std::size_t count, const Weighing& weighing,
                               std::array<double, kSpan>& luminance,
                               const Kernels& with = best_kernels()) noexcept;
/// The same for interleaved floats, with the same bits.
[[nodiscard]] SpanLight add_up(const float* pixels, int channels, std::size_t count,
                               const Weighing& weighing, std::array<double, kSpan>& luminance,
                               const Kernels& with = best_kernels()) noexcept;

/// Product of any positive numbers.
[[nodiscard]] Product product_of(const double* values, std::size_t count) noexcept;

/// The functions of one instruction set.
struct Kernels {
    const char* name = nullptr;
    void (*split)(const float*, int, std::size_t, Planes&) noexcept = nullptr;
    Kinds (*kinds)(Planes&, std::size_t, bool) noexcept = nullptr;
    bool (*are_plain)(const float*, int, std::size_t, bool) noexcept = nullptr;
    void (*divide_by_alpha)(Planes&, std::size_t, double) noexcept = nullptr;
    void (*add_up_planes)(const Planes&, std::size_t, const Weighing&, double*,
                          SpanLight&) noexcept = nullptr;
    void (*add_up_packed)(const float*, int, std::size_t, const Weighing&, double*,
                          SpanLight&) noexcept = nullptr;
};

}  // namespace light
TONEWRIGHT_NAMESPACE_END
