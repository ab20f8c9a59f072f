// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/generated_files.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// An operator as a section of a Markdown page: what it is like, facts, parameters, presets, looks.
/// @param after_character  lines to put under the sentence about its character.
[[nodiscard]] std::string operator_section(const Operator& op,
                                           std::string_view after_character = {});

/// The operator catalogue: `operators.md`, and in `curves/` a plot of every operator and of every
/// group of dialects, with a MANIFEST.csv. The same bytes on every run.
[[nodiscard]] std::vector<GeneratedFile> make_catalogue();

/// Writes it, and removes the plots in `folder`/curves that an earlier one had and it has not.
/// @throws FileError
void write_catalogue(const std::string& folder);

TONEWRIGHT_NAMESPACE_END
