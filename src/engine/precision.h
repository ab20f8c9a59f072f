// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/tape.h"

namespace tonewright {

/// What float evaluation may cost, as absolute error of outputs up to 1 and relative error above:
/// the bound of SimdEngine (1e-6), less the rounding of the output itself and a margin for colours
/// between the probes, of which the worst of random parameters need a third of the bound.
inline constexpr double kFloatErrorBudget = 6e-7;

/// Which values of a program are to be kept in double, so that the outputs keep to the budget when
/// all others are float.
///
/// A matrix with negative coefficients takes the difference of nearly equal numbers and the sRGB
/// curve multiplies what is left by 12.92, so a rounding of 6e-8 may become 3e-6 of the picture;
/// most other roundings are harmless. Which is which is not a matter of the operation but of what
/// follows. So it is computed: over a set of probe colours, the derivative of each output by each
/// value (reverse accumulation) times the value's rounding error is what that rounding adds to the
/// output. While the sum is above the budget, the value that adds most for its cost becomes double.
/// The rows of matrices with negative coefficients are double in any case, and so is what steep
/// tables are indexed with.
[[nodiscard]] std::vector<bool> values_in_double(const std::vector<TapeInstruction>& code,
                                                 const std::array<std::uint32_t, 3>& outputs);

}  // namespace tonewright
