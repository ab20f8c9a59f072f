// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Meaning of a picture's numbers by an ICC profile.
struct IccSource {
    /// Curves and colorants, exactly, or tables through LittleCMS. Relative colorimetric: the
    /// profile's white becomes (1, 1, 1).
    SourceColor color;
    /// The profile's name, printable ASCII; may be empty.
    std::string description;
    /// Primaries and transfer characteristics (ITU-T H.273) of a `cicp` tag. They take precedence
    /// over `color` (ICC.1:2022, 9.2.17).
    std::optional<std::pair<int, int>> code_points = {};
    /// The profile has tables: `color` needs SourceColor::convert.
    bool has_tables = false;
};

/// Reads an ICC profile of version 2 or 4: RGB or gray; input, display, output or color space.
///
/// Tables (D2B1, A2B1, A2B0) take precedence over curves and colorants, as ICC.1:2022, 8.10.2
/// says. A profile that agrees with a display or an input space gives exactly that one, by name,
/// so that its programs are shared. Every other color is named "ICC: ...", with a hash.
///
/// Numbers outside [0, 1] follow a parametric curve's formula, and powers of negatives are 0.
/// Sampled curves keep their first and last value. Tables (but no float elements) limit their input
/// to [0, 1]. LittleCMS does the same in float.
///
/// @param profile   its bytes, at most 32 MiB
/// @param channels  of color in the picture, 1 or 3. An RGB profile also serves gray pictures.
/// @param what      names the picture in messages
/// @throws Error    one line: damaged, CMYK or another color space, a class that describes no
///                  picture, a gray profile for a color picture, or tables without LittleCMS
[[nodiscard]] TONEWRIGHT_API IccSource color_of_icc(std::string_view profile, int channels,
                                                    const std::string& what);

TONEWRIGHT_NAMESPACE_END
