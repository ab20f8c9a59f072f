// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/assemble.h"
#include "engine/curve_fitting.h"
#include "engine/simd_kernels.h"
#include "engine/tape.h"
#include "tonewright/engine.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

/// Compiles a pipeline. Only these steps change the last bits of results:
///
/// - rewrite.h replaces operations by cheaper ones;
/// - curve_fitting.h compiles functions of one value to piecewise polynomials, on instruction sets
///   where that is faster;
/// - precision.h chooses the values that are kept in double;
/// - select.h contracts products and sums to fused multiply-adds and dot products.
///
/// assemble.h then gives values their registers, and machine_code.h makes machine code of the
/// program for AVX2 and AVX-512.
/// @param has_curves  false compiles no curves, to test the kernels that curves replace
/// @param uniforms  uniforms that the pipeline may have
[[nodiscard]] Program compile(const Pipeline& pipeline, double max_error = kSimdError,
                              const Target& target = find_target(), bool has_curves = true,
                              const LiveUniforms& uniforms = {});

/// Number of pipelines compiled so far, for tests.
[[nodiscard]] std::size_t compilations() noexcept;

/// A program and the intermediate results of its compilation.
struct Steps {
    /// After rewrites and curve fitting.
    std::vector<TapeInstruction> tape;
    std::array<std::uint32_t, 3> outputs{};
    std::vector<bool> in_double;
    CurveCache curves;  // owns what the tape refers to
    CurveIndex curve_index;
    Program program;
};
[[nodiscard]] std::vector<Program> compile_for_all_targets(const Pipeline& pipeline,
                                                           double max_error);
[[nodiscard]] Steps compile_in_steps(const Pipeline& pipeline, const LiveUniforms& uniforms,
                                     double max_error, const Target& target);

/// @param values   see Tape::evaluate_numbers()
/// @param numbers  a copy of the program's
void set_uniforms(const Program& program, const std::vector<double>& values, Numbers& numbers);

/// Runs the program over `count` pixels: its machine code if there is any, else the interpreter.
/// @param numbers  the program's own, or a copy in which uniforms have other values
void run(const Program& program, const Numbers& numbers, const std::array<const float*, 3>& in,
         std::ptrdiff_t in_stride, const std::array<float*, 3>& out, std::ptrdiff_t out_stride,
         std::size_t count) noexcept;
inline void run(const Program& program, const std::array<const float*, 3>& in,
                std::ptrdiff_t in_stride, const std::array<float*, 3>& out,
                std::ptrdiff_t out_stride, std::size_t count) noexcept {
    run(program, program.numbers, in, in_stride, out, out_stride, count);
}

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
