// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/compiled_curve.h"
#include "engine/precision.h"
#include "engine/tape.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Result of fitting one function.
struct FittedCurve {
    bool is_tried = false;
    bool is_precise = false;
    bool is_rejected = false;                    // permanently
    std::unique_ptr<const CompiledCurve> curve;  // null if no curve fits
};
/// Results by a key that describes the function and its tolerance.
using CurveCache = std::map<std::string, FittedCurve>;

/// Rejects a curve that is too coarse for its program. The next fit of its function is a precise
/// curve. If the curve was precise already, its function gets no curve any more.
void reject_curve(CurveCache& cache, const CompiledCurve* curve);

/// Replaces each single-input subgraph that is slower than a fitted curve by such a curve. Then
/// removes dead code. The input is any value, such as an input channel or a row of a matrix. A
/// subgraph may extend to the point where channels meet again.
/// @param code  straight-line code in single-assignment form
/// @param outputs  indices into `code`
/// @param sensitivity  of the values in `code`
/// @param cache  owns the curves that `code` refers to afterwards
/// @param form  see simd::Target::curve_form
void fit_curves(std::vector<TapeInstruction>& code, std::array<std::uint32_t, 3>& outputs,
                const Sensitivity& sensitivity, CurveCache& cache, CurveForm form);

TONEWRIGHT_NAMESPACE_END
