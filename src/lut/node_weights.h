// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "tonewright/color.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Nodes of a 3D LUT for the interpolation of a color. Red fastest.
struct NodeWeights {
    std::array<std::size_t, 8> node;
    std::array<double, 8> weight;
    std::size_t count;  // 4 in tetrahedra, 8 trilinear
};

/// @param rgb   clamped to [0, 1], NaN to 0
/// @param edge  nodes a side
[[nodiscard]] inline NodeWeights node_weights(const Vector3& rgb, std::size_t edge,
                                              LutInterpolation interpolation) {
    std::array<std::size_t, 3> corner{};
    std::array<double, 3> f{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double position =
            (rgb[c] > 0 ? std::min(rgb[c], 1.0) : 0.0) * static_cast<double>(edge - 1);
        corner[c] = std::min(static_cast<std::size_t>(position), edge - 2);
        f[c] = position - static_cast<double>(corner[c]);
    }
    NodeWeights weights{};
    const auto add = [&](const std::array<std::size_t, 3>& step, double weight) {
        weights.node[weights.count] =
            ((corner[2] + step[2]) * edge + corner[1] + step[1]) * edge + corner[0] + step[0];
        weights.weight[weights.count] = weight;
        ++weights.count;
    };
    if (interpolation == LutInterpolation::trilinear) {
        for (std::size_t i = 0; i < 8; ++i) {
            double weight = 1;
            const std::array<std::size_t, 3> step = {i & 1, i >> 1 & 1, i >> 2 & 1};
            for (std::size_t c = 0; c < 3; ++c)
                weight *= step[c] ? f[c] : 1 - f[c];
            add(step, weight);
        }
        return weights;
    }
    // Tetrahedral: from the near corner to the far one along the axes, largest fraction first.
    std::array<std::size_t, 3> order = {0, 1, 2};
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return f[a] > f[b]; });
    std::array<std::size_t, 3> step{};
    add(step, 1 - f[order[0]]);
    for (std::size_t k = 0; k < 3; ++k) {
        step[order[k]] = 1;
        add(step, f[order[k]] - (k < 2 ? f[order[k + 1]] : 0));
    }
    return weights;
}

TONEWRIGHT_NAMESPACE_END
