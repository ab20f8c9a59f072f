// SPDX-License-Identifier: Apache-2.0
#pragma once

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

/// File contents for the application.
[[nodiscard]] std::string wrap(const ShaderApplication& application, const Shader& shader,
                               const std::vector<ShaderArgument>& arguments);

TONEWRIGHT_NAMESPACE_END
