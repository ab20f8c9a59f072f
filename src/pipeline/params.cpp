// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/format_number.h"
#include "base/strings.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Expected names for an error message.
std::string one_of(const Operator& op, const char* what, const std::vector<std::string>& names) {
    return names.empty() ? "none: " + op.id + " has no " + what : join_choices(names);
}

template <class Items, class Name>
std::vector<std::string> names_of(const Items& items, Name name) {
    std::vector<std::string> names;
    names.reserve(std::size(items));
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

/// @throws Error  that suggests the nearest name
const ParameterSpec& find_parameter(const Operator& op, std::string_view name) {
    for (const ParameterSpec& spec : op.parameters) {
        if (is_same_name(spec.name, name)) return spec;
    }
    const auto ids = names_of(op.parameters, [](const ParameterSpec& p) { return p.name; });
    throw Error(op.id + ": parameter is " + std::string(name) + "; expected " +
                one_of(op, "parameters", ids) + did_you_mean(name, ids));
}

/// Settings with the names and choices spelled like the parameters.
/// @throws Error  for an unknown parameter or choice, and for one parameter with two values
Settings in_own_words(const Operator& op, const Settings& settings) {
    Settings result;
    for (const auto& [key, text] : settings) {
        const ParameterSpec& spec = find_parameter(op, key);
        std::string value = text;
        if (spec.kind == ParameterSpec::Kind::choice)
            value = spec.choices[find_choice(spec.name, text, spec.choices, op.id)];
        const auto [known, is_new] = result.emplace(spec.name, value);
        if (!is_new && known->second != value) {
            throw Error(op.id + ": " + spec.name + " is " + known->second + " and " + value +
                        "; expected it once");
        }
    }
    return result;
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

std::vector<ParameterSpec> fixed_parameters(std::vector<ParameterSpec> specs) {
    for (ParameterSpec& spec : specs)
        spec.is_live = false;
    return specs;
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
    if (live_.contains(name)) throw Error("parameter " + std::string(name) + " is live");
    return it->second;
}

Expr Params::expr(std::string_view name) const {
    if (live_.contains(name)) return Expr::uniform(std::string(name));
    return number(name);
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

std::vector<std::string> live_parameters(const Operator& op) {
    std::vector<std::string> names;
    if (op.is_local()) return names;
    for (const ParameterSpec& spec : op.parameters) {
        if (spec.kind == ParameterSpec::Kind::number && spec.is_live) names.push_back(spec.name);
    }
    return names;
}

Pipeline build_live(const ResolvedOperator& resolved, const std::vector<std::string>& uniforms) {
    const Operator& op = *resolved.op;
    const std::vector<std::string> live = live_parameters(op);
    Params params = resolved.params;
    for (const std::string& name : uniforms) {
        const std::string& own = find_parameter(op, name).name;
        if (std::find(live.begin(), live.end(), own) == live.end()) {
            throw Error(op.id + ": uniform is " + own + "; expected " +
                        (live.empty() ? "none, no parameter of it is live" : join_choices(live)));
        }
        params.live_.insert(own);
    }
    return op.build(params);
}

const Preset& find_preset(const Operator& op, std::string_view id) {
    for (const Preset& preset : op.presets) {
        if (is_same_name(preset.id, id)) return preset;
    }
    const auto ids = names_of(op.presets, [](const Preset& p) { return p.id; });
    for (const Look& look : op.looks) {
        if (!is_same_name(look.id, id)) continue;
        throw Error(op.id + ": preset is " + std::string(id) + "; expected " +
                    one_of(op, "presets", ids) + "; did you mean look=" + look.id + "?");
    }
    throw Error(op.id + ": preset is " + std::string(id) + "; expected " +
                one_of(op, "presets", ids) + did_you_mean(id, ids));
}

/// True if the user or the preset set the parameter.
static bool is_set(const ResolvedOperator& resolved, const ParameterSpec& spec) {
    return resolved.settings.contains(spec.name) ||
           (resolved.preset && resolved.preset->settings.contains(spec.name));
}

bool takes_statistics(const ResolvedOperator& resolved) {
    const std::vector<ParameterSpec>& all = resolved.op->parameters;
    return std::any_of(all.begin(), all.end(), [&](const ParameterSpec& spec) {
        return spec.from_picture && !is_set(resolved, spec);
    });
}

ResolvedOperator resolve_for_picture(const ResolvedOperator& resolved,
                                     const SceneStatistics& statistics) {
    Settings all = resolved.settings;
    for (const ParameterSpec& spec : resolved.op->parameters) {
        if (!spec.from_picture || is_set(resolved, spec)) continue;
        const double value = spec.from_picture(statistics);
        all[spec.name] = shortest(std::clamp(value, spec.min, spec.max));
    }
    ResolvedOperator result = resolve(*resolved.op, resolved.preset, all, resolved.params.look());
    result.owner = resolved.owner;
    return result;
}

ResolvedOperator resolve_for_display(const ResolvedOperator& resolved,
                                     const DisplayFacts& display) {
    Settings all = resolved.settings;
    for (const ParameterSpec& spec : resolved.op->parameters) {
        if (!spec.from_display || is_set(resolved, spec)) continue;
        const std::string decided = spec.from_display(display);
        if (!decided.empty()) all[spec.name] = decided;
    }
    ResolvedOperator shown = resolve(*resolved.op, resolved.preset, all, resolved.params.look());
    shown.label = resolved.label;
    shown.settings = resolved.settings;
    shown.owner = resolved.owner;
    return shown;
}

ResolvedOperator resolve(const Operator& op, const Preset* preset, const Settings& settings,
                         std::string_view look) {
    using Kind = ParameterSpec::Kind;
    ResolvedOperator resolved{&op, {}, op.id, preset, settings, {}};

    resolved.settings = in_own_words(op, settings);
    Settings merged;
    if (preset) {
        merged = preset->settings;
        resolved.label += ":" + preset->id;
    }
    for (const auto& [key, text] : resolved.settings)
        merged[key] = text;

    for (const auto& [key, text] : merged) {
        const ParameterSpec& spec = find_parameter(op, key);
        // The choices without the setting.
        const bool is_in_preset = preset && preset->settings.contains(key);
        bool is_default = text == (is_in_preset ? preset->settings.at(key) : spec.default_choice);
        if (spec.kind == Kind::number) {
            const double value = parse_number(op, spec, text);
            resolved.params.numbers_[key] = value;
            is_default = value == (is_in_preset ? parse_number(op, spec, preset->settings.at(key))
                                                : spec.default_value);
        } else if (spec.kind == Kind::text) {
            resolved.params.texts_[key] = text;
        } else {
            resolved.params.choices_[key] = text;
        }
        if (resolved.settings.contains(key) && !is_default)
            resolved.label.append(" ").append(key).append("=").append(text);
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
        const auto is_meant = [&](const Look& l) {
            return is_same_name(l.id, look) || is_same_name(l.title, look);
        };
        const auto found = std::find_if(op.looks.begin(), op.looks.end(), is_meant);
        if (found == op.looks.end()) {
            const auto ids = names_of(op.looks, [](const Look& l) { return l.id; });
            throw Error(op.id + ": look is " + std::string(look) + "; expected " +
                        one_of(op, "looks", ids) + did_you_mean(look, ids));
        }
        resolved.params.look_ = found->id;
        resolved.label += " look=" + found->id;
    }
    // Parameters in range can still contradict each other. Build the operator once, so that it
    // reports this here and not in the middle of a picture.
    try {
        (void)op.build(resolved.params);
    } catch (const FileError&) {
        throw;
    } catch (const Error& e) {
        throw Error(within(op.id, e.problem()));
    }
    return resolved;
}

TONEWRIGHT_NAMESPACE_END
