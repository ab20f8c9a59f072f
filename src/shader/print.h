// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shader/language.h"
#include "shader/program.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct PrintedProgram {
    std::string text;
    std::vector<ShaderTexture> textures;
};
/// The functions of a program, each before the ones that call it.
/// @param name      name of the last function, which prefixes the names of all others
/// @param uniforms  its arguments after the color
/// @throws Error    if the language cannot hold the tables or a Grid this way
[[nodiscard]] PrintedProgram print_program(const ShaderProgram& program,
                                           const LanguageFacts& language, const std::string& name,
                                           const std::vector<std::string>& uniforms,
                                           ShaderTables tables = ShaderTables::by_size);

TONEWRIGHT_NAMESPACE_END
