// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tonewright/shader.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// An argument of a shader's function after the color.
struct ShaderArgument {
    std::string name;
    std::string help;
    double value;
    double min;
    double max;
};

/// The language of the application's other backend, whose functions stand in the same file.
[[nodiscard]] std::optional<ShaderLanguage> second_language(const ShaderApplication& application);

/// The file for the application: the shader with its textures in the text or in files.
/// @param shader  in the application's language
/// @param other   its functions in second_language()
[[nodiscard]] Shader wrap(const ShaderApplication& application, Shader shader,
                          const std::vector<ShaderArgument>& arguments, const std::string& other);

TONEWRIGHT_NAMESPACE_END
