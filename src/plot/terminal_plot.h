// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

enum class TerminalText : unsigned char { ascii, utf8 };

/// True if the locale of the environment has UTF-8.
[[nodiscard]] TerminalText terminal_text();

/// A tone curve in text, at most 80 columns and 20 lines, each with its end.
/// @param curve   scene-linear grays -> display code values in [0, 1]
/// @param places  scene-linear values that are marked below the curve
[[nodiscard]] std::string terminal_plot(
    const std::function<std::vector<double>(const std::vector<double>&)>& curve,
    const std::vector<double>& places, TerminalText text);

TONEWRIGHT_NAMESPACE_END
