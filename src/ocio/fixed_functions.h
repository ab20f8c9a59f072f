// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ocio/lowered_op.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Chain of OpenColorIO's fixed functions that equals a channel-mixing stage.
struct FixedFunctions {
    CrossTalkStage stage;
    std::vector<FixedFunctionOp> functions;
    /// False if the functions differ slightly from the stage.
    bool is_exact = true;
    /// Working space -> space of the functions; its inverse follows them.
    Matrix3 to_space = kIdentity3;
};

[[nodiscard]] const std::vector<FixedFunctions>& all_fixed_functions();

/// Fixed functions of the stage with the same expressions; null if there are none.
[[nodiscard]] const FixedFunctions* find_fixed_functions(const CrossTalkStage& stage);

/// Fixed function, with a gain before and after it, that equals a tone scale for colors without
/// negative channels: f(n) = c n max(n, floor)^(gamma - 1), with the weights of the function.
/// OpenColorIO computes it in float precision in every build. Nothing if there is none.
[[nodiscard]] TONEWRIGHT_API std::optional<LoweredOps> find_fixed_function(
    const ToneScaleStage& stage);

TONEWRIGHT_NAMESPACE_END
