// SPDX-License-Identifier: Apache-2.0
#include "shader/grid_form.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <vector>

#include "base/half_value.h"
#include "expr/nodes.h"
#include "shader/float_form.h"
#include "shader/texture_form.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::map<const Grid*, std::shared_ptr<const Grid>> grids_of(const ShaderProgram& program) {
    std::map<const Grid*, std::shared_ptr<const Grid>> grids;
    for (const Expr& e : nodes_of(compose(program))) {
        if (e.op() == ExprOp::grid) grids.emplace(e.grid().get(), e.grid());
    }
    return grids;
}

std::vector<double> computed_nodes(const Grid& grid) {
    ShaderProgram program;
    program.colors.push_back({"node", {}, node_formula(grid)});
    program.steps.emplace_back(ColorStep{0});
    const FloatRun run(program);
    const auto edge = static_cast<std::size_t>(grid.edge());
    const auto place = [&](std::size_t i) {
        return static_cast<float>(i % edge) / static_cast<float>(edge - 1);
    };
    std::vector<float> rgb;
    rgb.reserve(3 * edge * edge * edge);
    for (std::size_t i = 0; i < edge * edge * edge; ++i) {
        for (const std::size_t digit : {i / edge / edge, i / edge, i})
            rgb.push_back(place(digit));
    }
    run.run_rgb(rgb.data(), rgb.data(), rgb.size() / 3);
    return {rgb.begin(), rgb.end()};
}

std::vector<double> half_nodes(const Grid& grid) {
    std::vector<double> nodes = grid.nodes();
    for (double& x : nodes)
        x = half_value(half_bits(static_cast<double>(static_cast<float>(x))));
    return nodes;
}

}  // namespace

ShaderTables tables_for(const ShaderApplication& application, const ShaderProgram& program,
                        ShaderTables tables) {
    const TextureForm* const form = grid_form(application);
    if (!form || !form->is_only_one || grids_of(program).size() < 2) return tables;
    if (tables == ShaderTables::texture) {
        throw Error(Problem{
            .value = "the operator reads several 3D LUTs",
            .expected = "<<tables=formula>>: " + application.title + " has a texture for one"});
    }
    return tables == ShaderTables::by_size ? ShaderTables::formula : tables;
}

GridSource grid_source(const Grid& grid, const LanguageFacts& language, ShaderTables tables,
                       const std::string& function) {
    const std::size_t numbers =
        3 * static_cast<std::size_t>(grid.edge() * grid.edge() * grid.edge());
    const bool fits = numbers <= language.largest_array;
    constexpr const char* kTargets =
        "a language with textures (glsl, glsl-es, hlsl, wgsl), c, or a LUT for the application";
    const auto refuse = [&](const std::string& expected) {
        return Error(
            Problem{.value = fmt::format("{} reads a 3D LUT of {}^3 nodes{}", function, grid.edge(),
                                         grid.has_formula() ? "" : " without a formula"),
                    .expected = expected});
    };
    switch (tables) {
        case ShaderTables::formula:
            if (grid.has_formula()) return GridSource::formula;
            throw refuse("another kind of <<tables>>");
        case ShaderTables::texture:
            if (language.has_textures) return GridSource::texture;
            throw refuse(grid.has_formula() ? "<<tables=formula>>: no texture is possible there"
                                            : kTargets);
        case ShaderTables::array:
            if (fits) return GridSource::array;
            throw refuse(
                fmt::format("<<tables=formula>> or texture: an array should hold at most "
                            "{} numbers, not {}",
                            language.largest_array, numbers));
        case ShaderTables::by_size:
            break;
    }
    constexpr std::size_t kFew = 4096;
    if (numbers > kFew && language.prefers_formula && grid.has_formula())
        return GridSource::formula;
    if (fits) return GridSource::array;
    if (language.has_textures) return GridSource::texture;
    if (grid.has_formula()) return GridSource::formula;
    throw refuse(kTargets);
}

std::array<Expr, 3> node_formula(const Grid& grid) {
    FloatForm form({{0, 1}, {0, 1}, {0, 1}}, {});
    const std::vector<Expr> exact = grid.formula();
    return {form(exact[0]), form(exact[1]), form(exact[2])};
}

GridsInText grids_in_text(const ShaderProgram& program, const LanguageFacts& language,
                          ShaderTables tables, const std::string& function) {
    GridsInText result;
    for (const auto& entry : grids_of(program)) {
        const std::shared_ptr<const Grid>& grid = entry.second;
        const GridSource source = grid_source(*grid, language, tables, function);
        const bool is_half = source == GridSource::texture && language.holds_halves;
        if (source != GridSource::formula && !is_half) continue;
        result.emplace(grid.get(), is_half
                                       ? std::make_shared<const Grid>(
                                             grid->edge(), [grid] { return half_nodes(*grid); })
                                       : std::make_shared<const Grid>(
                                             grid->edge(), [grid] { return computed_nodes(*grid); },
                                             [grid] { return grid->formula(); }));
    }
    return result;
}

TONEWRIGHT_NAMESPACE_END
