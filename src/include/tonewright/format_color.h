// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Meaning of a picture file's numbers if its header does not state it.
enum class FormatMeaning : unsigned char {
    /// Light by the format's definition (OpenEXR, Radiance HDR, PFM).
    linear,
    /// Code values of a display: sRGB.
    code_values,
    /// Film scans: densities in Kodak's Cineon log.
    film,
    /// Video: code values of a display of ITU-R BT.1886.
    video
};

/// A file format, and the colors that are assumed where its header says nothing. File rules of the
/// config, the input `auto` and the warnings about missing tags come from this table.
struct FormatColor {
    std::string_view format;  // OpenImageIO's name; a format may have several rows
    std::string_view title;
    /// In lower case, without the dot.
    std::vector<std::string_view> extensions;
    FormatMeaning meaning;
    /// Spaces of files without a tag, as find_source_color() takes them: for integer samples, and
    /// for half, float and double. A config's file rules know no sample types: they have the first.
    std::string_view integer_space;
    std::string_view float_space;
    /// Files that Tonewright writes state their color, so that a reader need not assume one.
    bool states_color = false;
    /// The config has a file rule for the extensions.
    bool has_file_rule = false;

    // For writers:
    /// Files can hold an ICC profile through OpenImageIO.
    bool has_icc = false;
    /// Files can hold the power of their code values.
    bool has_power = false;
};

/// In the order of the config's file rules.
[[nodiscard]] TONEWRIGHT_API const std::vector<FormatColor>& all_format_colors();

/// The row of a file: by its extension among those of the format. For another extension, the
/// format's row that is right for all sample types.
/// @param format     OpenImageIO's name; empty: any
/// @param extension  without the dot, any case; empty: any
/// @return  null for unknown formats and extensions
[[nodiscard]] TONEWRIGHT_API const FormatColor* find_format_color(std::string_view format,
                                                                  std::string_view extension = {});

TONEWRIGHT_NAMESPACE_END
