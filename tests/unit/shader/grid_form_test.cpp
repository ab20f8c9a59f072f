// SPDX-License-Identifier: Apache-2.0
#include "shader/grid_form.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "shader/program.h"
#include "shader/texture_form.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Node r, g, b is (r, g, b)/edge: no half float for most.
std::shared_ptr<const Grid> grid_without_formula(int edge) {
    return std::make_shared<const Grid>(edge, [edge] {
        std::vector<double> nodes;
        for (int i = 0; i < edge * edge * edge; ++i) {
            for (const int digit : {i / edge / edge, i / edge % edge, i % edge})
                nodes.push_back(static_cast<double>(digit) / edge);
        }
        return nodes;
    });
}

TEST(GridForm, SourceOfNodesByTarget) {
    const auto grid = grid_without_formula(17);
    const Grid with_formula(
        17, [] { return std::vector<double>(3 * 17 * 17 * 17, 0.5); },
        [] { return std::vector<Expr>(3, Expr(0.5)); });
    const LanguageFacts& dctl = facts_of(ShaderLanguage::dctl);
    const LanguageFacts& glsl = facts_of(ShaderLanguage::glsl);
    EXPECT_EQ(grid_source(*grid, glsl, ShaderTables::by_size, "f"), GridSource::texture);
    EXPECT_EQ(grid_source(*grid_without_formula(9), glsl, ShaderTables::by_size, "f"),
              GridSource::array);
    EXPECT_EQ(grid_source(with_formula, dctl, ShaderTables::by_size, "f"), GridSource::formula);
    EXPECT_EQ(grid_source(with_formula, glsl, ShaderTables::formula, "f"), GridSource::formula);
    EXPECT_THROW((void)grid_source(*grid, dctl, ShaderTables::by_size, "f"), Error);
    EXPECT_THROW((void)grid_source(*grid, glsl, ShaderTables::formula, "f"), Error);
    // Unity would need a hand: the formula comes first, but a texture before a refusal.
    const LanguageFacts unity = language_for(find_shader_application("unity"));
    EXPECT_EQ(grid_source(with_formula, unity, ShaderTables::by_size, "f"), GridSource::formula);
    EXPECT_EQ(grid_source(*grid, unity, ShaderTables::by_size, "f"), GridSource::texture);
    EXPECT_EQ(grid_form(find_shader_application("shadertoy")), nullptr);
}

TEST(GridForm, NodesAreThoseOfTheText) {
    const auto grid = grid_without_formula(17);
    const ShaderProgram program = make_program({GridStage{Expr::input(), grid}}, {});
    const LanguageFacts threejs = language_for(find_shader_application("threejs"));
    const GridsInText halves = grids_in_text(program, threejs, ShaderTables::by_size, "f");
    ASSERT_EQ(halves.size(), 1U);
    double worst = 0;
    const std::vector<double>& nodes = halves.begin()->second->nodes();
    for (std::size_t i = 0; i < nodes.size(); ++i)
        worst = std::max(worst, std::fabs(nodes[i] - grid->nodes()[i]));
    EXPECT_GT(worst, 0);
    EXPECT_LE(worst, 0x1p-12) << "half a step of a half float below 1";
    EXPECT_TRUE(
        grids_in_text(program, facts_of(ShaderLanguage::glsl), ShaderTables::by_size, "f").empty())
        << "32-bit floats";
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
