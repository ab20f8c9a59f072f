// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "formula/glsl.h"
#include "formula/glsl_value.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace glsl {

/// If a and b are a matrix of numbers and a color, adds their product unless it is there, and makes
/// `value` read inputs of its own instead.
void make_product(std::vector<GlslProduct>& products, GlslValue& value, const GlslValue& a,
                  const GlslValue& b);

}  // namespace glsl
TONEWRIGHT_NAMESPACE_END
