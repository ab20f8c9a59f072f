// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A name that find_source_color() takes.
struct SourceColorName {
    enum class Kind : unsigned char {
        linear,    // an input space
        display,   // the code values of a display
        config,    // another space of the config: camera logs, film, textures, data
        interop,   // another id of the Color Interop Forum
        encoding,  // an input encoding of LUTs, with its default primaries
        other      // names with numbers
    };
    std::string id;
    std::string title;
    std::vector<std::string> aliases;
    Kind kind;
};
[[nodiscard]] TONEWRIGHT_API std::vector<SourceColorName> all_source_color_names();

/// The color that a file states by code points of ITU-T H.273 (07/2021): `cICP` of PNG, `nclx` of
/// HEIF and AVIF, the tag `cicp` of an ICC profile.
///
/// Pictures in files are display-referred. Therefore the values 1, 6, 14 and 15, whose table
/// prints the curve of cameras, have the display of ITU-R BT.1886, a 2.4 power; 11 and 12 are their
/// extensions to negative codes. Skia (Chromium), zimg (ffmpeg's zscale), libplacebo and
/// OpenImageIO 3.1 take the same display. The camera curve is the source color `Rec709`.
///
/// PQ (16) and HLG (18) are absolute luminance: 1.0 is kUnitLuminance cd/m2. HLG has the system
/// gamma 1.2 of a display of 1000 cd/m2, with the luminance of its primaries. The logarithmic
/// curves (9, 10) begin at 1/100 and 1/316.2, the light of code 0. The primaries 10 are CIE XYZ
/// with D65 as gray, without adaptation, as the Color Interop Forum has them.
///
/// @param primaries  ColourPrimaries, table 2
/// @param transfer   TransferCharacteristics, table 3
/// @return  the color, named by the display's title (`sRGB`, `Rec.2100-PQ`), the input space's id,
///          or `cicp:P/T`; none for reserved and unspecified values
[[nodiscard]] TONEWRIGHT_API std::optional<SourceColor> color_of_code_points(int primaries,
                                                                             int transfer);

/// Both names for messages: "BT.2020 / PQ", "unspecified / sRGB", "reserved 3 / BT.709".
[[nodiscard]] TONEWRIGHT_API std::string code_point_names(int primaries, int transfer);

TONEWRIGHT_NAMESPACE_END
