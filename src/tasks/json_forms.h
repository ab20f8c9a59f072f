// SPDX-License-Identifier: Apache-2.0
//
// Facts as JSON objects, for the command, the report's page and the Python module.
#pragma once

#include <string>
#include <vector>

#include "measure/laws.h"
#include "tasks/json.h"
#include "tonewright/error.h"
#include "tonewright/lint.h"
#include "tonewright/lut_applications.h"
#include "tonewright/lut_match.h"
#include "tonewright/pipeline.h"
#include "tonewright/source_color.h"
#include "tonewright/verify.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// "display-linear", "code values of sRGB", "code values, power 2.2".
[[nodiscard]] std::string output_of(const Operator& op);
/// The operator's own warnings, and those from its deviations.
[[nodiscard]] std::vector<std::string> all_warnings(const Operator& op);
/// "error", "warning", "note"
[[nodiscard]] const char* level_name(LintFinding::Level level);

[[nodiscard]] Json to_json(const Operator& op);
[[nodiscard]] Json to_json(const Display& display);
[[nodiscard]] Json to_json(const SourceColorName& name);
/// @param style  of the parameters that its steps name
[[nodiscard]] Json to_json(const LutApplication& host, const MessageStyle& style);
[[nodiscard]] Json to_json(const ParityRow& row);
[[nodiscard]] Json to_json(const LutMatch& match);
[[nodiscard]] Json to_json(const LintFinding& finding);
[[nodiscard]] Json to_json(const LawResult& result);

/// An array of such objects.
template <class Values, class... Style>
[[nodiscard]] Json all_to_json(const Values& values, const Style&... style) {
    Json all = Json::array();
    for (const auto& value : values)
        all.push_back(to_json(value, style...));
    return all;
}

/// All operators, displays, spaces and names of source colors.
[[nodiscard]] Json catalogue_to_json();

TONEWRIGHT_NAMESPACE_END
