// SPDX-License-Identifier: Apache-2.0
//
// The tone mappers of other programs as lists, and names that mean several of them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tasks/json.h"
#include "tonewright/engines.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The meanings of a name that have an operator, and how far these are apart.
struct MeaningTable {
    std::string name;
    std::vector<NameMeaning> meanings;
    /// Mean difference of sRGB code values in 8-bit steps, over grays and 12 hues from -6 to 6
    /// stops about 0.18: one row for each meaning.
    std::vector<std::vector<double>> distances;
};
[[nodiscard]] MeaningTable meaning_table(std::string_view name);
/// A line for each meaning, with its distances from the others in columns.
[[nodiscard]] std::string to_text(const MeaningTable& table);
[[nodiscard]] Json to_json(const MeaningTable& table);
/// The tables of ambiguous_names().
[[nodiscard]] std::vector<MeaningTable> meaning_tables();

[[nodiscard]] Json to_json(const EngineToneMapper& row);
/// engine_tone_mappers() for a terminal, at most 120 columns, grouped by program.
[[nodiscard]] std::string engines_as_text();
/// The same, and meaning_tables(), as tables of Markdown.
[[nodiscard]] std::string engines_as_markdown();

TONEWRIGHT_NAMESPACE_END
