// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "shader/float_run.h"
#include "shader/language.h"
#include "shader/program.h"
#include "tonewright/shader.h"

TONEWRIGHT_NAMESPACE_BEGIN

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
