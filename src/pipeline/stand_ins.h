// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Constants instead of the statistics that `apply` measures: "maximum 100 for the maximum
/// luminance". Empty if the operator measures nothing.
/// @param arguments  parameters that are set later
[[nodiscard]] TONEWRIGHT_API std::string stand_ins(const ResolvedOperator& op,
                                                   const std::vector<std::string>& arguments = {});
/// One-line warning about them for a representation (`form`, such as "LUT") of the operator. Empty
/// if there are none.
[[nodiscard]] TONEWRIGHT_API std::string stand_in_warning(
    const ResolvedOperator& op, std::string_view form,
    const std::vector<std::string>& arguments = {});

TONEWRIGHT_NAMESPACE_END
