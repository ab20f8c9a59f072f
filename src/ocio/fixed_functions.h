// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ocio/lowered_op.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// OpenColorIO's fixed functions that a channel-mixing stage equals, one behind the other.
struct FixedFunctions {
    CrossTalkStage stage;
    std::vector<FixedFunctionOp> functions;
    /// False where the functions differ from the stage a little.
    bool is_exact = true;
    /// Light -> the space that the functions work in; its inverse stands behind them.
    Matrix3 to_space = kIdentity3;
};

[[nodiscard]] const std::vector<FixedFunctions>& all_fixed_functions();

/// Those of the stage that has the same expressions; null where there is none.
[[nodiscard]] const FixedFunctions* find_fixed_functions(const CrossTalkStage& stage);

/// The fixed function that a tone scale of colors without negative channels equals, with a gain
/// before and behind it: f(n) = c n max(n, floor)^(gamma - 1), of the weights that the function
/// has. OpenColorIO computes it with the precision of floats in every build. Nothing where there is
/// none.
[[nodiscard]] TONEWRIGHT_API std::optional<LoweredOps> find_fixed_function(
    const ToneScaleStage& stage);

TONEWRIGHT_NAMESPACE_END
