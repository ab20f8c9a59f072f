// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/generated_files.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// An operator as a section of a Markdown page: character, facts, parameters, presets, looks.
/// @param after_character  lines after the sentence about its character
/// @param is_in_docs       the page is beside choosing.md, which explains the parameters that all
///                         tone curves share
[[nodiscard]] std::string operator_section(const Operator& op,
                                           std::string_view after_character = {},
                                           bool is_in_docs = false);

/// The operator catalogue: `operators.md`, and in `curves/` a plot of every operator and of every
/// group of dialects, with a MANIFEST.csv. The same bytes on every run.
[[nodiscard]] std::vector<GeneratedFile> make_catalogue();

/// Writes the page, and removes plots in `folder`/curves that are no longer used.
/// @throws FileError
void write_catalogue(const std::string& folder);

TONEWRIGHT_NAMESPACE_END
