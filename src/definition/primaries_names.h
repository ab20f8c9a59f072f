// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "tonewright/color.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Primaries by the name that .tone files have for them.
[[nodiscard]] const std::vector<std::pair<std::string_view, Primaries>>& named_primaries();

TONEWRIGHT_NAMESPACE_END
