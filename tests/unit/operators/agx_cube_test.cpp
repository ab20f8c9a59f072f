// SPDX-License-Identifier: Apache-2.0
#include "operators/agx_cube.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <vector>

#include "expr/nodes.h"
#include "tonewright/expr.h"
#include "tonewright/pipeline.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The library holds nodes that a program of the build has written. Shipped LUTs depend on them, so
/// they have the bits of the formula, and not those of an older or a differently compiled program.
TEST(AgxCube, NodesOfTheBuildHaveTheBitsOfTheFormula) {
    const std::vector<double> expected =
        agx_cube::cube_nodes(agx_cube::kEdge, agx_cube::rec709_node());
    int grids = 0;
    for (const Expr& e : nodes_of(compose(resolve_operator("agx_blender").build()))) {
        if (e.op() != ExprOp::grid) continue;
        ++grids;
        const std::vector<double>& nodes = e.grid()->nodes();
        ASSERT_EQ(nodes.size(), expected.size());
        EXPECT_EQ(std::memcmp(nodes.data(), expected.data(), nodes.size() * sizeof(double)), 0);
    }
    EXPECT_EQ(grids, 3);  // one expression for each channel
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
