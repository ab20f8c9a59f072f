// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "expr/grid_place.h"
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
    const bool trilinear = interpolation == LutInterpolation::trilinear;
    const GridPlace place(edge, rgb, {1, edge, edge * edge});
    NodeWeights weights{};
    weights.count = trilinear ? 8 : 4;
    if (!trilinear) {
        std::copy(place.node.begin(), place.node.end(), weights.node.begin());
        std::copy(place.weight.begin(), place.weight.end(), weights.weight.begin());
        return weights;
    }
    for (std::size_t i = 0; i < weights.count; ++i) {
        weights.node[i] = place.node[0] + (i & 1) + ((i >> 1 & 1) + (i >> 2 & 1) * edge) * edge;
        weights.weight[i] = 1;
        for (std::size_t c = 0; c < 3; ++c)
            weights.weight[i] *= i >> c & 1 ? place.fraction[c] : 1 - place.fraction[c];
    }
    return weights;
}

TONEWRIGHT_NAMESPACE_END
