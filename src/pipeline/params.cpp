// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cmath>

#include "tonewright/pipeline.h"

namespace tonewright {
namespace {

template <class Items, class Name>
std::vector<std::string> names_of(const Items& items, Name name) {
    std::vector<std::string> names;
    for (const auto& item : items)
        names.push_back(name(item));
    return names;
}

double parse_number(const Operator& op, const ParameterSpec& spec, const std::string& text) {
    double value = 0;
    const char* end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, value);
    const bool is_number = result.ec == std::errc() && result.ptr == end && std::isfinite(value);
    if (!is_number || value < spec.min || value > spec.max) {
        throw Error(op.id + ": " + spec.name + " is " + text + "; expected [" + shortest(spec.min) +
                    ", " + shortest(spec.max) + "]" + (spec.unit.empty() ? "" : " " + spec.unit));
    }
    return value;
}

}  // namespace

ParameterSpec number_parameter(std::string name, std::string unit, double value, double min,
                               double max, std::string help) {
    ParameterSpec spec;
    spec.name = std::move(name);
    spec.unit = std::move(unit);
    spec.default_value = value;
    spec.min = min;
    spec.max = max;
    spec.help = std::move(help);
    return spec;
}

ParameterSpec choice_parameter(std::string name, std::vector<std::string> choices,
                               std::string value, std::string help) {
    ParameterSpec spec;
    spec.name = std::move(name);
    spec.choices = std::move(choices);
    spec.default_choice = std::move(value);
    spec.help = std::move(help);
    return spec;
}

double Params::number(std::string_view name) const {
    const auto it = numbers_.find(name);
    if (it == numbers_.end()) throw Error("operator has no number parameter " + std::string(name));
    return it->second;
}

const std::string& Params::choice(std::string_view name) const {
    const auto it = choices_.find(name);
    if (it == choices_.end()) throw Error("operator has no enumeration " + std::string(name));
    return it->second;
}

const Operator& find_operator(std::string_view id) {
    for (const Operator& op : all_operators()) {
        if (op.id == id) return op;
    }
    const auto ids = names_of(all_operators(), [](const Operator& op) { return op.id; });
    const std::string nearest = did_you_mean(id, ids);
    throw Error("operator is " + std::string(id) + "; expected one of `tonewright list`" + nearest);
}

ResolvedOperator resolve_operator(std::string_view name, const Settings& settings,
                                  std::string_view look) {
    const std::size_t colon = name.find(':');
    const Operator& op = find_operator(name.substr(0, colon));
    ResolvedOperator resolved{&op, {}, op.id};

    Settings merged;
    if (colon != std::string_view::npos) {
        const std::string_view wanted = name.substr(colon + 1);
        const Preset* found = nullptr;
        for (const Preset& preset : op.presets) {
            if (preset.id == wanted) found = &preset;
        }
        if (!found) {
            const auto ids = names_of(op.presets, [](const Preset& p) { return p.id; });
            throw Error(op.id + ": preset is " + std::string(wanted) + "; expected " +
                        (ids.empty() ? "none, it has no presets" : join_choices(ids)) +
                        did_you_mean(wanted, ids));
        }
        merged = found->settings;
        resolved.label += ":" + found->id;
    }
    for (const auto& [key, text] : settings)
        merged[key] = text;

    for (const auto& [key, text] : merged) {
        const ParameterSpec* spec = nullptr;
        for (const ParameterSpec& p : op.parameters) {
            if (p.name == key) spec = &p;
        }
        if (!spec) {
            const auto ids = names_of(op.parameters, [](const ParameterSpec& p) { return p.name; });
            throw Error(op.id + ": parameter is " + key + "; expected " +
                        (ids.empty() ? "none, it has no parameters" : join_choices(ids)) +
                        did_you_mean(key, ids));
        }
        if (spec->choices.empty()) {
            resolved.params.numbers_[key] = parse_number(op, *spec, text);
        } else {
            bool known = false;
            for (const std::string& choice : spec->choices)
                known = known || choice == text;
            if (!known) {
                throw Error(op.id + ": " + key + " is " + text + "; expected " +
                            join_choices(spec->choices) + did_you_mean(text, spec->choices));
            }
            resolved.params.choices_[key] = text;
        }
        const bool is_default = spec->choices.empty()
                                    ? resolved.params.numbers_[key] == spec->default_value
                                    : text == spec->default_choice;
        if (settings.contains(key) && !is_default) resolved.label += " " + key + "=" + text;
    }
    for (const ParameterSpec& spec : op.parameters) {
        if (spec.choices.empty()) {
            resolved.params.numbers_.try_emplace(spec.name, spec.default_value);
        } else {
            resolved.params.choices_.try_emplace(spec.name, spec.default_choice);
        }
    }

    if (!look.empty()) {
        const auto ids = names_of(op.looks, [](const Look& l) { return l.id; });
        bool known = false;
        for (const std::string& id : ids)
            known = known || id == look;
        if (!known) {
            throw Error(op.id + ": look is " + std::string(look) + "; expected " +
                        (ids.empty() ? "none, it has no looks" : join_choices(ids)) +
                        did_you_mean(look, ids));
        }
        resolved.params.look_ = std::string(look);
        resolved.label += " look=" + std::string(look);
    }
    // Parameters that are each in range can still contradict each other: the operator says so here,
    // not in the middle of a picture.
    (void)op.build(resolved.params);
    return resolved;
}

}  // namespace tonewright
