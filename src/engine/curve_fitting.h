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

/// A curve that was asked for.
struct FittedCurve {
    bool is_tried = false;
    bool is_precise = false;
    bool is_rejected = false;                    // for good
    std::unique_ptr<const CompiledCurve> curve;  // null for what no curve can do
};
/// By what they compute and how exactly.
using CurveCache = std::map<std::string, FittedCurve>;

/// Says that the curve costs the program too much of its exactness: next time it is a precise one,
/// and if it was that, there is none.
void reject_curve(CurveCache& cache, const CompiledCurve* curve);

/// Replaces what depends on one value alone, and costs more than a compiled curve of it, by such
/// curves; then leaves out what nobody reads any more. The value may be an input or any other, such
/// as a row of a matrix, and all that follows up to where channels meet again becomes one curve.
/// @param code     straight-line code, each value once
/// @param outputs  indices into it
/// @param sensitivity  of the values of the code
/// @param cache    owns the curves that the code refers to afterwards
/// @param form  see simd::Target
void fit_curves(std::vector<TapeInstruction>& code, std::array<std::uint32_t, 3>& outputs,
                const Sensitivity& sensitivity, CurveCache& cache, CurveForm form);

TONEWRIGHT_NAMESPACE_END
