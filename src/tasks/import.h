// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tasks/listener.h"
#include "tonewright/definition.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct ImportResult {
    ImportedShader shader;
    /// Names of built-in operators that show the same.
    std::vector<std::string> equals;
};

/// A shader's function as an operator, compared with those that are built in.
/// @param to      .tone file to write; empty: none
/// @throws Error      @see import_shader
/// @throws FileError  a file cannot be read or written
[[nodiscard]] ImportResult import_operator(const std::string& shader, const ShaderImport& settings,
                                           const std::string& to, const Listener& listener);

TONEWRIGHT_NAMESPACE_END
