// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tonewright/generated_files.h"
#include "tonewright/shader.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// An operator in the package. The name of its export is that of the function without `tw_`.
struct NpmOperator {
    std::string title;
    Shader glsl;  // GLSL ES
    Shader wgsl;
    // The files for three.js, which hold no textures.
    std::optional<Shader> threejs;
    std::optional<Shader> tsl;
};

/// Raw little-endian floats.
[[nodiscard]] std::string texture_bytes(const ShaderTexture& texture);

/// The files of the npm package tonewright-shaders: ES modules with types, package.json, README.md.
[[nodiscard]] std::vector<GeneratedFile> npm_package(const std::vector<NpmOperator>& operators);

TONEWRIGHT_NAMESPACE_END
