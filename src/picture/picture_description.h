// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "picture/picture_error.h"
#include "picture/picture_spec.h"
#include "tonewright/tonemap_options.h"
#include "tonewright/view.h"

/// Facts in the header of a picture, and their consequences. Every reader of pictures asks here.
TONEWRIGHT_NAMESPACE_BEGIN

/// The meaning of a picture's numbers.
struct PictureDescription {
    SourceColor color;
    /// "linear", "sRGB", "gamma 2.2", "PQ", ...
    std::string transfer;
    /// The rule that decided: "cICP", "ICC profile", "<<input>>", "default of 8-bit TIFF", ...
    std::string rule;
    /// Exif's orientation, [1, 8]: 1 is upright.
    int orientation = 1;
    /// The layer, as the file names it; empty: the channels R, G, B or gray.
    std::string layer;
    /// Number from 0, and the name if there is one.
    std::string subimage;
    /// "relative", or "cd/m2" for absolute luminance.
    std::string units;
    /// "none", "associated" or "straight".
    std::string alpha;
    /// Tags of the header that are read and not used: lines, each `TAG: why, or what follows`.
    std::vector<std::string> ignored;
};

/// Describes a picture by its metadata, after complete_header() if the reader was ours. Of a
/// picture without a format (in memory, or converted since it was read), `oiio:ColorSpace`,
/// `colorInteropID`, `acesImageContainerFlag` and `chromaticities` count.
///
/// @param input    a name (@see find_source_color), or `auto`
/// @throws Error         `input` is an unknown name
/// @throws PictureError  an unknown name, impossible chromaticities, a pair of code points without
///                       meaning, a damaged profile, an encoding that is not decoded
[[nodiscard]] TONEWRIGHT_API PictureDescription describe_picture(const PictureSpec& spec,
                                                                 std::string_view input);

/// The color alone. @see describe_picture
[[nodiscard]] TONEWRIGHT_API SourceColor source_color(const PictureSpec& spec,
                                                      std::string_view input);

/// The spec of a picture that OpenImageIO may have read: with the name of its format, by which
/// describe_picture() reads the metadata.
/// @param format  OpenImageIO's name; empty: not known
[[nodiscard]] TONEWRIGHT_API PictureSpec described_spec(PictureSpec spec, std::string_view format);

/// Only the attributes that describe_picture() reads, because rows do not need the texts of their
/// picture.
[[nodiscard]] TONEWRIGHT_API PictureSpec with_color_metadata_alone(const PictureSpec& spec);

/// The spec of a picture whose pixels SourceColor::convert made: floats, and the metadata states
/// linear Rec.709 or the primaries of `color`.
[[nodiscard]] TONEWRIGHT_API PictureSpec converted_spec(const PictureSpec& spec,
                                                        const SourceColor& color);

/// Says that the pixels were decoded to the light of `color`. describe_picture() then ignores its
/// input.
TONEWRIGHT_API void tag_as_light(PictureSpec& spec, const SourceColor& color);

/// Exif's orientation of a picture; 1 for values that do not exist.
[[nodiscard]] TONEWRIGHT_API int orientation_of(const PictureSpec& spec);

TONEWRIGHT_NAMESPACE_END
