// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Names of set_tonemap_argument(), without `set.NAME`.
[[nodiscard]] TONEWRIGHT_API const std::vector<std::string>& tonemap_argument_names();

/// True if set_tonemap_argument() accepts the name.
[[nodiscard]] TONEWRIGHT_API bool is_tonemap_argument(std::string_view name);
/// All names, for a message: `op, look, ... or set.NAME for a parameter of the operator`.
[[nodiscard]] TONEWRIGHT_API std::string tonemap_argument_choices();

/// Sets one option of tonemap() by its name, as in file names and scripts: `op`, `look`,
/// `exposure`, `input`, `display`, `reference_white`, `unpremult` (auto, yes, no), `statistics`
/// (picture, defaults), and `set.NAME`, a parameter of the operator.
/// @throws Error  unknown name, with the nearest one; a value that the option does not accept
TONEWRIGHT_API void set_tonemap_argument(TonemapOptions& options, std::string_view name,
                                         const std::string& value);

TONEWRIGHT_NAMESPACE_END
