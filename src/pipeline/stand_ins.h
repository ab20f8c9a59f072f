// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The constants that stand in for numbers that `apply` takes from the picture: "maximum 100 for
/// the maximum luminance of the picture". Empty: the operator measures nothing.
/// @param arguments  parameters that get their values later
[[nodiscard]] TONEWRIGHT_API std::string stand_ins(const ResolvedOperator& op,
                                                   const std::vector<std::string>& arguments = {});
/// Says so of a `form` ("LUT") of the operator, in one line. Empty: nothing stands in.
[[nodiscard]] TONEWRIGHT_API std::string stand_in_warning(
    const ResolvedOperator& op, std::string_view form,
    const std::vector<std::string>& arguments = {});

TONEWRIGHT_NAMESPACE_END
