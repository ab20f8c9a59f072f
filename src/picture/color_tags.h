// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "lut/icc.h"
#include "picture/picture_spec.h"
#include "picture/png_chunks.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Removes attributes, and needs no memory for it.
/// @param name  in any case; with `*` at its end, all names that begin so
TONEWRIGHT_API void erase_attributes(PictureSpec& spec, std::string_view name);

/// Sets the metadata of a picture after `view`: `oiio:ColorSpace`, and `chromaticities` if they are
/// not those of Rec.709; for OpenEXR `colorInteropID` by the Color Interop Forum's list, or
/// `tonewright:display`, a name of find_source_color(), where the list has none. Removes the
/// description of the source's colors, and that of a gain map.
TONEWRIGHT_API void tag_as_result_of(const View& view, PictureSpec& spec);
/// @param display  id of a display, or `linear`
TONEWRIGHT_API void tag_as_shown_on(std::string_view display, PictureSpec& spec);
/// Removes the description of the colors, because they are unknown now.
TONEWRIGHT_API void tag_as_unknown(PictureSpec& spec);

/// The color in the metadata of a picture, as far as files can store it.
struct TaggedColor {
    std::string name;  // "sRGB", "Gamma 2.4", "linear light", or the title of a display
    Primaries primaries;
    /// For an SDR display, or linear light.
    std::optional<IccCurve> curve = {};
    /// For an HDR display.
    std::optional<CodePoints> code_points = {};
};
/// From `oiio:ColorSpace` and `chromaticities`. None where they say nothing that is known.
[[nodiscard]] TONEWRIGHT_API std::optional<TaggedColor> tagged_color(const PictureSpec& spec);

/// Statement of the colors in the files of a format.
struct ColorDescription {
    std::string icc;    // a profile; empty: none
    std::string chunk;  // of PNG; empty: none
    /// Why viewers take the colors for others; empty: they do not.
    std::string missing;
};
/// @param spec    of the file
/// @param format  OpenImageIO's name of the format
[[nodiscard]] TONEWRIGHT_API ColorDescription describe_color(const PictureSpec& spec,
                                                             std::string_view format);

TONEWRIGHT_NAMESPACE_END
