// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "tonewright/color.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Position of a scene-linear value on each of the three axes of a 3D LUT.
struct CubeAxis {
    /// Scene-linear in [0, top] -> position in [0, 1], rising, 0 at 0; of input 0.
    Expr place = Expr::input();
    /// Its inverse.
    Expr light = Expr::input();
    double top = 1;
};

/// Logarithmic axis with a linear toe, log2(x + 0.01): black has no floor, and steps in stops are
/// equal above the toe. Equal steps fit better than short steps where the operator bends: along the
/// diagonals of the cells only the exposure changes, so the same edges follow the operator for a
/// hue and chroma at every exposure.
/// @param edge             of the 3D LUT.
/// @param share_of_lights  for an axis beyond 64, the share of the values above 64, in longer
///                         steps; 64 is a node. 0: equal steps everywhere.
[[nodiscard]] TONEWRIGHT_API CubeAxis make_log_axis(double top, int edge,
                                                    double share_of_lights = 0);

/// The function that a 3D LUT represents.
struct CubeProblem {
    /// Nodes along each axis.
    int edge = 65;
    CubeAxis axis;
    /// Scene-linear >= 0 -> value of the nodes: a smooth unclipped code whose distances are nearly
    /// perceptual.
    Pipeline pipeline;
    /// In scene-linear light.
    Primaries primaries = kRec709;
    /// Range of visible codes: a stage after the 3D LUT clips values outside.
    double lo = -kInfinity;
    double hi = kInfinity;
};

/// The best share for make_log_axis() and the pipeline, by the errors of sampled 3D LUTs with 33
/// nodes a side: above 0 if the operator changes little above 64.
/// @param problem  its axis is ignored.
[[nodiscard]] TONEWRIGHT_API double choose_share_of_lights(const CubeProblem& problem, double top);

struct CubeFitOptions {
    /// Twice as many improve the error by a few percent.
    double samples_per_node = 10;
    /// A cache line of 64 bytes.
    std::size_t largest_sample_count = 4000000;
    /// 0: one per hardware thread. The nodes do not depend on it.
    unsigned thread_count = 0;
    /// Share of colors that are drawn from photographs, [0, 1]. They count where they are dense.
    double photograph_share = 0;
    /// Changes nodes as little as possible so that they meet bounds. With it, two more steps of the
    /// fit follow, each from nodes that meet the bounds, and the result meets them, too.
    std::function<void(std::vector<double>& nodes)> constrain = {};
};

/// RGB at the nodes, blue fastest: nodes[3 * ((r * edge + g) * edge + b) + c], in double from the
/// reference.
[[nodiscard]] TONEWRIGHT_API std::vector<double> sample_cube(const CubeProblem& problem);

/// The nodes whose tetrahedral interpolation is closest to the pipeline: least squares of visible
/// differences over colors of pictures and others, starting from the sampled nodes.
///
/// A sampled 3D LUT is exact at its nodes, and its error between them has one sign where the
/// operator bends one way. The error of a fitted one has both signs and half the size. Grays are
/// fitted first and separately, so they stay as neutral as the operator makes them; black is fixed.
/// Unused nodes stay as sampled. The same nodes on every run.
[[nodiscard]] TONEWRIGHT_API std::vector<double> fit_cube(const CubeProblem& problem,
                                                          const CubeFitOptions& options = {});

TONEWRIGHT_NAMESPACE_END
