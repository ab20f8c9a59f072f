// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shader/program.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The program with the engine's verified polynomials instead of formulas of one number, if they
/// take fewer GPU instructions. Consecutive per-channel steps become one curve. Formulas that read
/// uniforms stay.
[[nodiscard]] ShaderProgram with_fitted_curves(const ShaderProgram& program);

/// Estimated GPU instructions; those with four cycles count as four.
[[nodiscard]] int shader_cost(const Expr& f);

TONEWRIGHT_NAMESPACE_END
