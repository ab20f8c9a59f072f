// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// An operator as Markdown: character, facts, parameters, presets, looks.
/// @param after_character  lines after the sentence about its character
/// @param is_page          a page of docs/operators/, with a heading of the first level and links
///                         to choosing.md, which explains the parameters that tone curves share
[[nodiscard]] std::string operator_section(const Operator& op,
                                           std::string_view after_character = {},
                                           bool is_page = false);

TONEWRIGHT_NAMESPACE_END
