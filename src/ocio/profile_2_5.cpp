// SPDX-License-Identifier: Apache-2.0
#include "ocio/profile_2_5.h"

#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <set>
#include <sstream>

#include "ocio/interop.h"
#include "ocio/operator_facts.h"
#include "ocio/yaml_text.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr const char* kStandIn = "builtin:";

/// An empty line before every part and every space, look and view transform.
std::string spaced(const std::string& yaml) {
    std::string text;
    std::istringstream lines(yaml);
    for (std::string line; std::getline(lines, line);) {
        const bool is_part = line.find_first_not_of(' ') == 0 && line.back() == ':';
        const bool is_item = line.starts_with("  - !<") && line.back() == '>';
        const bool is_first = text.size() >= 2 && text[text.size() - 2] == ':';
        if (is_part || (is_item && !is_first)) text += '\n';
        text += line + '\n';
    }
    return text;
}

void replace_stand_ins(YAML::Node node) {
    if (node.Tag() == "FileTransform") {
        const std::string src = node["src"].Scalar();
        if (!src.starts_with(kStandIn)) return;
        node = YAML::Node(YAML::NodeType::Map);
        node.SetTag("BuiltinTransform");
        node.SetStyle(YAML::EmitterStyle::Flow);
        node["style"] = src.substr(std::string_view(kStandIn).size());
        return;
    }
    if (node.IsScalar()) return;
    for (auto item : node)
        replace_stand_ins(node.IsMap() ? item.second : item);
}

void set_amf_ids(YAML::Node node, const std::vector<std::string>& ids) {
    if (ids.empty()) return;
    node["interchange"]["amf_transform_ids"] = fmt::format("{}\n", fmt::join(ids, "\n"));
}

}  // namespace

OCIO::TransformRcPtr builtin_of_profile_2_5(const std::string& style) {
    OCIO::FileTransformRcPtr stand_in = OCIO::FileTransform::Create();
    stand_in->setSrc((kStandIn + style).c_str());
    return stand_in;
}

std::string to_profile_2_5(const std::string& yaml, const ConfigModel& model,
                           const std::map<std::string, std::vector<DisplayedView>>& displayed) {
    YAML::Node config = YAML::Load(yaml);
    config["ocio_profile_version"] = "2.5";
    std::map<std::string, YAML::Node> spaces;
    for (const char* part : {"colorspaces", "display_colorspaces"}) {
        for (const YAML::Node& space : config[part])
            spaces[space["name"].Scalar()] = space;
    }
    for (const auto& space : model.spaces) {
        YAML::Node node = spaces.at(space.name);
        if (!space.interop_id.empty()) node["interop_id"] = space.interop_id;
        set_amf_ids(node, space.kind == ConfigModel::SpaceKind::display
                              ? amf_ids_of_output("", space.display->id)
                              : amf_ids_of_space(space.name));
    }
    std::map<std::string, std::set<std::string>> ids;
    for (const auto& view : model.views) {
        if (view.exposure_stops != 0) continue;  // not the Academy's
        for (const DisplayedView& shown : displayed.at(view.name)) {
            const std::string style = builtin_style(shown.op);
            if (style.empty()) continue;
            for (const std::string& id : amf_ids_of_output(style, shown.display->id))
                ids[shown.transform].insert(id);
        }
    }
    for (YAML::Node transform : config["view_transforms"]) {
        const auto found = ids.find(transform["name"].Scalar());
        if (found != ids.end())
            set_amf_ids(transform, {found->second.begin(), found->second.end()});
        replace_stand_ins(transform);
    }
    YAML::Emitter out;
    emit_as_config(out, config);
    return spaced(out.c_str());
}

TONEWRIGHT_NAMESPACE_END
