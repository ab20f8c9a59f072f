// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <string>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The scene of a picture `width` pixels wide: its display window, square pixels, float; color and
/// alpha alone.
///
/// Smaller, pixels are means of light, without negative lobes: 12 operators on it take no longer
/// than one on the picture, and noise and fine detail are those of the small picture. Larger, they
/// are repeated. At its own size a picture is left as it is. NaN is 0, and infinities are +-65504
/// before, so that one pixel does not spoil its neighbors.
///
/// @param width    of the result, pixels
/// @throws Error         deep, or cannot be read
/// @throws PictureError  a small picture in a display window that is too large to be filtered, or a
///                       result of more than 65535 rows
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf resize_scene(const OIIO::ImageBuf& picture, int width);

/// Number of columns for which a sheet of `count` equal cells is most like a screen, without gaps
/// if possible.
[[nodiscard]] TONEWRIGHT_API int choose_columns(int count, int cell_width, int cell_height);

struct SplitLabel {
    std::string title;
    std::string detail;  // dimmer, under it
};

struct SplitOptions {
    SplitLabel before;
    SplitLabel after;
    std::string remark;  // of both, where there is room
    /// Fraction of the width or height that shows `before`, [0, 1].
    double position = 0.5;
    /// Before above after, not left of it.
    bool is_horizontal = false;
    /// A line between the two, and their labels outside of the picture.
    bool has_labels = true;
};

/// Start of the second picture: the nearest pixel boundary.
[[nodiscard]] TONEWRIGHT_API int split_at(int length, double position);

/// Two display pictures in one: the first up to a line, then the second. All pixels except those of
/// the line are unchanged.
/// @throws Error  pictures of different sizes; position out of range
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf make_split(const OIIO::ImageBuf& before,
                                                       const OIIO::ImageBuf& after,
                                                       const SplitOptions& options);

/// Difference between two display pictures.
struct PictureDifference {
    OIIO::ImageBuf picture;  // absolute differences of code values, times `gain`; at most 1
    double largest = 0;      // of a channel
    double mean = 0;
};
/// @throws Error  pictures of different sizes
[[nodiscard]] TONEWRIGHT_API PictureDifference difference_of(const OIIO::ImageBuf& a,
                                                             const OIIO::ImageBuf& b, double gain);

TONEWRIGHT_NAMESPACE_END
