// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>

#include "shader/program.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// First-order estimate of the rounding error of a program: the sum over all operations of their
/// largest error times the derivative of the output by their result, with equal signs. The maximum
/// over a sample set; second-order terms and other colors are missing.
struct FirstOrderError {
    double rounded_once = 0;  // each operation by half a unit in the last place
    double vulkan = 0;        // as the Vulkan specification allows it
};

/// Absolute up to 1, relative above.
/// @param outputs  outputs of compose(), after the metric
/// @param of_nodes  errors of the nodes of Grids
[[nodiscard]] FirstOrderError first_order_error(const std::array<Expr, 3>& outputs,
                                                const std::map<const Grid*, double>& of_nodes = {});

TONEWRIGHT_NAMESPACE_END
