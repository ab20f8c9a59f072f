// SPDX-License-Identifier: Apache-2.0
#include "ocio/newer_profile.h"

#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <new>
#include <sstream>
#include <string_view>

#include "ocio/yaml_text.h"
#include "tonewright/color.h"

namespace OCIO = OCIO_NAMESPACE;

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Part {
    const char* key;
    const char* noun;
};
constexpr std::array<Part, 5> kParts = {{
    {"colorspaces", "color space"},
    {"display_colorspaces", "color space"},
    {"view_transforms", "view transform"},
    {"looks", "look"},
    {"named_transforms", "named transform"},
}};

/// Minor version of "2.5" or "2.5.1"; 0 of "2"; empty for other texts.
std::optional<int> minor_version(std::string_view version) {
    if (version == "2") return 0;
    if (!version.starts_with("2.")) return std::nullopt;
    int minor = 0;
    const char* const end = version.data() + version.size();
    const auto [stop, error] = std::from_chars(version.data() + 2, end, minor);
    if (error != std::errc() || (stop != end && *stop != '.')) return std::nullopt;
    return minor;
}

std::string emit(const YAML::Node& node) {
    YAML::Emitter out;
    emit_as_config(out, node);
    return out.c_str();
}

/// True if OpenColorIO reads a config of this profile with the transform.
bool is_read(const YAML::Node& transform, const std::string& profile) {
    YAML::Node space(YAML::NodeType::Map);
    space.SetTag("ColorSpace");
    space["name"] = "a";
    space["from_scene_reference"] = transform;
    YAML::Node config(YAML::NodeType::Map);
    config["ocio_profile_version"] = profile;
    config["roles"]["default"] = "a";
    config["colorspaces"].push_back(space);
    std::istringstream text(emit(config));
    try {
        (void)OCIO::Config::CreateFromStream(text);
        return true;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception&) {
        return false;
    }
}

/// Display P3 of OpenColorIO 2.3, in operations of 2.0.
YAML::Node display_p3() {
    const Matrix3 m = inverse(rgb_to_xyz_d65(kP3D65));
    return YAML::Load(fmt::format(
        "!<GroupTransform>\n"
        "children:\n"
        "  - !<MatrixTransform> {{matrix: [{}, {}, {}, 0, {}, {}, {}, 0, {}, {}, {}, 0, 0, 0, 0, "
        "1]}}\n"
        "  - !<ExponentWithLinearTransform> {{gamma: [2.4, 2.4, 2.4, 1], offset: [0.055, 0.055, "
        "0.055, 0], direction: inverse}}\n",
        m[0][0], m[0][1], m[0][2], m[1][0], m[1][1], m[1][2], m[2][0], m[2][1], m[2][2]));
}

/// An older transform that equals a built-in one for values that are not negative, or null.
YAML::Node older_builtin(const YAML::Node& transform) {
    constexpr std::string_view kMirror = " - MIRROR NEGS";
    if (transform.Tag() != "BuiltinTransform" || !transform.IsMap() || !transform["style"])
        return {};
    const std::string& style = transform["style"].Scalar();
    if (style == "DISPLAY - CIE-XYZ-D65_to_DisplayP3" && !transform["direction"])
        return display_p3();
    if (!style.ends_with(kMirror)) return {};
    YAML::Node older = YAML::Clone(transform);
    older["style"] = style.substr(0, style.size() - kMirror.size());
    return older;
}

enum class Reading : unsigned char { as_it_is, as_older, not_at_all };

/// Replaces what OpenColorIO does not read.
Reading replace_unread(const YAML::Node& item, const std::string& profile) {
    Reading reading = Reading::as_it_is;
    for (auto entry : item) {
        YAML::Node transform = entry.second;
        if (!transform.IsMap() || !transform.Tag().ends_with("Transform")) continue;
        if (is_read(transform, profile)) continue;
        YAML::Node older = older_builtin(transform);
        if (!older.IsNull() && is_read(older, profile)) {
            reading = std::max(reading, Reading::as_older);
        } else {
            reading = Reading::not_at_all;
            older = YAML::Node(YAML::NodeType::Map);
            older.SetTag("MatrixTransform");
            older.SetStyle(YAML::EmitterStyle::Flow);
        }
        transform = older;
    }
    return reading;
}

/// Null if there is no such key.
YAML::Node value_of(const YAML::Node& map, const char* key) {
    const YAML::Node value = map[key];
    return value ? value : YAML::Node();
}

}  // namespace

std::optional<ReadableProfile> make_readable(const std::string& text) {
    const std::optional<int> newest = minor_version(OCIO::GetVersion());
    YAML::Node config;
    try {
        config = YAML::Load(text);
    } catch (const YAML::Exception&) {
        return std::nullopt;  // OpenColorIO reports it
    }
    if (!newest || !config.IsMap()) return std::nullopt;
    YAML::Node version = value_of(config, "ocio_profile_version");
    const std::optional<int> wanted =
        version.IsScalar() ? minor_version(version.Scalar()) : std::nullopt;
    if (!wanted || *wanted <= *newest) return std::nullopt;
    ReadableProfile readable;
    readable.profile = version.Scalar();
    readable.newest = fmt::format("2.{}", *newest);
    version = readable.newest;
    for (const Part& part : kParts) {
        const YAML::Node items = value_of(config, part.key);
        if (!items.IsSequence()) continue;
        for (YAML::Node item : items) {
            if (!item.IsMap()) continue;
            // OpenColorIO would warn of them and go on.
            item.remove("interop_id");
            item.remove("interchange");
            const Reading reading = replace_unread(item, readable.newest);
            const YAML::Node name_node = value_of(item, "name");
            const std::string name = name_node.IsScalar() ? name_node.Scalar() : "";
            if (reading == Reading::as_older) readable.older.push_back(name);
            if (reading == Reading::not_at_all)
                readable.unread.push_back(fmt::format("{} {}", part.noun, name));
        }
    }
    readable.text = emit(config);
    return readable;
}

TONEWRIGHT_NAMESPACE_END
