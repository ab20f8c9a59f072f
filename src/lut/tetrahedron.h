// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Position in a grid of nodes with tetrahedral interpolation.
struct Tetrahedron {
    std::uint32_t cell;   // the node at the near corner of its cell
    std::uint8_t second;  // the next two corners, as masks of steps: red 4, green 2, blue 1
    std::uint8_t third;
    std::array<float, 3> weight;  // of the second, the third and the far corner
};

/// @param place  clamped to [0, 1] along each axis.
/// @param edge   nodes a side, blue fastest.
[[nodiscard]] inline Tetrahedron tetrahedron_at(const double* place, std::size_t edge) {
    std::array<std::size_t, 3> corner{};
    std::array<float, 3> f{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double position = std::clamp(place[c], 0.0, 1.0) * static_cast<double>(edge - 1);
        corner[c] = std::min(static_cast<std::size_t>(position), edge - 2);
        f[c] = static_cast<float>(position - static_cast<double>(corner[c]));
    }
    // From the near corner to the far one along the axes, largest fraction first.
    std::array<std::size_t, 3> order = {0, 1, 2};
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return f[a] > f[b]; });
    Tetrahedron t{};
    t.cell = static_cast<std::uint32_t>((corner[0] * edge + corner[1]) * edge + corner[2]);
    t.second = static_cast<std::uint8_t>(4U >> order[0]);
    t.third = static_cast<std::uint8_t>(7U ^ 4U >> order[2]);
    t.weight = {f[order[0]] - f[order[1]], f[order[1]] - f[order[2]], f[order[2]]};
    return t;
}

/// Distance from a node to the one at a mask of steps.
[[nodiscard]] constexpr std::size_t node_step(std::size_t mask, std::size_t edge) {
    return ((mask >> 2 & 1) * edge + (mask >> 1 & 1)) * edge + (mask & 1);
}

TONEWRIGHT_NAMESPACE_END
