// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tonewright/ocio.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Everything that the config says, once, before any of it becomes an OCIO object: all profiles are
/// written from this.
struct ConfigModel {
    enum class SpaceKind : unsigned char {
        scene_linear,
        /// What OCIO has a BuiltinTransform to ACES2065-1 for: logs of cameras and of ACES.
        builtin,
        /// A log that OpenColorIO 2.0 has no BuiltinTransform for.
        log,
        /// Pictures and textures in a display's code values, read as scene light.
        texture,
        data,
        display_reference,
        display
    };
    /// Light is (base^((code - log_offset) / log_slope) - linear_offset) / linear_slope: the
    /// numbers of OpenColorIO's LogAffineTransform.
    struct LogCurve {
        double base = 2;
        double log_slope = 1;
        double log_offset = 0;
        double linear_slope = 1;
        double linear_offset = 0;
        /// Below this light the curve goes on as a straight line.
        std::optional<double> linear_break = {};
    };
    struct Space {
        SpaceKind kind;
        std::string name;
        std::vector<std::string> aliases;
        std::string family;
        std::string description;
        std::string encoding;  // OCIO's word
        std::vector<std::string> categories;
        const Primaries* primaries = nullptr;  // linear spaces, logs, textures and displays
        const Display* display = nullptr;  // displays, and the display whose curve a texture has
        std::string style = {};            // of a builtin
        /// Of the Color Interop Forum, "ocio:" before it where OpenColorIO's configs have one that
        /// the forum does not; empty: neither has. An alias as well, for libraries before 2.5.
        std::string interop_id = {};
        LogCurve curve = {};  // of a log
    };
    struct View {
        std::string name;
        ResolvedOperator op;
        std::string description;  // without the measured error
        double exposure_stops = 0;
        bool is_sdr_only = false;

        [[nodiscard]] bool is_on(const Display& display) const {
            return !(is_sdr_only && display.is_hdr);
        }
    };
    /// What is done to a scene before a view of the operator, and is the same as the operator with
    /// that look: then hosts that know looks can combine it with the view.
    struct Look {
        std::string name;  // "AgX - Punchy": Blender shows it for the view AgX
        Pipeline stages;   // in the operator's working space
        const Operator* op = nullptr;
        std::string description;
    };
    /// Names of pictures -> space; the first that matches counts. Longer words come first, and
    /// words before extensions.
    struct FileRule {
        std::string name;
        std::string space;
        std::string extension;  // or
        std::string regex;
    };

    std::string name;
    std::string description;
    std::vector<Space> spaces;
    std::vector<const Display*> displays;
    std::vector<View> views;
    std::vector<Look> looks;
    /// Role -> space.
    std::vector<std::pair<std::string, std::string>> roles;
    std::vector<FileRule> file_rules;
    std::string default_space;
};

/// @throws Error  for unknown views, looks and displays, and for names that hosts cannot take: over
///                63 bytes, twice the same, an alias that is a role.
[[nodiscard]] TONEWRIGHT_API ConfigModel make_config_model(const ConfigOptions& options = {});

inline constexpr const char* kDataSpace = "Non-Color";
inline constexpr const char* kUntonemappedView = "Un-tone-mapped";
inline constexpr const char* kRawView = "Raw";
/// Display color spaces have the display's name, as Blender looks for them, and with this behind
/// it, as the ACES configs have them, for an alias.
inline constexpr const char* kDisplaySuffix = " - Display";

TONEWRIGHT_NAMESPACE_END
