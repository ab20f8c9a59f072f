// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "engine/gradient.h"
#include "lut/tetrahedron.h"
#include "tonewright/color.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// RGB at the nodes of a 3D LUT, blue fastest.
using CubeNodes = std::vector<double>;

/// Wanted color of a 3D LUT at one position.
struct CubeSample : Tetrahedron {
    float root_weight;                             // square root of its weight
    std::array<float, 3> code;                     // wanted after the 3D LUT
    std::array<float, 3> missing;                  // current residual of the code
    std::array<std::array<float, 3>, 3> gradient;  // d code / d color of the 3D LUT
};

struct CubeSolverOptions {
    /// Weight of the squared second differences between nodes, where one sample at a node counts 1.
    double evenness = 0;
    /// Keeps a step finite where neither samples nor smoothness determine a node.
    double damping = 1e-6;
    /// Fixed nodes.
    std::vector<std::size_t> held = {};
    /// 0: one per hardware thread. The nodes do not depend on it.
    unsigned thread_count = 0;
};

/// Finds the nodes of a 3D LUT for the best result of a pipeline after its tetrahedral
/// interpolation: Gauss-Newton, with linear equations solved by conjugate gradients. The same nodes
/// on every run.
///
/// The normal matrix connects a node with the seven that share an edge of a tetrahedron above it
/// and with seven below, so it has eight blocks of 3 x 3 numbers per node, for any number of
/// samples.
class TONEWRIGHT_API CubeSolver {
  public:
    /// @param forward  color of the 3D LUT -> code values whose distances are nearly perceptual
    CubeSolver(int edge, const Pipeline& forward, CubeSolverOptions options);

    void reserve(std::size_t count) { samples_.reserve(count); }
    void add(const Vector3& place, const Vector3& code, double weight);
    [[nodiscard]] std::vector<CubeSample>& samples() { return samples_; }
    /// Call after the last add().
    void sort_samples() { samples_ = sorted_by_cell(samples_, node_count_); }

    [[nodiscard]] std::array<float, 3> shown(const CubeNodes& nodes, const CubeSample& s) const;
    /// Sets the residual of each code value, and its derivative by the color of the 3D LUT.
    void linearize(const CubeNodes& nodes);
    /// One step from the state that linearize() set.
    void improve(CubeNodes& nodes) const;
    /// Repeats linearize() and step().
    void solve(CubeNodes& nodes, int rounds);

  private:
    using Block = std::array<float, 6>;  // of a symmetric matrix: 00, 01, 02, 11, 12, 22
    using Vector = std::vector<std::array<float, 3>>;  // padded, so that neighbors can be read

    struct Matrix {
        std::array<std::vector<Block>, 8> blocks;  // from node i to the one that many steps above
        Vector right;
    };

    template <class F>
    void over_nodes(const F& f) const;
    [[nodiscard]] Matrix add_up() const;
    void add_sample(const CubeSample& s, Matrix& m) const;
    void add_evenness(const Vector& x, Vector& out, double sign) const;
    void multiply_by(const Matrix& m, const Vector& x, Vector& out) const;
    void hold(Vector& x) const;
    [[nodiscard]] Vector make_vector() const { return Vector(node_count_ + 2 * pad_); }

    std::size_t n_;
    std::size_t node_count_;
    std::size_t pad_;
    GradientEngine code_;  // of the 3D LUT's color
    CubeSolverOptions options_;
    NodeSteps step_;
    std::vector<CubeSample> samples_;
};

TONEWRIGHT_NAMESPACE_END
