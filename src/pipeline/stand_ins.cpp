// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stand_ins.h"

#include <algorithm>

#include "base/format_number.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::string stand_ins(const ResolvedOperator& op, const std::vector<std::string>& arguments) {
    std::string constants;
    for (const ParameterSpec& parameter : op.op->parameters) {
        const bool is_set =
            op.settings.contains(parameter.name) ||
            (op.preset != nullptr && op.preset->settings.contains(parameter.name)) ||
            std::find(arguments.begin(), arguments.end(), parameter.name) != arguments.end();
        if (!parameter.from_picture || is_set) continue;
        constants += (constants.empty() ? "" : ", ") + parameter.name + " " +
                     shortest(op.params.number(parameter.name)) + " for the " + parameter.statistic;
    }
    return constants;
}

std::string stand_in_warning(const ResolvedOperator& op, std::string_view form,
                             const std::vector<std::string>& arguments) {
    const std::string constants = stand_ins(op, arguments);
    if (constants.empty()) return {};
    const std::string thing(form);
    return op.label + " measures each picture, which a " + thing + " cannot do; the " + thing +
           " uses " + constants + " (<<settings=" + constants.substr(0, constants.find(' ')) +
           ">> changes it)";
}

TONEWRIGHT_NAMESPACE_END
