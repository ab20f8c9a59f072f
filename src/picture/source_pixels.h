// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/typedesc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "picture/picture_error.h"
#include "picture/picture_spec.h"
#include "tonewright/tonemap_options.h"

/// Pictures of any pixel type that are read span by span: channels of color, and alpha.
TONEWRIGHT_NAMESPACE_BEGIN

/// Pixels that are processed at a time: four float planes of them are 16 KiB and stay in the L1
/// cache.
inline constexpr std::size_t kSpan = 1024;

/// Some of OpenImageIO's readers (FITS) leave out channel names, and its own functions then fail:
/// this gives them its default names. An alpha or depth channel without a channel is removed.
TONEWRIGHT_API void complete_channel_names(PictureSpec& spec);

/// Channels of color and alpha, by position, not by name.
struct ChannelLayout {
    bool is_gray = false;  // channel 0 alone is color, else 0, 1, 2
    int alpha = -1;        // -1: none
};

/// @throws PictureError  two channels of which the second is no alpha; alpha before color;
///                       luminance and chroma (Y, RY, BY) instead of color.
[[nodiscard]] TONEWRIGHT_API ChannelLayout channel_layout(const PictureSpec& spec);

/// True if color must be un-premultiplied.
[[nodiscard]] TONEWRIGHT_API bool divides_by_alpha(const PictureSpec& spec,
                                                   TonemapOptions::Unpremult unpremult);

/// @param what    "source" or "destination"
/// @throws PictureError  for a type that OpenImageIO has no pixels of.
TONEWRIGHT_API void check_pixel_type(const char* what, const OIIO::TypeDesc& type);

/// Position of a span's pixels in memory.
struct SpanSource {
    const std::byte* pixels;  // null: outside the data window, black
    std::ptrdiff_t stride;    // bytes from pixel to pixel
};

/// Red, green and blue of a span as planes; of a gray picture three times the same.
TONEWRIGHT_API void load_color(const OIIO::TypeDesc& type, bool is_gray, const SpanSource& source,
                               const std::array<float*, 3>& rgb, std::size_t n) noexcept;

/// The most light of a surface, after exposure: AgX and the ACES curves reach white at 16.3. What
/// exceeds it by its alpha is emission.
inline constexpr double kMostSurfaceLight = 16;

/// The limit for divisor_of(): kMostSurfaceLight before exposure, or infinity where the caller asks
/// for plain division.
[[nodiscard]] inline double surface_limit(TonemapOptions::Unpremult unpremult,
                                          double exposure_stops) {
    if (unpremult == TonemapOptions::Unpremult::yes) return HUGE_VAL;
    return kMostSurfaceLight * std::exp2(-exposure_stops);
}

/// The largest of three numbers that is not NaN.
template <class Float>
[[nodiscard]] Float largest_of(Float r, Float g, Float b) noexcept {
    // std::max() takes the first where the second is NaN.
    return std::max(std::max(std::max(-std::numeric_limits<Float>::infinity(), r), g), b);
}

/// The divisor that un-premultiplies a color: alpha, or 1 if alpha is 0 or not finite. Flames and
/// glass have light above what a surface with their alpha carries. Divided by alpha, it would
/// become white, and black where white is multiplied by alpha again. The divisor of such colors
/// goes from alpha to 1 as the share of emission in the color grows, so it is continuous in color
/// and alpha.
/// @param most   largest channel of the color
/// @param limit  of surface_limit()
template <class Float>
[[nodiscard]] Float divisor_of(Float alpha, Float most, Float limit) noexcept {
    if (alpha == 0 || !std::isfinite(alpha)) return 1;
    if (alpha >= 1) return alpha;
    const Float surface = limit * std::fabs(alpha);
    if (!(most > surface)) return alpha;
    if (alpha < 0 || std::isinf(most)) return 1;
    return alpha + (1 - alpha) * ((most - surface) / most);
}

/// divisor_of() for a span.
/// @param rgb     of load_color()
/// @param covers  null, or gets 1 where alpha is finite and not 0, else 0
TONEWRIGHT_API void load_divisor(const OIIO::TypeDesc& type, int alpha, const SpanSource& source,
                                 const std::array<float*, 3>& rgb, double limit, float* to,
                                 std::uint8_t* covers, std::size_t n) noexcept;

TONEWRIGHT_NAMESPACE_END
