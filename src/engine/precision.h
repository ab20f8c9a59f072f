// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/tape.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Result of choose_precision().
struct Precision {
    std::vector<bool> in_double;
    std::vector<const CompiledCurve*> too_coarse;
};
/// Chooses which values need double so that the outputs stay within max_error (absolute up to 1,
/// relative above) if all others are float.
///
/// A matrix with negative coefficients takes the difference of nearly equal numbers, and the sRGB
/// curve multiplies the result by 12.92, so a rounding of 6e-8 may become 3e-6 of the picture. Most
/// other roundings are harmless. This depends not on an operation but on the operations that follow
/// it, so it is computed. The derivative of each output by each value (reverse accumulation, over a
/// set of probe colors) times the value's rounding error is the error that this rounding adds to
/// the output. While the root of the sum of squares is above a quarter of max_error, the value that
/// adds most for its cost becomes double. (Roundings are independent; the rest of max_error is for
/// colors between the probe colors.) The rows of matrices with negative coefficients, or of inputs,
/// are always double, and so are the indices of steep tables. Curves too coarse for any choice are
/// listed in too_coarse.
/// @param settings  further values of the uniforms beside the typical ones, by
///                  TapeInstruction::source
[[nodiscard]] Precision choose_precision(const std::vector<TapeInstruction>& code,
                                         const std::array<std::uint32_t, 3>& outputs,
                                         double max_error,
                                         const std::vector<std::vector<double>>& settings = {});

/// Each value, and its sensitivity: the largest derivative of an output by the value, relative to
/// outputs above 1; 1e12 if it is infinite. Indices: [value][probe color]. The probe colors repeat
/// for each setting of the uniforms.
struct Sensitivity {
    std::vector<std::vector<double>> value;
    std::vector<std::vector<double>> sensitivity;
};
/// @param settings  see choose_precision()
[[nodiscard]] Sensitivity measure_sensitivity(
    const std::vector<TapeInstruction>& code, const std::array<std::uint32_t, 3>& outputs,
    const std::vector<std::vector<double>>& settings = {});

TONEWRIGHT_NAMESPACE_END
