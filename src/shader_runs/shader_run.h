// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tonewright/verify.h"

TONEWRIGHT_NAMESPACE_BEGIN

// Each throws an Error with the reason if this machine lacks a requirement.
[[nodiscard]] std::unique_ptr<ShaderRun> run_on_opengl();
[[nodiscard]] std::unique_ptr<ShaderRun> run_on_opengl_es();
[[nodiscard]] std::unique_ptr<ShaderRun> run_by_c_compiler();
[[nodiscard]] std::unique_ptr<ShaderRun> run_on_opencl();
[[nodiscard]] std::unique_ptr<ShaderRun> run_wgsl_on_dawn();
[[nodiscard]] std::unique_ptr<ShaderRun> run_hlsl_on_dawn();

/// A language or an application whose shaders do not run.
struct NotExecuted {
    std::string name;
    std::string reason;
};

/// Sets `options.shaders` to the runs of the named languages, each tested by a run. With a config
/// and without operators, or without the GPU, only checks the names.
///
/// Shaders run on OpenGL and OpenGL ES through EGL, with the C compiler `$CC` (else cc, gcc,
/// clang), on OpenCL (DCTL), and on Dawn for Node.js (WGSL, HLSL), if TONEWRIGHT_NODE_MODULES names
/// a folder with the packages webgpu and naga-wasm.
/// @param names   languages, as shader_languages() names them. Empty or `all`: those that this
///                machine can run. `none`: no shaders.
/// @returns       named languages that do not run; for all, also those that nothing can run
/// @throws Error  unknown names
std::vector<NotExecuted> add_shader_runs(VerifyOptions& options,
                                         const std::vector<std::string>& names);

/// One line with the names and their reasons.
[[nodiscard]] std::string format_not_executed(const std::vector<NotExecuted>& all);

TONEWRIGHT_NAMESPACE_END
