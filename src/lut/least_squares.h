// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Solves linear equations with a symmetric matrix by conjugate gradients, until the residual is
/// 1e-4 of its first size. The caller keeps the vectors: the order of their sums decides the last
/// digits.
/// @param residual_square  -> square of the residual, weighted by the preconditioner
/// @param turn             sets the direction to the preconditioned residual plus a share of the
///                         last direction; -> product of the direction with its image
/// @param advance          a length along the direction: changes the solution and the residual
template <class Square, class Turn, class Advance>
void conjugate_gradients(int most_steps, const Square& residual_square, const Turn& turn,
                         const Advance& advance) {
    double size = residual_square();
    const double enough = 1e-8 * size;
    float share = 0;
    for (int step = 0; step < most_steps && size > enough; ++step) {
        advance(static_cast<float>(size / turn(share)));
        const double next = residual_square();
        share = static_cast<float>(next / size);
        size = next;
    }
}

/// Least squares of nodes on a line with linear interpolation between them; the first node is
/// known. The grays of a 3D LUT are such a line: the edge between the nodes of two grays is an edge
/// of tetrahedra, so no other node affects a gray.
class LineFit {
  public:
    /// @param pull  weight of the squared change of a node; one sample at a node has weight 1
    LineFit(std::size_t node_count, double pull)
        : diagonal_(node_count, pull), beside_(node_count, 0.0), right_(node_count, 0.0) {}

    /// @param node     the sample is at (1 - t) of it and t of the next one
    /// @param missing  wanted change of the sample
    void add(std::size_t node, double t, double missing, double weight = 1) {
        diagonal_[node] += weight * (1 - t) * (1 - t);
        beside_[node] += weight * t * (1 - t);
        diagonal_[node + 1] += weight * t * t;
        right_[node] += weight * (1 - t) * missing;
        right_[node + 1] += weight * t * missing;
    }

    /// Calls change(node, difference) for each node but the first. The equations are used up.
    template <class F>
    void solve(const F& change) {
        const std::size_t n = right_.size();
        for (std::size_t i = 2; i < n; ++i) {
            const double ratio = beside_[i - 1] / diagonal_[i - 1];
            diagonal_[i] -= ratio * beside_[i - 1];
            right_[i] -= ratio * right_[i - 1];
        }
        double above = 0;
        for (std::size_t i = n - 1; i > 0; --i) {
            above = (right_[i] - beside_[i] * above) / diagonal_[i];
            change(i, above);
        }
    }

  private:
    // A tridiagonal matrix, and the right side.
    std::vector<double> diagonal_;
    std::vector<double> beside_;
    std::vector<double> right_;
};

TONEWRIGHT_NAMESPACE_END
