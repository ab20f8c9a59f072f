// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "shader/language.h"
#include "tonewright/shader.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A texture in the file of an application: the nodes of a 3D LUT, or all 1D tables of the text.
/// Patterns use fmt with {name}, {width}, {height}, {edge} and {binding}; the fetch of a texel also
/// {x}, {y}, {z}, where x runs fastest. The text fetches texels without a filter and interpolates
/// them itself, because filters of GPUs have 8-bit weights and are not tetrahedral.
struct TextureForm {
    const char* application;
    /// False if the user would have to connect the texture by hand; the text then computes nodes
    /// unless textures are asked for. Tables are arrays unless textures are asked for.
    bool is_default;
    bool holds_halves;  // instead of 32-bit floats
    const char* declaration;
    const char* fetch;
    const char* color_of_fetch;
    std::size_t first_binding = 0;
    bool is_only_one = false;  // texture in the application's shader
    /// Type and name of an argument, if functions cannot read a global texture.
    const char* parameter = "";
    /// Comments after the declaration's first line.
    const char* note = "";
    /// Lines of the wrapper for each texture, in place of @grids and of @bindings: @texture,
    /// @width, @height, @depth and @data.
    const char* lines = "";
    const char* bindings = "";
    std::string (*data)(const ShaderTexture&) = nullptr;
    /// Suffix and contents of a file beside the text.
    const char* suffix = "";
    std::string (*contents)(const ShaderTexture&) = nullptr;
    /// Texels in a row of tables; every WebGL 2 has 2D textures of that width.
    int largest_width = 2048;
};
/// Null: the application takes no 3D LUTs.
[[nodiscard]] const TextureForm* grid_form(const ShaderApplication& application);
/// Null: the application takes no tables in 32-bit floats.
[[nodiscard]] const TextureForm* table_form(const ShaderApplication& application);
[[nodiscard]] const TextureForm& form_of(const ShaderApplication& application,
                                         const ShaderTexture& texture);

/// True for a texture of tables, which has a depth of 1.
[[nodiscard]] bool holds_tables(const ShaderTexture& texture);

/// The language with the application's way to declare and fetch textures.
[[nodiscard]] LanguageFacts language_for(const ShaderApplication& application);
/// The language of the application's other backend, whose text declares no textures.
[[nodiscard]] LanguageFacts second_language_for(ShaderLanguage language);

TONEWRIGHT_NAMESPACE_END
