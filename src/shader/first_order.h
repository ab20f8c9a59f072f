// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shader/program.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// What the roundings of a program add up to, to first order: of each operation the error that it
/// may have, times the derivative of the output by its result, all of one sign; the largest over a
/// set of probe colors. An estimate: terms of second order and colors between the probes are
/// missing.
struct FirstOrderError {
    double rounded_once = 0;  // each operation by half a unit in the last place
    double vulkan = 0;        // as the Vulkan specification allows it
};

/// Absolute up to 1, relative above.
/// @param outputs  what compose() gives, and what is done with it
[[nodiscard]] FirstOrderError first_order_error(const std::array<Expr, 3>& outputs);

TONEWRIGHT_NAMESPACE_END
