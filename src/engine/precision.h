// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/tape.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Which values of a program are to be kept in double, so that the outputs keep to an error
/// (absolute up to 1, relative above) when all others are float.
///
/// A matrix with negative coefficients takes the difference of nearly equal numbers and the sRGB
/// curve multiplies what is left by 12.92, so a rounding of 6e-8 may become 3e-6 of the picture;
/// most other roundings are harmless. Which is which is not a matter of the operation but of what
/// follows. So it is computed: over a set of probe colors, the derivative of each output by each
/// value (reverse accumulation) times the value's rounding error is what that rounding adds to the
/// output. While the root of the sum of squares is above a quarter of the error (roundings are
/// independent; the rest is for colors between the probes), the value that adds most for its cost
/// becomes double. The rows of matrices with negative coefficients, or of inputs, are double in any
/// case, and so is what steep tables are indexed with. Compiled curves are as exact as they are:
/// those that leave no such set are named.
struct Precision {
    std::vector<bool> in_double;
    std::vector<const CompiledCurve*> too_coarse;
};
/// @param settings  of the uniforms, beside their typical values: values by TapeInstruction::source
[[nodiscard]] Precision choose_precision(const std::vector<TapeInstruction>& code,
                                         const std::array<std::uint32_t, 3>& outputs,
                                         double max_error,
                                         const std::vector<std::vector<double>>& settings = {});

/// What values are, and how much of their errors reaches an output: the largest derivative of an
/// output by each value, relative to outputs above 1; 1e12 where it has no end.
/// [probe][index], over a set of probe colors, with each setting of the uniforms.
struct Sensitivity {
    std::vector<std::vector<double>> value;
    std::vector<std::vector<double>> sensitivity;
};
/// @param settings  as for choose_precision()
[[nodiscard]] Sensitivity measure_influence(const std::vector<TapeInstruction>& code,
                                            const std::array<std::uint32_t, 3>& outputs,
                                            const std::vector<std::vector<double>>& settings = {});

TONEWRIGHT_NAMESPACE_END
