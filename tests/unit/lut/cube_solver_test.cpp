// SPDX-License-Identifier: Apache-2.0
#include "lut/cube_solver.h"

#include <gtest/gtest.h>

#include "base/random.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Nodes of the identity, blue fastest.
CubeNodes identity(int edge) {
    CubeNodes nodes;
    const double step = 1.0 / (edge - 1);
    for (int r = 0; r < edge; ++r) {
        for (int g = 0; g < edge; ++g) {
            for (int b = 0; b < edge; ++b)
                nodes.insert(nodes.end(), {r * step, g * step, b * step});
        }
    }
    return nodes;
}

TEST(CubeSolver, FindsTheNodesOfAnAffineMap) {
    // Tetrahedra hold an affine map exactly, so its nodes are the only best ones.
    const auto map = [](const Vector3& v) {
        return Vector3{0.5 * v[0] + 0.1 * v[1], 0.2 + 0.6 * v[1], 0.9 * v[2] - 0.3 * v[0] + 0.3};
    };
    CubeSolver solver(4, {}, {});
    SampleRandom random(3);
    for (int i = 0; i < 3000; ++i) {
        const Vector3 place = {random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)};
        solver.add(place, map(place), 1);
    }
    solver.sort_samples();
    CubeNodes nodes = identity(4);
    const CubeNodes places = nodes;
    solver.solve(nodes, 4);
    for (std::size_t i = 0; i < nodes.size(); i += 3) {
        const Vector3 wanted = map({places[i], places[i + 1], places[i + 2]});
        // Samples are floats, and conjugate gradients stop early; a sample counts 1, the damping
        // 1e-6.
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(nodes[i + c], wanted[c], 1e-4) << "node " << i / 3;
    }
}

TEST(CubeSolver, HeldNodesStay) {
    CubeSolverOptions options;
    options.held = {0, 26};
    CubeSolver solver(3, {}, options);
    SampleRandom random(4);
    for (int i = 0; i < 500; ++i)
        solver.add({random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)},
                   {0.5, 0.5, 0.5}, 1);
    solver.sort_samples();
    CubeNodes nodes = identity(3);
    solver.solve(nodes, 2);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(nodes[c], 0);
        EXPECT_EQ(nodes[3 * 26 + c], 1);
        EXPECT_NEAR(nodes[3 * 13 + c], 0.5, 0.1) << "the middle follows the samples";
    }
}

TEST(CubeSolver, NodesAreTheWeightedMeanOfSamplesThatContradictEachOther) {
    // At a node, one sample of weight 3 wants 0.2 and one of weight 1 wants 0.6.
    CubeSolver solver(2, {}, {});
    for (const double r : {0.0, 1.0}) {
        for (const double g : {0.0, 1.0}) {
            for (const double b : {0.0, 1.0}) {
                solver.add({r, g, b}, {0.2, 0.2, 0.2}, 3);
                solver.add({r, g, b}, {0.6, 0.6, 0.6}, 1);
            }
        }
    }
    solver.sort_samples();
    CubeNodes nodes = identity(2);
    solver.solve(nodes, 4);
    for (const double node : nodes)
        EXPECT_NEAR(node, 0.3, 1e-4);
}

TEST(CubeSolver, EvennessDecidesWhereThereAreNoSamples) {
    // Gray samples of the identity's square; nodes that no sample touches follow their neighbors.
    CubeSolverOptions options;
    options.evenness = 1e-3;
    CubeSolver solver(5, {}, options);
    for (int r = 0; r <= 4; ++r) {
        for (int g = 0; g <= 4; ++g) {
            for (int b = 0; b <= 4; ++b) {
                if (r == 2 && g == 2 && b == 2) continue;
                const Vector3 place = {r / 4.0, g / 4.0, b / 4.0};
                solver.add(place, place, 1);
            }
        }
    }
    solver.sort_samples();
    CubeNodes nodes = identity(5);
    const std::size_t middle = 3 * (2 * 25 + 2 * 5 + 2);
    for (std::size_t c = 0; c < 3; ++c)
        nodes[middle + c] = 0;
    solver.solve(nodes, 4);
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(nodes[middle + c], 0.5, 1e-3);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
