// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imageio.h>

#include <optional>
#include <string>
#include <string_view>

#include "image/png_chunks.h"
#include "lut/icc.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Makes the metadata say what a picture holds after `view`: sets `oiio:ColorSpace`, and
/// `chromaticities` where they are not those of Rec.709, and removes whatever described the
/// source's colors.
TONEWRIGHT_API void tag_as_result_of(const View& view, OIIO::ImageSpec& spec);
/// @param display  id of a display, or `linear`
TONEWRIGHT_API void tag_as_shown_on(std::string_view display, OIIO::ImageSpec& spec);
/// Removes it, and says nothing: nobody knows what the colors are now.
TONEWRIGHT_API void tag_as_unknown(OIIO::ImageSpec& spec);

/// What the metadata of a picture says of its colors, as far as files can say it.
struct TaggedColor {
    std::string name;  // "sRGB", "Gamma 2.4", "linear light", or the title of a display
    Primaries primaries;
    /// Of an SDR display, or of linear light.
    std::optional<IccCurve> curve = {};
    /// Of an HDR display.
    std::optional<CodePoints> code_points = {};
};
/// From `oiio:ColorSpace` and `chromaticities`. None where they say nothing that is known.
[[nodiscard]] TONEWRIGHT_API std::optional<TaggedColor> tagged_color(const OIIO::ImageSpec& spec);

/// How a file of some format says what its colors are.
struct ColorDescription {
    std::string icc;    // a profile; empty: none
    std::string chunk;  // of PNG; empty: none
    /// Why viewers take the colors for others; empty: they do not.
    std::string missing;
};
/// @param spec    of the file
/// @param format  OIIO's name of the format
[[nodiscard]] TONEWRIGHT_API ColorDescription describe_color(const OIIO::ImageSpec& spec,
                                                             std::string_view format);

TONEWRIGHT_NAMESPACE_END
