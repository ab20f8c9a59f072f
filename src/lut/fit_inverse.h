// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tonewright/color.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A cube over light that leads back through a pipeline.
struct InverseCubeProblem {
    /// Nodes along each axis.
    int edge = 37;
    /// Light -> place on the axes, in [0, 1]; of input 0.
    Expr place = Expr::input();
    /// Light -> a code whose distances are nearly what the eye sees; of input 0.
    Expr code = Expr::input();
    /// The scene -> what the nodes hold: numbers of about [0, 1], in which the inverse is smooth.
    Pipeline before;
    /// What the nodes hold -> light.
    Pipeline forward;
    /// Of the scene: the lights that come from colors of these and of Rec.709 are to come back.
    Primaries primaries = kRec709;
};

/// The nodes that are best at leading back: least squares, over lights that the pipeline makes, of
/// the difference between their codes and those of forward(cube(light)). A cube sampled from the
/// exact inverse errs where the inverse is steep, and by that slope; this one errs by what is seen.
///
/// Gauss and Newton's method, from what grays need on. Between the nodes that no light reaches the
/// cube goes on evenly, drawn to what is nearest in code. Black comes back as what the nodes hold
/// of black. The same nodes on every run.
/// @returns RGB at the nodes, blue fastest, as fit_cube().
[[nodiscard]] TONEWRIGHT_API std::vector<double> fit_inverse_cube(
    const InverseCubeProblem& problem);

TONEWRIGHT_NAMESPACE_END
