// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "tonewright/shader.h"
#include "tonewright/verify.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Compiles and runs shader functions of one language on this machine.
class ShaderRun {
  public:
    ShaderRun() = default;
    ShaderRun(const ShaderRun&) = delete;
    ShaderRun& operator=(const ShaderRun&) = delete;
    virtual ~ShaderRun() = default;

    /// The compiler or driver.
    [[nodiscard]] virtual std::string by() const = 0;

    /// Interleaved RGB.
    /// @param shader  its function has no arguments but the color
    /// @throws Error  the text does not compile, or the driver fails
    virtual void run_rgb(const Shader& shader, const float* in, float* out,
                         std::size_t pixel_count) = 0;
};

// Each throws an Error with the reason if this machine lacks a requirement.
[[nodiscard]] std::unique_ptr<ShaderRun> run_on_opengl();
[[nodiscard]] std::unique_ptr<ShaderRun> run_on_opengl_es();
[[nodiscard]] std::unique_ptr<ShaderRun> run_by_c_compiler();
[[nodiscard]] std::unique_ptr<ShaderRun> run_on_opencl();
[[nodiscard]] std::unique_ptr<ShaderRun> run_wgsl_on_dawn();
[[nodiscard]] std::unique_ptr<ShaderRun> run_hlsl_on_dawn();

/// The languages that run here, tested by a run.
struct ShaderRuns {
    struct Of {
        ShaderLanguageInfo language;
        std::unique_ptr<ShaderRun> run;
    };
    std::vector<Of> runs;
    std::vector<NotExecuted> not_executed;
};
/// Ids of the languages that the names choose.
/// @param names  as VerifyOptions::shaders
/// @throws Error  unknown names
[[nodiscard]] std::vector<std::string> languages_to_run(const std::vector<std::string>& names);
/// @throws Error  unknown names
[[nodiscard]] ShaderRuns make_shader_runs(const std::vector<std::string>& names);

TONEWRIGHT_NAMESPACE_END
