// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "expr/nodes.h"
#include "tonewright/expr.h"
#include "tonewright/pipeline.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The report page computes grids from their formulas instead of holding them.
TEST(GridFormula, GivesTheNodes) {
    std::set<const Grid*> seen;
    const std::vector<Settings> all = {
        {}, {{"limit", "p3d65"}}, {{"limit", "rec2020"}}, {{"range", "hdr"}}};
    for (const Settings& settings : all) {
        for (const char* const look : {"", "punchy"}) {
            const ResolvedOperator op = resolve_operator("agx_blender", settings, look);
            const std::array<Expr, 3> rgb = compose(op.build());
            for (const Expr& e : nodes_of(rgb)) {
                if (e.op() != ExprOp::grid || !seen.insert(e.grid().get()).second) continue;
                const Grid& grid = *e.grid();
                ASSERT_TRUE(grid.has_formula());
                const std::vector<Expr> formula = grid.formula();
                const auto edge = static_cast<std::size_t>(grid.edge());
                // The nodes of the guard rail are rounded to seven decimals: where the logarithms
                // of the two differ in their last bit, the decimal may be the next one.
                const double bound = edge == 37 ? 1.01e-7 : 1e-12;
                double worst = 0;
                for (std::size_t i = 0; i < edge * edge * edge; i += 61) {
                    const auto place = [&](std::size_t k) {
                        return static_cast<double>(k % edge) / static_cast<double>(edge - 1);
                    };
                    const std::array<double, 3> at = {place(i / edge / edge), place(i / edge),
                                                      place(i)};
                    for (std::size_t c = 0; c < 3; ++c)
                        worst = std::max(
                            worst, std::abs(evaluate(formula[c], at) - grid.nodes()[3 * i + c]));
                }
                EXPECT_LE(worst, bound) << edge << "^3, " << op.label;
            }
        }
    }
    EXPECT_EQ(seen.size(), 5U);  // SDR of three gamuts, HDR, the looks' guard rail
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
