// SPDX-License-Identifier: Apache-2.0
#include "tonewright/registry.h"

#include <algorithm>

#include "base/strings.h"
#include "local/operators.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct OperatorText {
    std::string name;
    Settings settings;
    std::string look;
};

OperatorText split_operator_text(std::string_view text) {
    OperatorText parts;
    auto& [name, settings, look] = parts;
    std::size_t begin = 0;
    while (begin <= text.size()) {
        const std::size_t end = std::min(text.find(':', begin), text.size());
        const std::string part(text.substr(begin, end - begin));
        const std::size_t equals = part.find('=');
        if (equals == std::string::npos) {
            name += (name.empty() ? "" : ":") + part;
        } else if (part.substr(0, equals) == "look") {
            look = part.substr(equals + 1);
        } else {
            settings[part.substr(0, equals)] = part.substr(equals + 1);
        }
        begin = end + 1;
    }
    return parts;
}

ResolvedOperator resolve_by_name(const Operator& op, std::string_view name,
                                 const Settings& settings, std::string_view look) {
    const std::size_t colon = name.find(':');
    const Preset* preset =
        colon == std::string_view::npos ? nullptr : &find_preset(op, name.substr(colon + 1));
    return resolve(op, preset, settings, look);
}

std::string_view id_of(std::string_view name) { return name.substr(0, name.find(':')); }

}  // namespace

const std::vector<Operator>& local_operators() {
    static const std::vector<Operator> all = {define_exposure_fusion(), define_local_laplacian(),
                                              define_reinhard_local()};
    return all;
}

const Operator& find_picture_operator(std::string_view id) {
    std::vector<std::string> ids;
    for (const std::vector<Operator>* operators : {&all_operators(), &local_operators()}) {
        for (const Operator& op : *operators) {
            if (op.id == id) return op;
            ids.push_back(op.id);
        }
    }
    const std::string nearest = did_you_mean(id, ids);
    throw Error("operator is " + std::string(id) + "; expected one of `tonewright list`" + nearest);
}

const Operator& find_operator(std::string_view id) {
    const Operator& op = find_picture_operator(id);
    if (op.is_local()) {
        throw Error("operator is " + op.id +
                    ", which looks at a pixel's surroundings: no LUT, config or color by itself "
                    "holds it; expected an operator that `tonewright list` does not mark as local, "
                    "or `tonewright apply` with a picture");
    }
    return op;
}

ResolvedOperator resolve_operator(std::string_view name, const Settings& settings,
                                  std::string_view look) {
    return resolve_by_name(find_operator(id_of(name)), name, settings, look);
}

ResolvedOperator resolve_picture_operator(std::string_view name, const Settings& settings,
                                          std::string_view look) {
    return resolve_by_name(find_picture_operator(id_of(name)), name, settings, look);
}

ResolvedOperator parse_operator(std::string_view text) {
    const OperatorText parts = split_operator_text(text);
    return resolve_operator(parts.name, parts.settings, parts.look);
}

ResolvedOperator parse_picture_operator(std::string_view text) {
    const OperatorText parts = split_operator_text(text);
    return resolve_picture_operator(parts.name, parts.settings, parts.look);
}

std::string operator_text(const ResolvedOperator& op) {
    std::string text = op.label;
    std::replace(text.begin(), text.end(), ' ', ':');
    return text;
}

std::vector<std::string> invertible_operators() {
    std::vector<std::string> ids;
    for (const Operator& op : all_operators()) {
        if (op.build_inverse) ids.push_back(op.id);
    }
    return ids;
}

std::vector<OperatorVariant> all_variants() {
    std::vector<OperatorVariant> all;
    for (const Operator& op : all_operators()) {
        all.push_back({op.id, ""});
        for (const Preset& preset : op.presets)
            all.push_back({op.id + ":" + preset.id, ""});
        for (const Look& look : op.looks)
            all.push_back({op.id, look.id});
    }
    return all;
}

TONEWRIGHT_NAMESPACE_END
