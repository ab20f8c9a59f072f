// SPDX-License-Identifier: Apache-2.0
#include "cli/suggestions.h"

#include <algorithm>
#include <string_view>

#include "tonewright/input_encoding.h"
#include "tonewright/lut_applications.h"
#include "tonewright/registry.h"
#include "tonewright/shader.h"
#include "tonewright/source_color.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Finds an id without exceptions, because the user is still typing.
const Operator* operator_of(std::string_view text) {
    const std::string_view id = text.substr(0, text.find(':'));
    for (const std::vector<Operator>* operators : {&all_operators(), &local_operators()}) {
        const auto found = std::find_if(operators->begin(), operators->end(),
                                        [&](const Operator& op) { return op.id == id; });
        if (found != operators->end()) return &*found;
    }
    return nullptr;
}

/// Null: the command line has none.
const Operator* named_operator(const TypedValue& typed) {
    for (const char* name : {"--operator", "OPERATOR", "OPERATORS"}) {
        const auto found = typed.others.find(name);
        if (found != typed.others.end() && !found->second.empty())
            return operator_of(found->second.front());
    }
    return typed.others.contains("IN") ? operator_of(kDefaultOperator) : nullptr;
}

/// `white=`, and `space=ap1` of a choice.
void add_settings(Suggestions& all, const std::string& before, const Operator& op) {
    for (const ParameterSpec& spec : op.parameters) {
        const std::string name = before + spec.name + "=";
        if (spec.choices.empty()) all.words.push_back({name, spec.help});
        for (const std::string& choice : spec.choices)
            all.words.push_back({name + choice, spec.help});
    }
}

template <class Item>
void add_ids(Suggestions& all, const std::vector<Item>& items) {
    for (const Item& item : items)
        all.words.push_back({item.id, item.title});
}

template <class Item>
Suggestions ids_of(const std::vector<Item>& items) {
    Suggestions all;
    add_ids(all, items);
    return all;
}

}  // namespace

Suggestions suggest_operators(const TypedValue& typed) {
    Suggestions all;
    const std::size_t colon = typed.text.rfind(':');
    const Operator* op = colon == std::string::npos ? nullptr : operator_of(typed.text);
    if (!op) {
        add_ids(all, all_operators());
        add_ids(all, local_operators());
        all.has_files = true;
        return all;
    }
    const std::string before = typed.text.substr(0, colon + 1);
    for (const Preset& preset : op->presets)
        all.words.push_back({before + preset.id, preset.title});
    for (const Look& look : op->looks)
        all.words.push_back({before + "look=" + look.id, look.title});
    add_settings(all, before, *op);
    return all;
}

Suggestions suggest_looks(const TypedValue& typed) {
    if (const Operator* op = named_operator(typed)) return ids_of(op->looks);
    Suggestions all;
    for (const Operator& op : all_operators())
        add_ids(all, op.looks);
    return all;
}

Suggestions suggest_settings(const TypedValue& typed) {
    Suggestions all;
    if (const Operator* op = named_operator(typed)) add_settings(all, "", *op);
    return all;
}

Suggestions suggest_uniforms(const TypedValue& typed) {
    Suggestions all;
    all.words.push_back({std::string(kExposureUniform), "exposure in stops"});
    const Operator* op = named_operator(typed);
    if (!op) return all;
    for (const ParameterSpec& spec : op->parameters) {
        if (spec.kind == ParameterSpec::Kind::number && spec.is_live)
            all.words.push_back({spec.name, spec.help});
    }
    return all;
}

Suggestions suggest_displays(const TypedValue& typed) {
    Suggestions all = suggest_config_displays(typed);
    all.words.push_back({std::string(kLinearOutput), "unclamped Rec.709"});
    all.words.push_back({std::string(kNativeOutput), "output of the operator"});
    return all;
}

Suggestions suggest_config_displays(const TypedValue& /*typed*/) { return ids_of(all_displays()); }

Suggestions suggest_spaces(const TypedValue& /*typed*/) { return ids_of(all_input_spaces()); }

Suggestions suggest_input_colors(const TypedValue& /*typed*/) {
    Suggestions all;
    for (const SourceColorName& name : all_source_color_names()) {
        if (name.kind != SourceColorName::Kind::other) all.words.push_back({name.id, name.title});
    }
    return all;
}

Suggestions suggest_source_colors(const TypedValue& typed) {
    Suggestions all = suggest_input_colors(typed);
    all.words.push_back({"auto", "what the file says"});
    return all;
}

Suggestions suggest_encodings(const TypedValue& typed) {
    return one_of(input_encoding_names())(typed);
}

Suggestions suggest_lut_formats(const TypedValue& typed) {
    return one_of(lut_format_names())(typed);
}

Suggestions suggest_lut_applications(const TypedValue& /*typed*/) {
    return ids_of(all_lut_applications());
}

Suggestions suggest_languages(const TypedValue& /*typed*/) { return ids_of(shader_languages()); }

Suggestions suggest_shader_applications(const TypedValue& /*typed*/) {
    return ids_of(shader_applications());
}

Suggestions suggest_view_looks(const TypedValue& /*typed*/) {
    Suggestions all;
    for (const Operator& op : all_operators()) {
        for (const Look& look : op.looks)
            all.words.push_back({op.view + " - " + look.title, look.help});
    }
    all.words.push_back({"none", "no looks"});
    return all;
}

Suggestions suggest_views(const TypedValue& /*typed*/) {
    Suggestions all;
    for (const Operator& op : all_operators())
        all.words.push_back({op.view, op.title});
    add_ids(all, all_operators());
    all.words.push_back({"standard", "a dozen views"});
    all.words.push_back({"all", "all views"});
    return all;
}

TONEWRIGHT_NAMESPACE_END
