// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/curve_fitting.h"
#include "engine/simd_kernels.h"
#include "engine/tape.h"
#include "tonewright/engine.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

/// The float program of a pipeline. The passes that change the last bits are here and only here:
///
/// 1. neighboring matrices multiplied; division by a constant as multiplication by its reciprocal;
///    small whole powers as products;
/// 2. functions of one value compiled to piecewise polynomials, on instruction sets where that is
///    faster (curve_fitting.h);
/// 3. the values that float is too coarse for are kept in double (precision.h);
/// 4. products and sums contracted to fused multiply-adds and dot products, comparisons joined to
///    their selects;
/// 5. registers allocated, and the tile made as large as the first-level cache allows;
/// 6. for AVX2 and AVX-512, machine code of the same (machine_code.h).
/// @param has_curves  false leaves 2 out, to test the kernels that curves replace
/// @param uniforms  those that the pipeline may have
[[nodiscard]] Code compile(const Pipeline& pipeline, double max_error = kSimdError,
                           const Target& target = find_target(), bool has_curves = true,
                           const LiveUniforms& uniforms = {});

/// How many pipelines were compiled so far, for tests.
[[nodiscard]] std::size_t compilations() noexcept;

/// Where a code has the curves that its tape refers to.
using CurveIndex = std::map<const CompiledCurve*, std::uint32_t>;
/// A program with what lies behind it.
struct Steps {
    /// After passes 1 to 3.
    std::vector<TapeInstruction> tape;
    std::array<std::uint32_t, 3> outputs{};
    std::vector<bool> in_double;
    CurveCache curves;  // owns what the tape refers to
    CurveIndex curve_index;
    Code code;
};
[[nodiscard]] Steps compile_in_steps(const Pipeline& pipeline, const LiveUniforms& uniforms,
                                     double max_error, const Target& target);

/// @param values   see Tape::evaluate_numbers()
/// @param numbers  a copy of the code's
void set_uniforms(const Code& code, const std::vector<double>& values, Numbers& numbers);

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
