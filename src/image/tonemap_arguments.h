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

/// Options of tonemap() as file names and scripts give them: the operator is text.
struct TonemapArguments {
    /// @see resolve_picture_operator
    std::string op = {};
    Settings settings = {};
    std::string look = {};
    /// All others. Its operator is empty.
    TonemapOptions others = {};
};
/// The options, with the operator resolved. This reads the operator's file.
/// @throws Error  @see resolve_picture_operator
[[nodiscard]] TONEWRIGHT_API TonemapOptions resolve_arguments(const TonemapArguments& arguments,
                                                              const OperatorSet& operators);

/// Sets one option of tonemap() by its name, as in file names and scripts: `op`, `look`,
/// `exposure`, `input`, `display`, `reference_white`, `unpremult` (auto, yes, no), `statistics`
/// (picture, defaults), and `set.NAME`, a parameter of the operator.
/// @throws Error  unknown name, with the nearest one; a value that the option does not accept
TONEWRIGHT_API void set_tonemap_argument(TonemapArguments& arguments, std::string_view name,
                                         const std::string& value);

TONEWRIGHT_NAMESPACE_END
