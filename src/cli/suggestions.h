// SPDX-License-Identifier: Apache-2.0
//
// What a shell offers as the value of an option.
#pragma once

#include "cli/completion.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Operators, and behind `operator:` their presets, parameters and looks. Files, too.
[[nodiscard]] Suggestions suggest_operators(const TypedValue& typed);
/// Of the operator that the command line names, else of all.
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
/// What pictures come in: spaces, displays and `auto`.
[[nodiscard]] Suggestions suggest_source_colors(const TypedValue& typed);
[[nodiscard]] Suggestions suggest_encodings(const TypedValue& typed);
[[nodiscard]] Suggestions suggest_lut_formats(const TypedValue& typed);
[[nodiscard]] Suggestions suggest_lut_applications(const TypedValue& typed);
[[nodiscard]] Suggestions suggest_languages(const TypedValue& typed);
[[nodiscard]] Suggestions suggest_shader_applications(const TypedValue& typed);
/// As the config names them: `AgX - Punchy`.
[[nodiscard]] Suggestions suggest_view_looks(const TypedValue& typed);
[[nodiscard]] Suggestions suggest_views(const TypedValue& typed);

TONEWRIGHT_NAMESPACE_END
