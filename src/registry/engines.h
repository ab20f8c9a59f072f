// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tonewright/engines.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// "Babylon.js with Standard, ACES or ..." for a text that begins with the name of a program; else
/// empty.
[[nodiscard]] std::string tone_mappers_of_program(std::string_view name);

TONEWRIGHT_NAMESPACE_END
