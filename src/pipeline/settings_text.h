// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// All settings and the look, for headers of files: "exposure_bias 2, white 11.2, look punchy".
/// @param left_out  parameters that it does not name
[[nodiscard]] TONEWRIGHT_API std::string settings_text(
    const ResolvedOperator& op, const std::vector<std::string>& left_out = {});

TONEWRIGHT_NAMESPACE_END
