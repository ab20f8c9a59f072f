// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "tonewright/color.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Where light stands on each of the three axes of a cube.
struct CubeAxis {
    /// Light in [0, top] -> place in [0, 1], rising, 0 at 0; of input 0.
    Expr place = Expr::input();
    /// Its inverse.
    Expr light = Expr::input();
    double top = 1;
};

/// The logarithm of light with a linear toe, log2(x + 0.01): no floor above black, equal steps in
/// stops above the toe. Equal steps are worth more than short ones where the operator bends: along
/// the diagonals of the cells only the exposure changes, so whatever an operator does to a hue or a
/// chroma at any exposure is followed by the same edges.
/// @param edge             of the cube.
/// @param share_of_lights  of an axis that reaches further than 64, what is for the lights above,
///                         in longer steps; 64 is a node. 0: equal steps everywhere.
[[nodiscard]] TONEWRIGHT_API CubeAxis make_log_axis(double top, int edge,
                                                    double share_of_lights = 0);

/// What a cube stands for.
struct CubeProblem {
    /// Nodes along each axis.
    int edge = 65;
    CubeAxis axis;
    /// Light >= 0 -> what the nodes hold: a smooth code, not clipped, whose distances are nearly
    /// what the eye sees.
    Pipeline pipeline;
    /// Of the light.
    Primaries primaries = kRec709;
    /// The codes beyond which nothing is seen, because what is behind the cube clips.
    double lo = -kInfinity;
    double hi = kInfinity;
};

/// The share of make_log_axis() that suits the pipeline best, @see choose_log_axis.
[[nodiscard]] TONEWRIGHT_API double choose_share_of_lights(const CubeProblem& problem, double top);

/// The logarithmic axis that suits the pipeline best, by the errors of sampled cubes of 33 nodes a
/// side: with longer steps for the lights where the operator has little left to do above 64.
/// @param problem  its axis is not read.
[[nodiscard]] TONEWRIGHT_API CubeAxis choose_log_axis(const CubeProblem& problem, double top);

struct CubeFitOptions {
    /// Twice as many gain a few hundredths.
    double samples_per_node = 10;
    /// Of 64 bytes.
    std::size_t largest_sample_count = 4000000;
    /// 0: as many as the machine has. The nodes do not depend on it.
    unsigned thread_count = 0;
};

/// RGB at the nodes, blue fastest: nodes[3 * ((r * edge + g) * edge + b) + c], in double from the
/// reference.
[[nodiscard]] TONEWRIGHT_API std::vector<double> sample_cube(const CubeProblem& problem);

/// The nodes whose tetrahedral interpolation is nearest to the pipeline: least squares of the seen
/// differences over colors that are like those of pictures and beyond, from the sampled nodes on.
///
/// A sampled cube is exact at its nodes and errs to one side between them, where the operator bends
/// one way; a fitted one errs to both sides, half as much. Grays are fitted first, on their own, so
/// they stay as neutral as the operator makes them; black stays what it is. Nodes that no color
/// needs stay as sampled. The same nodes on every run.
[[nodiscard]] TONEWRIGHT_API std::vector<double> fit_cube(const CubeProblem& problem,
                                                          const CubeFitOptions& options = {});

TONEWRIGHT_NAMESPACE_END
