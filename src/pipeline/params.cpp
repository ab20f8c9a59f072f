// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/format_number.h"
#include "base/strings.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN
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

ParameterSpec text_parameter(std::string name, std::string help) {
    ParameterSpec spec;
    spec.kind = ParameterSpec::Kind::text;
    spec.name = std::move(name);
    spec.help = std::move(help);
    return spec;
}

ParameterSpec statistic_parameter(ParameterSpec number, std::string statistic,
                                  double (*from_picture)(const SceneStatistics&)) {
    number.statistic = std::move(statistic);
    number.from_picture = from_picture;
    return number;
}

ParameterSpec display_parameter(ParameterSpec spec,
                                std::string (*from_display)(const DisplayFacts&)) {
    spec.from_display = from_display;
    return spec;
}

ParameterSpec choice_parameter(std::string name, std::vector<std::string> choices,
                               std::string value, std::string help) {
    ParameterSpec spec;
    spec.kind = ParameterSpec::Kind::choice;
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

const std::string& Params::text(std::string_view name) const {
    const auto it = texts_.find(name);
    if (it == texts_.end()) throw Error("operator has no text parameter " + std::string(name));
    return it->second;
}

const Preset& find_preset(const Operator& op, std::string_view id) {
    for (const Preset& preset : op.presets) {
        if (preset.id == id) return preset;
    }
    const auto ids = names_of(op.presets, [](const Preset& p) { return p.id; });
    throw Error(op.id + ": preset is " + std::string(id) + "; expected " +
                (ids.empty() ? "none, it has no presets" : join_choices(ids)) +
                did_you_mean(id, ids));
}

Settings settings_for_picture(const ResolvedOperator& resolved, const SceneStatistics& statistics) {
    const Preset* preset = resolved.preset;
    Settings all = resolved.settings;
    for (const ParameterSpec& spec : resolved.op->parameters) {
        if (!spec.from_picture || (preset && preset->settings.contains(spec.name))) continue;
        const double value = spec.from_picture(statistics);
        all.try_emplace(spec.name, shortest(std::clamp(value, spec.min, spec.max)));
    }
    return all;
}

ResolvedOperator resolve_for_display(const ResolvedOperator& resolved,
                                     const DisplayFacts& display) {
    const Preset* preset = resolved.preset;
    Settings all = resolved.settings;
    for (const ParameterSpec& spec : resolved.op->parameters) {
        if (!spec.from_display || (preset && preset->settings.contains(spec.name))) continue;
        const std::string decided = spec.from_display(display);
        if (!decided.empty()) all.try_emplace(spec.name, decided);
    }
    ResolvedOperator shown = resolve(*resolved.op, preset, all, resolved.params.look());
    shown.label = resolved.label;
    shown.settings = resolved.settings;
    return shown;
}

ResolvedOperator resolve(const Operator& op, const Preset* preset, const Settings& settings,
                         std::string_view look) {
    using Kind = ParameterSpec::Kind;
    ResolvedOperator resolved{&op, {}, op.id, preset, settings};

    Settings merged;
    if (preset) {
        merged = preset->settings;
        resolved.label += ":" + preset->id;
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
        bool is_default = text == spec->default_choice;
        if (spec->kind == Kind::number) {
            const double value = parse_number(op, *spec, text);
            resolved.params.numbers_[key] = value;
            is_default = value == spec->default_value;
        } else if (spec->kind == Kind::text) {
            resolved.params.texts_[key] = text;
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
        if (settings.contains(key) && !is_default) resolved.label += " " + key + "=" + text;
    }
    for (const ParameterSpec& spec : op.parameters) {
        switch (spec.kind) {
            case Kind::number:
                resolved.params.numbers_.try_emplace(spec.name, spec.default_value);
                break;
            case Kind::choice:
                resolved.params.choices_.try_emplace(spec.name, spec.default_choice);
                break;
            case Kind::text:
                resolved.params.texts_.try_emplace(spec.name, spec.default_choice);
                break;
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
    try {
        (void)op.build(resolved.params);
    } catch (const FileError&) {
        throw;
    } catch (const Error& e) {
        throw Error(op.id + ": " + e.what());
    }
    return resolved;
}

TONEWRIGHT_NAMESPACE_END
