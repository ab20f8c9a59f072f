// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shader/program.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The program with the engine's verified polynomials instead of formulas of one number, where they
/// take fewer instructions of a GPU. What is done to each channel alone, one step after another, is
/// one curve then. Formulas that read uniforms stay.
[[nodiscard]] ShaderProgram with_fitted_curves(const ShaderProgram& program);

/// Instructions of a GPU, roughly: those that take four cycles count as four.
[[nodiscard]] int shader_cost(const Expr& f);

TONEWRIGHT_NAMESPACE_END
