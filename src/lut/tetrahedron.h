// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "expr/grid_place.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// GridPlace in 20 bytes, for millions of samples.
struct Tetrahedron {
    std::uint32_t cell;   // the node at the near corner of its cell
    std::uint8_t second;  // the next two corners, as masks of steps: red 4, green 2, blue 1
    std::uint8_t third;
    std::array<float, 3> weight;  // of the second, the third and the far corner
};

/// @param place  limited to [0, 1] along each axis.
/// @param edge   nodes a side, blue fastest.
[[nodiscard]] inline Tetrahedron tetrahedron_at(const double* place, std::size_t edge) {
    const GridPlace at(static_cast<int>(edge), {place[0], place[1], place[2]});
    const auto fraction = [&](std::size_t k) {
        return static_cast<float>(at.fraction[at.axis[k]]);
    };
    return {static_cast<std::uint32_t>(at.node[0]),
            static_cast<std::uint8_t>(4U >> at.axis[0]),
            static_cast<std::uint8_t>(7U ^ 4U >> at.axis[2]),
            {fraction(0) - fraction(1), fraction(1) - fraction(2), fraction(2)}};
}

/// Distances from a node to those at each mask of steps.
using NodeSteps = std::array<std::size_t, 8>;
[[nodiscard]] constexpr NodeSteps node_steps(std::size_t edge) {
    NodeSteps steps{};
    for (std::size_t mask = 0; mask < 8; ++mask)
        steps[mask] = ((mask >> 2 & 1) * edge + (mask >> 1 & 1)) * edge + (mask & 1);
    return steps;
}

struct Corner {
    unsigned mask;
    std::size_t node;
    float weight;
};

/// From the near corner to the far one: the mask of each holds that of the one before.
[[nodiscard]] inline std::array<Corner, 4> corners_of(const Tetrahedron& t,
                                                      const NodeSteps& steps) {
    const auto [second, third, far] = t.weight;
    return {{{0, t.cell, 1 - second - third - far},
             {t.second, t.cell + steps[t.second], second},
             {t.third, t.cell + steps[t.third], third},
             {7, t.cell + steps[7], far}}};
}

/// Sorts samples by cell, so that additions to a matrix of nodes stay in the processor's cache.
/// Samples of one cell keep their order.
template <class Sample>
[[nodiscard]] std::vector<Sample> sorted_by_cell(const std::vector<Sample>& samples,
                                                 std::size_t node_count) {
    std::vector<std::size_t> next(node_count + 1, 0);
    for (const Sample& sample : samples)
        ++next[sample.cell + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    std::vector<Sample> sorted(samples.size());
    for (const Sample& sample : samples)
        sorted[next[sample.cell]++] = sample;
    return sorted;
}

TONEWRIGHT_NAMESPACE_END
