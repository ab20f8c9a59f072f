// SPDX-License-Identifier: Apache-2.0
//
// Facts about operators and applications as text, for lists and documents.
#pragma once

#include <string>
#include <string_view>

#include "tonewright/lut_applications.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// "[0.1, 100]" with the unit, or the choices.
[[nodiscard]] std::string range_of(const ParameterSpec& p);
[[nodiscard]] std::string default_of(const ParameterSpec& p);
/// Its help, and what else sets it. May refer to parameters. @see render
[[nodiscard]] std::string help_of(const ParameterSpec& p);
/// "AgX; others: agx_minimal, agx_sobotka".
[[nodiscard]] std::string dialects_of(const Operator& op);

inline constexpr const char* kDiagnostic = "shows facts about a picture, such as its exposure";
inline constexpr const char* kLocal = "pictures only; LUTs and configs cannot contain it";

/// An operator as Markdown: character, facts, parameters, presets, looks. May refer to parameters.
/// @see render
/// @param after_character  lines after the sentence about its character
/// @param is_page          a page of docs/operators/, with a heading of the first level and links
/// to choosing.md, which explains the parameters that tone curves share
[[nodiscard]] std::string operator_section(const Operator& op,
                                           std::string_view after_character = {},
                                           bool is_page = false);

/// The LUT that an application expects, and how to load it: lines of text.
/// @param style  of the parameters that its steps name
[[nodiscard]] std::string application_facts(const LutApplication& host, const MessageStyle& style);

TONEWRIGHT_NAMESPACE_END
