// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/generated_files.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// An operator as Markdown: character, facts, parameters, presets, looks.
/// @param after_character  lines after the sentence about its character
/// @param is_page          a page of docs/operators/, with a heading of the first level and links
///                         to choosing.md, which explains the parameters that tone curves share
[[nodiscard]] std::string operator_section(const Operator& op,
                                           std::string_view after_character = {},
                                           bool is_page = false);

/// The operator catalogue: the index `operators.md`; in `operators/` a page for each operator and
/// one for the dialects; in `curves/` a plot of every operator and of every group of dialects. Both
/// folders have a MANIFEST.csv. The same bytes on every run.
[[nodiscard]] std::vector<GeneratedFile> make_catalogue();

/// Writes the catalogue, and removes the pages and plots of operators that are gone.
/// @throws FileError
void write_catalogue(const std::string& folder);

TONEWRIGHT_NAMESPACE_END
