// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ocio/lowered_op.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// OpenColorIO's fixed functions that a channel-mixing stage equals, one behind the other.
struct FixedFunctions {
    CrossTalkStage stage;
    std::vector<FixedFunctionOp> functions;
    /// False where the functions differ from the stage a little.
    bool is_exact = true;
};

[[nodiscard]] const std::vector<FixedFunctions>& all_fixed_functions();

/// Those of the stage that has the same expressions; null where there is none.
[[nodiscard]] const FixedFunctions* find_fixed_functions(const CrossTalkStage& stage);

TONEWRIGHT_NAMESPACE_END
