// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tonewright/color.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A 3D LUT over display-linear that inverts a pipeline.
struct InverseCubeProblem {
    /// Nodes along each axis.
    int edge = 37;
    /// Display-linear -> position on the axes, in [0, 1]; of input 0.
    Expr place = Expr::input();
    /// Display-linear -> a code whose distances are nearly perceptual; of input 0.
    Expr code = Expr::input();
    /// Scene-linear -> value of the nodes, about [0, 1], in which the inverse is smooth.
    Pipeline before;
    /// Value of the nodes -> display-linear.
    Pipeline forward;
    /// Primaries of the scene: the inverse covers colors of these primaries and of Rec.709.
    Primaries primaries = kRec709;
};

/// The best nodes for the round trip: least squares, over display colors that the pipeline
/// produces, of the difference between their codes and those of forward(lut(color)). A 3D LUT
/// sampled from the exact inverse has an error proportional to the slope of the inverse; this one
/// minimizes the visible error.
///
/// Gauss-Newton, starting from the solution for grays. Unreached nodes continue smoothly, drawn to
/// the nearest code. The inverse of black is the node value of black. The same nodes on every run.
/// @returns RGB at the nodes, blue fastest, as fit_cube().
[[nodiscard]] TONEWRIGHT_API std::vector<double> fit_inverse_cube(
    const InverseCubeProblem& problem);

TONEWRIGHT_NAMESPACE_END
