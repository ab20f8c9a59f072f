// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "shader/float_run.h"
#include "shader/language.h"
#include "shader/program.h"
#include "tonewright/shader.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A texture of a 3D LUT in the file of an application. Patterns use fmt with {name}, {edge} and
/// {binding}; the fetch of a node also {x}, {y}, {z}, where x runs fastest.
/// The text fetches nodes without a filter and interpolates them itself, because filters of GPUs
/// have 8-bit weights and are not tetrahedral.
struct GridForm {
    const char* application;
    /// False if the user would have to connect the texture by hand; the text then computes nodes
    /// unless textures are asked for.
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
    /// Lines of the wrapper for each texture, in place of @grids and of @bindings: @texture, @edge
    /// and @data.
    const char* lines = "";
    const char* bindings = "";
    std::string (*data)(const ShaderTexture&) = nullptr;
    /// Suffix and contents of a file beside the text.
    const char* suffix = "";
    std::string (*contents)(const ShaderTexture&) = nullptr;
};
/// Null: the application takes no textures.
[[nodiscard]] const GridForm* grid_form(const ShaderApplication& application);

/// The language with the application's way to declare and fetch textures.
[[nodiscard]] LanguageFacts language_for(const ShaderApplication& application);

/// The request's tables, but computed nodes for more 3D LUTs than the application has textures.
[[nodiscard]] ShaderTables tables_for(const ShaderApplication& application,
                                      const ShaderProgram& program, ShaderTables tables);

/// Sources of a Grid's nodes in a text.
enum class GridSource : unsigned char { array, texture, formula };
/// @throws Error  the language can hold them in no such way
[[nodiscard]] GridSource grid_source(const Grid& grid, const LanguageFacts& language,
                                     ShaderTables tables, const std::string& function);

/// The formula of a Grid's nodes in float form. Inputs 0, 1, 2: the place in [0, 1].
/// @pre grid.has_formula()
[[nodiscard]] std::array<Expr, 3> node_formula(const Grid& grid);

/// Grids with the nodes that the text reads: half floats, or the results of the formula in float.
/// The latter keep the formula. Grids whose nodes the text has in float are not in the map.
[[nodiscard]] GridsInText grids_in_text(const ShaderProgram& program, const LanguageFacts& language,
                                        ShaderTables tables, const std::string& function);

TONEWRIGHT_NAMESPACE_END
