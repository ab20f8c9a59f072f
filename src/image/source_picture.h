// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "image/pixel_access.h"
#include "tonewright/tonemap.h"

/// Pictures of any pixel type that are read span by span, in memory or in OIIO's cache.
TONEWRIGHT_NAMESPACE_BEGIN

/// Pixels that are processed at a time: four float planes of them are 16 KiB and stay in the L1
/// cache.
inline constexpr std::size_t kSpan = 1024;

/// An error of the picture itself. The code that knows its file adds the name.
class TONEWRIGHT_API PictureError : public FileError {
  public:
    using FileError::FileError;
};

/// Some of OIIO's readers (FITS) leave out channel names, and OIIO's own functions then fail: this
/// gives them OIIO's default names. An alpha or depth channel without a channel is removed.
TONEWRIGHT_API void complete_channel_names(OIIO::ImageSpec& spec);

/// Channels of color and alpha, by position, not by name.
struct ChannelLayout {
    bool is_gray = false;  // channel 0 alone is color, else 0, 1, 2
    int alpha = -1;        // -1: none
};

/// @throws PictureError  two channels of which the second is no alpha; alpha before color;
///                       luminance and chroma (Y, RY, BY) instead of color.
[[nodiscard]] TONEWRIGHT_API ChannelLayout channel_layout(const OIIO::ImageSpec& spec);

/// True if color must be un-premultiplied.
[[nodiscard]] TONEWRIGHT_API bool divides_by_alpha(const OIIO::ImageSpec& spec,
                                                   TonemapOptions::Unpremult unpremult);

/// @param what    "source" or "destination"
/// @throws PictureError  for a type that OIIO has no pixels of.
TONEWRIGHT_API void check_pixel_type(const char* what, const OIIO::TypeDesc& type);

/// Reads the header of a picture that is not open yet. OpenImageIO 3 reads its pixels, too, unless
/// the picture is cached.
/// @throws Error  no picture, or one that cannot be read, or deep, or of a type without pixels.
TONEWRIGHT_API void check_source(const OIIO::ImageBuf& source);

/// Call it after a pass: a cached picture is read during the pass, and its cache reports errors
/// through the picture.
/// @throws Error  with the reader's message
TONEWRIGHT_API void check_was_read(const OIIO::ImageBuf& source, bool is_complete);

/// In memory. OpenImageIO 3.1 ends the process where it clears what it could not allocate.
/// @throws std::bad_alloc
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf black_picture(const OIIO::ImageSpec& spec);

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

/// Multiplies color by alpha, in a float picture in memory.
TONEWRIGHT_API void multiply_by_alpha(OIIO::ImageBuf& picture);

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

/// Finds the spans of a picture. One for each thread.
class TONEWRIGHT_API SpanReader {
  public:
    /// @throws std::bad_alloc
    explicit SpanReader(const OIIO::ImageBuf& picture)
        : picture_(picture), type_(picture.spec().format) {
        if (!picture.localpixels()) {
            fetched_.resize(kSpan * static_cast<std::size_t>(picture.nchannels()) * type_.size());
        }
    }

    /// Uses pixels in memory directly; fetches those of a cached picture.
    /// @param n  at most kSpan pixels, all inside the data window
    /// @returns  false if the picture could not be read
    bool locate(int x, int y, int z, std::size_t n, SpanSource& source) {
        if (picture_.localpixels()) {
            source = {static_cast<const std::byte*>(picture_.pixeladdr(x, y, z)),
                      picture_.pixel_stride()};
            return true;
        }
        const int channels = picture_.nchannels();
        const OIIO::ROI roi(x, x + static_cast<int>(n), y, y + 1, z, z + 1, 0, channels);
        source = {fetched_.data(), channels * static_cast<std::ptrdiff_t>(type_.size())};
        return picture_.get_pixels(roi, type_, fetched_.data());
    }

  private:
    const OIIO::ImageBuf& picture_;
    OIIO::TypeDesc type_;
    std::vector<std::byte> fetched_;
};

TONEWRIGHT_NAMESPACE_END
