// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/tonemap.h"
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
[[nodiscard]] TONEWRIGHT_API PictureDescription describe_picture(const OIIO::ImageSpec& spec,
                                                                 std::string_view input);

/// The color alone. @see describe_picture
[[nodiscard]] TONEWRIGHT_API SourceColor source_color(const OIIO::ImageSpec& spec,
                                                      std::string_view input);

/// The spec of a picture that OpenImageIO may have read: with the name of its format, by which
/// describe_picture() reads the metadata.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageSpec described_spec(const OIIO::ImageBuf& picture);

/// Only the attributes that describe_picture() reads, because rows do not need the texts of their
/// picture.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageSpec with_color_metadata_alone(const OIIO::ImageSpec& spec);

/// Applies SourceColor::convert: the result has float pixels, and its metadata states linear
/// Rec.709 or the primaries of `color`. Associated color is divided by alpha before.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf converted_picture(const OIIO::ImageBuf& picture,
                                                              const SourceColor& color);
/// The spec of that result.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageSpec converted_spec(const OIIO::ImageSpec& spec,
                                                            const SourceColor& color);

/// Says that the pixels were decoded to the light of `color`. describe_picture() then ignores its
/// input.
TONEWRIGHT_API void tag_as_light(OIIO::ImageSpec& spec, const SourceColor& color);

/// The picture as viewers show it: turned by its orientation, which becomes 1.
/// @throws std::bad_alloc
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf upright(OIIO::ImageBuf picture);
/// Exif's orientation of a picture; 1 for values that do not exist.
[[nodiscard]] TONEWRIGHT_API int orientation_of(const OIIO::ImageSpec& spec);

TONEWRIGHT_NAMESPACE_END
