// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/image.h"

namespace tonewright {

/// Names of set_tonemap_argument(), without `set.NAME`.
[[nodiscard]] const std::vector<std::string>& tonemap_argument_names();

/// Sets one option of tonemap() by its name, as file names and scripts have them: `op`, `look`,
/// `exposure`, `input`, `display`, `reference_white`, `unpremult` (auto, yes, no), `statistics`
/// (picture, defaults), and `set.NAME`, a parameter of the operator.
/// @throws Error  unknown name, with the nearest; a value that cannot be one of it
void set_tonemap_argument(TonemapOptions& options, std::string_view name, const std::string& value);

}  // namespace tonewright
