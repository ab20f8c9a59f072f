// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Names of set_tonemap_argument(), without `set.NAME`.
[[nodiscard]] TONEWRIGHT_API const std::vector<std::string>& tonemap_argument_names();

/// Sets one option of tonemap() by its name, as file names and scripts have them: `op`, `look`,
/// `exposure`, `input`, `display`, `reference_white`, `unpremult` (auto, yes, no), `statistics`
/// (picture, defaults), and `set.NAME`, a parameter of the operator.
/// @throws Error  unknown name, with the nearest; a value that cannot be one of it
TONEWRIGHT_API void set_tonemap_argument(TonemapOptions& options, std::string_view name,
                                         const std::string& value);

TONEWRIGHT_NAMESPACE_END
