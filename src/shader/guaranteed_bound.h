// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shader/program.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// How far a program's result may be from what its formulas say, with the errors that the Vulkan
/// specification allows each operation; for all colors whose channels lie from 0 to kHalfMax.
struct GuaranteedBound {
    /// Absolute up to 1, relative above; infinite where none was found that is useful.
    double error = 0;
    /// The function of the program in which most of it arises, at the worst place.
    std::string arises_in;
};

/// By interval arithmetic with running errors over a domain that is halved where the bound is
/// largest.
/// @pre no uniform is left in the program
/// @param metric  of each channel of the result, without error: what the bound is of
/// @param useful  how large it may be
[[nodiscard]] GuaranteedBound guaranteed_bound(const ShaderProgram& program, const Expr& metric,
                                               double useful);

TONEWRIGHT_NAMESPACE_END
