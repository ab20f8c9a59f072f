// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenColorIO/OpenColorIO.h>

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

namespace OCIO = OCIO_NAMESPACE;

struct GpuProgram;

/// Runs OCIO's GPU path, without a window: the GLSL 4.0 and the textures that OCIO gives to an
/// application, drawn by OpenGL (reached through EGL) from float texels into float texels.
///
/// A software rasterizer is enough, and more accurate: texture units of real GPUs filter 1D LUTs
/// with 8-bit weights, Mesa's llvmpipe with float weights.
///
/// All objects of a process that speak one dialect share one OpenGL context; any thread may use any
/// of them, one at a time. What the calling thread has current in EGL is the same after each call
/// as before.
class TONEWRIGHT_API OcioGpu {
  public:
    /// Compiles the shader and uploads the LUTs.
    ///
    /// @throws Error  "gpu: <what>" when there is no context (see unavailable_reason()), OCIO has
    ///                no shader, the shader does not compile (with the first line of its log), or
    ///                the processor has dynamic properties.
    explicit OcioGpu(const OCIO::ConstProcessorRcPtr& processor,
                     OCIO::OptimizationFlags flags = OCIO::OPTIMIZATION_DEFAULT);
    OcioGpu(OcioGpu&&) noexcept;
    OcioGpu& operator=(OcioGpu&&) noexcept;
    ~OcioGpu();

    /// Interleaved RGB float, any count; alpha is 1. `out` may be `in`. GLSL leaves open what NaN
    /// becomes and whether subnormal numbers count as 0; infinities are passed on.
    /// @throws Error  if the driver fails; `out` is then partly written.
    void run_rgb(const float* in, float* out, std::size_t pixel_count) const;

    /// Empty if a context is available (on a GPU or a software rasterizer); otherwise the reason.
    /// The first call tries, later ones use its result.
    [[nodiscard]] static std::string unavailable_reason();

    /// The driver's GL_RENDERER, such as "llvmpipe (LLVM 15.0.6, 256 bits)"; empty if there is
    /// none.
    [[nodiscard]] static std::string renderer();

  private:
    std::unique_ptr<GpuProgram> program_;
};

/// A 3D texture, RGBA float, x running fastest, that a GLSL text reads without a filter.
struct GlslTexture {
    std::string sampler;
    std::array<int, 3> size;
    const float* rgba;
};

enum class GlslDialect : unsigned char { desktop, es };  // OpenGL 4.0, OpenGL ES 3.0

/// Runs a GLSL function `vec3 <function>(vec3)` in the same way.
class TONEWRIGHT_API GlslGpu {
  public:
    /// @throws Error  as OcioGpu does
    GlslGpu(const std::string& text, const std::string& function,
            const std::vector<GlslTexture>& textures = {},
            GlslDialect dialect = GlslDialect::desktop);
    GlslGpu(GlslGpu&&) noexcept;
    GlslGpu& operator=(GlslGpu&&) noexcept;
    ~GlslGpu();

    /// @see OcioGpu::run_rgb()
    void run_rgb(const float* in, float* out, std::size_t pixel_count) const;

    /// @see OcioGpu::renderer()
    [[nodiscard]] static std::string renderer(GlslDialect dialect);

  private:
    std::unique_ptr<GpuProgram> program_;
};

TONEWRIGHT_NAMESPACE_END
