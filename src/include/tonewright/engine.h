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

/// The first step of every engine: NaN -> 0, then limited to +-kHalfMax.
[[nodiscard]] inline double sanitize(double x) noexcept {
    return x != x ? 0.0 : (x < -kHalfMax ? -kHalfMax : (x > kHalfMax ? kHalfMax : x));
}

/// Double-precision evaluation of a pipeline: the truth that every other form is held to.
///
/// It runs the expressions as they are written, without any pass that changes a value. Total:
/// finite out for every double in, NaN and infinities included. Safe to share between threads.
class TONEWRIGHT_API ReferenceEngine {
  public:
    /// @throws Error  when more than 4096 values live at the same time; Lattice::nodes() as well
    explicit ReferenceEngine(const Pipeline& pipeline);
    ~ReferenceEngine();
    ReferenceEngine(ReferenceEngine&&) noexcept;
    ReferenceEngine& operator=(ReferenceEngine&&) noexcept;

    [[nodiscard]] Vector3 operator()(const Vector3& rgb) const noexcept;
    /// Planar; in and out may be the same planes; any count, 0 included.
    void run(const std::array<const double*, 3>& in, const std::array<double*, 3>& out,
             std::size_t count) const noexcept;
    /// Interleaved RGB float in, interleaved RGB double out.
    void run_rgb(const float* in, double* out, std::size_t pixel_count) const noexcept;

  private:
    struct Program;
    std::unique_ptr<const Program> program_;
};

/// A number that stays open while a pipeline is compiled: see SimdEngine::with_uniforms().
struct LiveUniform {
    /// What precision is chosen for, and the value until another is given.
    double typical = 0;
    double least = 0;
    double most = 0;
    /// Precision is chosen for both ends, too: the uniform decides how much errors of other values
    /// count, as a number close to 0 does that something is divided by.
    bool covers_ends = false;
};
/// By the names of the uniforms.
using LiveUniforms = std::map<std::string, LiveUniform, std::less<>>;

/// Single-precision SIMD evaluation of a pipeline.
///
/// Passes that change the last bits (matrices multiplied together, division by a constant as
/// multiplication, fused multiply-add, piecewise polynomials for whole curves) are allowed here and
/// only here. Total. Safe to share.
class TONEWRIGHT_API SimdEngine {
  public:
    /// @param max_error  how far the result may be from the reference: absolute up to 1, relative
    ///                   above. What needs more than float for that is computed in double. Each
    ///                   operator declares what its views are made for (DeclaredBounds::simd_goal).
    /// @param target  the instruction set, one of targets(); "" for the best
    /// @throws Error  when the machine has no such target, or when the pipeline has more values at
    ///                a time than a tile holds; Lattice::nodes() as well
    explicit SimdEngine(const Pipeline& pipeline, double max_error = kSimdError,
                        std::string_view target = {});
    /// An engine for all values of the pipeline's uniforms. What uniforms alone decide on is
    /// computed once, in double, not for each pixel.
    explicit SimdEngine(const Pipeline& pipeline, const LiveUniforms& uniforms,
                        double max_error = kSimdError, std::string_view target = {});
    ~SimdEngine();
    SimdEngine(SimdEngine&&) noexcept;
    SimdEngine& operator=(SimdEngine&&) noexcept;

    /// Planar float. `stride` is the distance between consecutive pixels of one plane, in floats
    /// (1 = packed, 3 or 4 = interleaved). In and out may be the same memory; otherwise they must
    /// not overlap. Any pixel count, 0 included; nothing outside the pixels is read or written.
    void run(const std::array<const float*, 3>& in, std::ptrdiff_t in_stride,
             const std::array<float*, 3>& out, std::ptrdiff_t out_stride,
             std::size_t count) const noexcept;
    /// Interleaved RGB, packed.
    void run_rgb(const float* in, float* out, std::size_t pixel_count) const noexcept;

    /// The same program with other values of its uniforms. Takes microseconds: the code is shared,
    /// and only the numbers that it reads are copied.
    /// @throws Error  when a uniform has no value, or one out of its range
    [[nodiscard]] SimdEngine with_uniforms(const UniformValues& values) const;

    /// Names of the instruction sets compiled in that this machine has, best first ("AVX3", ...).
    [[nodiscard]] static std::vector<std::string> targets();
    /// An engine for each of targets(), in their order, sooner than one by one: what several
    /// targets share is compiled once.
    /// @throws Error  as the constructor does
    [[nodiscard]] static std::vector<SimdEngine> of_all_targets(const Pipeline& pipeline,
                                                                double max_error = kSimdError);

  private:
    struct Program;
    explicit SimdEngine(std::unique_ptr<const Program> program);
    std::unique_ptr<const Program> program_;
};

/// The parameters that a picture decides (ParameterSpec::from_picture) as uniforms, so that one
/// engine serves every picture and every frame of a sequence. Their intervals and units are the
/// parameters' own, their typical values the defaults; errors keep to the operator's bound at both
/// ends of each interval.
///
/// Left out is what the settings or the preset set. Empty where each picture should have an engine
/// of its own: a parameter is fixed, or a program with uniforms would be up to three times as slow,
/// because one of them is an exponent, or values are scaled by two of them.
[[nodiscard]] TONEWRIGHT_API LiveUniforms live_statistics(const ResolvedOperator& resolved);

/// For build_live_view().
[[nodiscard]] TONEWRIGHT_API std::vector<std::string> uniform_names(const LiveUniforms& uniforms);

/// The values of live_statistics() for a picture.
[[nodiscard]] TONEWRIGHT_API UniformValues statistic_values(const LiveUniforms& uniforms,
                                                            const ResolvedOperator& resolved,
                                                            const SceneStatistics& statistics);

/// What SimdEngine makes of a pipeline, step by step, for developers: expressions, precision,
/// curves, program and machine code. The text has no fixed form.
[[nodiscard]] TONEWRIGHT_API std::string explain(const Pipeline& pipeline,
                                                 const LiveUniforms& uniforms = {},
                                                 double max_error = kSimdError,
                                                 std::string_view target = {});

TONEWRIGHT_NAMESPACE_END
