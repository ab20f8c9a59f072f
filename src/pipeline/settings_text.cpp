// SPDX-License-Identifier: Apache-2.0
#include "pipeline/settings_text.h"

#include <algorithm>

#include "base/format_number.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::string settings_text(const ResolvedOperator& op, const std::vector<std::string>& left_out) {
    std::string text;
    for (const ParameterSpec& spec : op.op->parameters) {
        if (std::find(left_out.begin(), left_out.end(), spec.name) != left_out.end()) continue;
        const std::string value =
            spec.kind == ParameterSpec::Kind::number   ? shortest(op.params.number(spec.name))
            : spec.kind == ParameterSpec::Kind::choice ? op.params.choice(spec.name)
                                                       : op.params.text(spec.name);
        if (!value.empty()) text += (text.empty() ? "" : ", ") + spec.name + " " + value;
    }
    if (!op.params.look().empty())
        text += (text.empty() ? "" : ", ") + ("look " + op.params.look());
    return text;
}

TONEWRIGHT_NAMESPACE_END
