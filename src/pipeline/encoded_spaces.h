// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Scene-linear is (base^((code - log_offset) / log_slope) - linear_offset) / linear_slope:
/// parameters of OpenColorIO's LogAffineTransform.
struct LogCurve {
    double base = 2;
    double log_slope = 1;
    double log_offset = 0;
    double linear_slope = 1;
    double linear_offset = 0;
    /// Below this value the curve continues as a straight line.
    std::optional<double> linear_break = {};
};

/// A space of the config that is neither scene-linear nor a display.
struct EncodedSpace {
    enum class Kind : unsigned char {
        /// Camera and ACES log spaces with a BuiltinTransform to ACES2065-1 in OpenColorIO 2.0.
        builtin,
        /// A log space without one.
        log,
        /// Pictures and textures in a display's code values, decoded to scene-linear.
        texture,
        data,
        display_reference
    };
    Kind kind;
    std::string title;  // its name in the OCIO config
    std::vector<std::string> aliases;
    std::string family;
    std::string description;
    /// Id of the Color Interop Forum, or with the prefix "ocio:" an id that only OpenColorIO's
    /// configs have; empty if neither has one.
    std::string interop_id;
    Primaries primaries;
    /// Code values -> scene-linear of these primaries. Empty: the numbers are linear, or no color;
    /// the display reference is CIE XYZ.
    Pipeline decode = {};
    std::string style = {};    // of a builtin
    LogCurve curve = {};       // of a log: the same as `decode`
    std::string display = {};  // id of the display whose curve a texture has
};

inline constexpr const char* kTextureSpace = "sRGB - Texture";
inline constexpr const char* kVideoSpace = "Gamma 2.4 Rec.709 - Texture";
inline constexpr const char* kFilmSpace = "Cineon";
inline constexpr const char* kDataSpace = "Non-Color";

/// In the order of the config: builtins, logs, textures, data, the display reference.
[[nodiscard]] TONEWRIGHT_API const std::vector<EncodedSpace>& all_encoded_spaces();

TONEWRIGHT_NAMESPACE_END
