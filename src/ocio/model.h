// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tonewright/view.h"

namespace tonewright {

/// Everything that the config says, once, before any of it becomes an OCIO object: the profiles are
/// written from this.
struct ConfigModel {
    enum class SpaceKind : unsigned char {
        scene_linear,
        acescct,
        texture,
        data,
        display_reference,
        display
    };
    struct Space {
        SpaceKind kind;
        std::string name;
        std::vector<std::string> aliases;
        std::string family;
        std::string description;
        std::string encoding;  // OCIO's word
        std::vector<std::string> categories;
        const Primaries* primaries = nullptr;  // linear spaces and displays
        const Display* display = nullptr;  // displays, and the display whose curve a texture has
    };
    struct View {
        std::string name;
        ResolvedOperator op;
        std::string description;  // without the measured error
    };

    std::string name;
    std::string description;
    std::vector<Space> spaces;
    std::vector<const Display*> displays;
    std::vector<View> views;
    /// Role -> space.
    std::vector<std::pair<std::string, std::string>> roles;
    /// File extension -> space, first match first; everything else is `default_space`.
    std::vector<std::pair<std::string, std::string>> file_rules;
    std::string default_space;
};

/// @throws Error  for names that hosts cannot take: over 63 bytes, twice the same, an alias that is
/// a
///                role.
[[nodiscard]] ConfigModel make_config_model();

inline constexpr const char* kDataSpace = "Non-Color";
inline constexpr const char* kUntonemappedView = "Un-tone-mapped";
inline constexpr const char* kRawView = "Raw";
/// Display colour spaces have the display's name with this behind it, and the display's name as
/// alias.
inline constexpr const char* kDisplaySuffix = " - Display";

}  // namespace tonewright
