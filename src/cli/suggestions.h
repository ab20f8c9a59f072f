// SPDX-License-Identifier: Apache-2.0
//
// Suggestions of a shell for the value of an option.
#pragma once

#include "cli/completion.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Operators, and after `operator:` their presets, parameters and looks. Also files.
[[nodiscard]] Suggestions suggest_operators(const TypedValue& typed);
/// For the operator on the command line, else for all.
[[nodiscard]] Suggestions suggest_looks(const TypedValue& typed);
/// `NAME=` and `NAME=VALUE`, of the operator that the command line names.
[[nodiscard]] Suggestions suggest_settings(const TypedValue& typed);
/// Live parameters of that operator, and the exposure.
[[nodiscard]] Suggestions suggest_uniforms(const TypedValue& typed);
/// With `linear` and `native`.
[[nodiscard]] Suggestions suggest_displays(const TypedValue& typed);
/// Without them.
[[nodiscard]] Suggestions suggest_config_displays(const TypedValue& typed);
[[nodiscard]] Suggestions suggest_spaces(const TypedValue& typed);
/// Names that find_source_color() takes.
[[nodiscard]] Suggestions suggest_input_colors(const TypedValue& typed);
/// Names for --input of pictures: these, and `auto`.
[[nodiscard]] Suggestions suggest_source_colors(const TypedValue& typed);
[[nodiscard]] Suggestions suggest_encodings(const TypedValue& typed);
[[nodiscard]] Suggestions suggest_lut_formats(const TypedValue& typed);
[[nodiscard]] Suggestions suggest_lut_applications(const TypedValue& typed);
[[nodiscard]] Suggestions suggest_languages(const TypedValue& typed);
[[nodiscard]] Suggestions suggest_shader_applications(const TypedValue& typed);
/// Suggestions by the names of the config: `AgX - Punchy`.
[[nodiscard]] Suggestions suggest_view_looks(const TypedValue& typed);
[[nodiscard]] Suggestions suggest_views(const TypedValue& typed);

TONEWRIGHT_NAMESPACE_END
