// SPDX-License-Identifier: Apache-2.0
//
// Limits of OpenImageIO's writers. Some of them end the process for a layout of channels that they
// do not check, and others write files that no reader takes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "picture/picture_spec.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Storage of alpha in a format.
enum class FileAlpha : unsigned char {
    none,
    /// Color is not multiplied by alpha: we divide before the writer gets it.
    straight,
    /// The writer divides color, in 8 bits and with a power.
    straight_by_writer,
    associated,
    /// The file says which.
    either,
};

/// Windows that differ from the picture of 0, 0 to its size.
enum class FileWindows : unsigned char { none, not_negative, all };

struct FormatLimits {
    std::string_view format;  // OpenImageIO's name
    std::string_view title;
    /// Numbers of channels that the writer keeps: gray, gray and alpha, RGB, RGB and alpha.
    bool gray, gray_alpha, rgb, rgba;
    /// Further channels.
    bool others;
    FileAlpha alpha;
    FileWindows windows = FileWindows::none;
    /// Pixels in each direction.
    int least = 1;
    int most = 0x7FFFFFFF;
    /// `oiio:BitsPerSample` may be 10 or 12.
    bool has_bits = false;
    /// Other types than 8 bits are written wrong.
    bool is_8_bit = false;
};

/// @param format  OpenImageIO's name. An unknown format takes everything.
[[nodiscard]] TONEWRIGHT_API const FormatLimits& format_limits(std::string_view format);

/// Channels of the picture in the order of the file: an index, or -1 for opaque alpha. A gray
/// picture becomes RGB where a format has no gray. What a format does not store is left out.
/// @returns  empty if the format stores no such colors
[[nodiscard]] TONEWRIGHT_API std::vector<int> file_channels(const PictureSpec& spec,
                                                            const FormatLimits& limits,
                                                            bool leaves_out_alpha);

/// Why the writer must not get a picture of this size: one line, or empty.
[[nodiscard]] TONEWRIGHT_API std::string size_refusal(const FormatLimits& limits, int width,
                                                      int height);

TONEWRIGHT_NAMESPACE_END
