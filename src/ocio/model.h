// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/encoded_spaces.h"
#include "tonewright/ocio.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Contents of the config, independent of OCIO objects. All profiles are written from this model.
struct ConfigModel {
    enum class SpaceKind : unsigned char {
        scene_linear,
        /// Camera and ACES log spaces with a BuiltinTransform to ACES2065-1 in OCIO.
        builtin,
        /// A log space without a BuiltinTransform in OpenColorIO 2.0.
        log,
        /// Pictures and textures in a display's code values, decoded to scene-linear.
        texture,
        data,
        display_reference,
        display
    };
    struct Space {
        SpaceKind kind = SpaceKind::data;
        std::string name;
        std::vector<std::string> aliases;
        std::string family;
        std::string description;
        std::string encoding;  // OCIO's word
        std::vector<std::string> categories;
        const Primaries* primaries = nullptr;  // linear spaces, logs, textures and displays
        const Display* display = nullptr;  // displays, and the display whose curve a texture has
        std::string style = {};            // of a builtin
        /// Id of the Color Interop Forum, or with a namespace an id of OpenColorIO's configs
        /// ("ocio:") or of Tonewright; empty if there is none. Also an alias, for libraries
        /// before 2.5.
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
    /// Transform of the scene before a view of the operator, equal to the operator with that look.
    /// Applications that support looks can combine it with the view.
    struct Look {
        std::string name;  // "AgX - Punchy": Blender shows it for the view AgX
        Pipeline stages;   // in the operator's working space
        const Operator* op = nullptr;
        std::string description;
    };
    /// File names of pictures -> space; the first match counts. Longer words come first, and words
    /// before extensions.
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
    std::string cache_folder;  // @see ConfigOptions
};

/// View transform of a view on a display.
struct DisplayedView {
    std::string transform;
    Pipeline stages;
    const Display* display;
    /// Name of the view on the display.
    std::string name;
    ResolvedOperator op;
};

/// @throws Error  for unknown views, looks and displays, and for names that applications cannot
///                use: over 63 bytes, duplicates, an alias that is a role.
[[nodiscard]] TONEWRIGHT_API ConfigModel make_config_model(const ConfigOptions& options = {});

/// @see ConfigPlan::warnings
[[nodiscard]] std::vector<std::string> config_warnings(const ConfigModel& model);

inline constexpr const char* kUntonemappedView = "Un-tone-mapped";
inline constexpr const char* kRawView = "Raw";

TONEWRIGHT_NAMESPACE_END
