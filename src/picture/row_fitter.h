// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/typedesc.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "picture/format_limits.h"
#include "picture/picture_spec.h"
#include "tonewright/picture_options.h"
#include "tonewright/tonemap_options.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Pixels [xbegin, xend) x [ybegin, yend).
struct PixelWindow {
    int xbegin = 0, xend = 0, ybegin = 0, yend = 0;
    [[nodiscard]] int width() const { return xend - xbegin; }
    [[nodiscard]] int height() const { return yend - ybegin; }
    [[nodiscard]] bool operator==(const PixelWindow&) const = default;
};
[[nodiscard]] PixelWindow data_window(const PictureSpec& spec);
[[nodiscard]] PixelWindow display_window(const PictureSpec& spec);

/// Rows of a picture as those of a file, which may lack alpha, gray, data windows and pixel types.
class TONEWRIGHT_API RowFitter {
  public:
    /// Interleaved and packed. A volume is passed as a whole, one plane after the other.
    struct Rows {
        int ybegin = 0;
        int yend = 0;
        OIIO::TypeDesc type;
        const std::byte* pixels = nullptr;
    };

    /// Changes nothing, until open().
    /// @param format   OpenImageIO's name
    /// @param codec    the format, or `avif`
    RowFitter(std::string_view format, std::string_view codec, WriteOptions options);

    /// The pixel type of the options. @see PictureWriter::keep_type
    void keep_type(const OIIO::TypeDesc& source);
    /// Begins a picture.
    /// @returns  what a writer is asked for
    /// @throws FileError  the format cannot hold the picture: the reason, without the name of the
    ///                    file
    [[nodiscard]] PictureSpec open(const PictureSpec& picture);
    /// The better type for rows, half or float. Both give the same file.
    /// @param file  the type of the file
    [[nodiscard]] OIIO::TypeDesc row_type(const OIIO::TypeDesc& file) const;
    /// Passes the rows on, in the size and the order of the file.
    /// @param rows  the next ones of the picture, of its first or of its last rows
    void run(const Rows& rows, const std::function<void(const Rows&)>& write);

    /// Lines about the picture as a whole, for WriteOptions::warn: "the data window ... lies
    /// outside the display window".
    [[nodiscard]] std::string cut_off() const;
    /// After the last row: alpha that hides the picture, or loses light. Empty: none.
    [[nodiscard]] std::string lost_cover() const;

  private:
    void plan_alpha(PictureSpec& spec);
    void plan_channels(PictureSpec& spec, const FormatLimits& limits);
    void plan_window(PictureSpec& spec, const FormatLimits& limits);
    void plan_cover(PictureSpec& spec, const FormatLimits& limits);
    void plan_type(PictureSpec& spec, const FormatLimits& limits) const;
    void watch_cover(const float* pixels, std::size_t count);
    void write_part(const Rows& rows, std::size_t width,
                    const std::function<void(const Rows&)>& write);

    std::string_view format_;
    std::string_view codec_;
    WriteOptions options_;
    PictureSpec picture_;
    std::vector<int> channels_;         // to write; empty: all
    int channel_count_ = 0;             // of the file
    int alpha_ = -1;                    // of those that are written
    int z_ = -1;                        // depth, as alpha_
    bool watches_cover_ = false;        // warns if alpha is 0 everywhere
    bool has_cover_ = false;            // alpha is not 0 everywhere
    float surface_light_ = 1;           // the most of an opaque surface
    bool becomes_straight_ = false;     // the file divides color by alpha
    bool multiplies_by_alpha_ = false;  // the picture has straight alpha, and the file has not
    bool divides_by_alpha_ = false;
    double pixel_count_ = 0;             // of what is written
    double lost_count_ = 0;              // pixels whose light straight alpha cannot hold
    std::optional<PixelWindow> window_;  // to write; none: all of the picture
    int next_row_ = 0;                   // of the window, or of the picture
};

/// A share of 0 to 1 as percent, rounded up, so that a single pixel is not 0 %.
[[nodiscard]] std::string percent_text(double share);
/// "8 bits", "half", ...
[[nodiscard]] std::string title_of_type(const OIIO::TypeDesc& type);

/// Pixel type of an OpenEXR file for a picture of another type: half for half and for 8 bits, whose
/// codes the 11 significant bits of half tell apart, else float.
[[nodiscard]] TONEWRIGHT_API OIIO::TypeDesc openexr_type(const OIIO::TypeDesc& source);

/// Without alpha, color is taken as it is: sets `unpremult` for pictures whose alpha is left out.
/// @throws Error  color is to be divided by that alpha
TONEWRIGHT_API void take_alpha(TonemapOptions& tonemap, const WriteOptions& write);

/// Multiplies color by alpha.
/// @param pixels  interleaved
TONEWRIGHT_API void multiply_by_alpha(float* pixels, std::size_t count, std::size_t channels,
                                      int alpha);

TONEWRIGHT_NAMESPACE_END
