// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shader/program.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Largest difference of a program's result from its exact formulas, with the errors that the
/// Vulkan specification allows each operation, for all colors with channels from 0 to kHalfMax.
struct GuaranteedBound {
    /// Absolute up to 1, relative above; infinite if there is no useful bound.
    double error = 0;
    /// Function of the program with the largest part of the error, at the worst position.
    std::string arises_in;
};

/// Uses interval arithmetic with running errors, and halves the domain where the bound is largest.
/// @pre the program has no uniforms
/// @param metric  error-free function of each channel of the result, to which the bound applies
/// @param useful  largest useful bound
[[nodiscard]] GuaranteedBound guaranteed_bound(const ShaderProgram& program, const Expr& metric,
                                               double useful);

TONEWRIGHT_NAMESPACE_END
