// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The first step of every engine: NaN -> 0.
[[nodiscard]] inline double without_nan(double x) noexcept { return x != x ? 0.0 : x; }

/// The first step for pipelines without an exposure: NaN -> 0, then the limits +-kHalfMax.
/// @see limits_input()
[[nodiscard]] inline double sanitize(double x) noexcept {
    return x != x ? 0.0 : (x < -kHalfMax ? -kHalfMax : (x > kHalfMax ? kHalfMax : x));
}

/// Double-precision evaluation of a pipeline: the reference for all other backends.
///
/// It runs the expressions as they are written, without any pass that changes a value. The result
/// is finite for every double, also for NaN and infinities. Safe to share between threads.
class TONEWRIGHT_API ReferenceEngine {
  public:
    /// @throws Error  more than 4096 values live at the same time; exceptions of Grid::nodes()
    explicit ReferenceEngine(const Pipeline& pipeline);
    ~ReferenceEngine();
    ReferenceEngine(ReferenceEngine&&) noexcept;
    ReferenceEngine& operator=(ReferenceEngine&&) noexcept;

    [[nodiscard]] Vector3 operator()(const Vector3& rgb) const noexcept;
    /// Planar. In and out may be the same planes. Any count, also 0.
    void run(const std::array<const double*, 3>& in, const std::array<double*, 3>& out,
             std::size_t count) const noexcept;
    /// Interleaved RGB float in, interleaved RGB double out.
    void run_rgb(const float* in, double* out, std::size_t pixel_count) const noexcept;

  private:
    struct Program;
    std::unique_ptr<const Program> program_;
};

/// A number of a compiled pipeline that can change: see SimdEngine::with_uniforms().
struct LiveUniform {
    /// The engine chooses precision for this value, and uses it until another one is given.
    double typical = 0;
    double least = 0;
    double most = 0;
    /// The engine chooses precision for both ends, too: the uniform changes the weight of other
    /// errors, as a divisor close to 0 does.
    bool covers_ends = false;
};
/// By the names of the uniforms.
using LiveUniforms = std::map<std::string, LiveUniform, std::less<>>;

/// Single-precision SIMD evaluation of a pipeline.
///
/// Only this engine has passes that change the last bits: products of matrices, multiplication
/// instead of division by a constant, fused multiply-add, piecewise polynomials for whole curves.
/// The result is finite for every float. Safe to share between threads.
class TONEWRIGHT_API SimdEngine {
  public:
    /// @param max_error  largest difference from the reference: absolute up to 1, relative above.
    ///                   Values that need more than float for that are computed in double. Each
    ///                   operator declares the bound of its views (DeclaredBounds::simd_goal).
    /// @param target  the instruction set, one of targets(); "" for the best
    /// @throws Error  the machine has no such target, or the pipeline has more values at a time
    ///                than a tile holds; exceptions of Grid::nodes()
    explicit SimdEngine(const Pipeline& pipeline, double max_error = kSimdError,
                        std::string_view target = {});
    /// An engine for all values of the pipeline's uniforms. Values that depend on uniforms only are
    /// computed once, in double, not for each pixel.
    explicit SimdEngine(const Pipeline& pipeline, const LiveUniforms& uniforms,
                        double max_error = kSimdError, std::string_view target = {});
    ~SimdEngine();
    SimdEngine(SimdEngine&&) noexcept;
    SimdEngine& operator=(SimdEngine&&) noexcept;

    /// Planar float. `stride` is the distance between consecutive pixels of one plane, in floats
    /// (1 = packed, 3 or 4 = interleaved). In and out may be the same memory; otherwise they must
    /// not overlap. Any pixel count, also 0. Nothing outside the pixels is read or written.
    void run(const std::array<const float*, 3>& in, std::ptrdiff_t in_stride,
             const std::array<float*, 3>& out, std::ptrdiff_t out_stride,
             std::size_t count) const noexcept;
    /// Interleaved RGB, packed.
    void run_rgb(const float* in, float* out, std::size_t pixel_count) const noexcept;

    /// The same program with other values of its uniforms. Takes microseconds, because the code is
    /// shared and only the numbers that it reads are copied.
    /// @throws Error  a uniform has no value, or one out of its range
    [[nodiscard]] SimdEngine with_uniforms(const UniformValues& values) const;

    /// Names of the compiled instruction sets that this machine has, best first ("AVX3", ...).
    [[nodiscard]] static std::vector<std::string> targets();
    /// An engine for each of targets(), in their order. Faster than one by one, because targets
    /// share some of the work.
    /// @throws Error  as the constructor does
    [[nodiscard]] static std::vector<SimdEngine> of_all_targets(const Pipeline& pipeline,
                                                                double max_error = kSimdError);

  private:
    struct Program;
    explicit SimdEngine(std::unique_ptr<const Program> program);
    std::unique_ptr<const Program> program_;
};

/// The parameters that come from a picture (ParameterSpec::from_picture) as uniforms, so that one
/// engine serves every picture and every frame of a sequence. Intervals and units are those of the
/// parameters, and typical values are the defaults. Errors stay within the operator's bound at both
/// ends of each interval.
///
/// Leaves out parameters that the settings or the preset set. Empty if one of the others is fixed:
/// then each picture has a program of its own. No built-in operator has such a parameter.
[[nodiscard]] TONEWRIGHT_API LiveUniforms live_statistics(const ResolvedOperator& resolved);

/// The names for build_live_view().
[[nodiscard]] TONEWRIGHT_API std::vector<std::string> uniform_names(const LiveUniforms& uniforms);

/// The values of live_statistics() for a picture.
[[nodiscard]] TONEWRIGHT_API UniformValues statistic_values(const LiveUniforms& uniforms,
                                                            const ResolvedOperator& resolved,
                                                            const SceneStatistics& statistics);

/// Explains the compilation of a pipeline by SimdEngine step by step, for developers: expressions,
/// precision, curves, program and machine code. The format of the text may change.
[[nodiscard]] TONEWRIGHT_API std::string explain(const Pipeline& pipeline,
                                                 const LiveUniforms& uniforms = {},
                                                 double max_error = kSimdError,
                                                 std::string_view target = {});

TONEWRIGHT_NAMESPACE_END
