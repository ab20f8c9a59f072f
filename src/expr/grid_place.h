// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Tetrahedron of a position: four nodes, starting with the one nearest to the origin. Each next
/// node is one step along another coordinate, in the order of the fractions.
struct GridPlace {
    std::array<std::size_t, 4> node{};
    std::array<double, 4> weight{};
    std::array<std::size_t, 3> axis{0, 1, 2};
    std::array<double, 3> fraction{};  // of a step, along each coordinate

    /// The last coordinate runs fastest.
    GridPlace(int edge, const std::array<double, 3>& at) noexcept
        : GridPlace(static_cast<std::size_t>(edge), at,
                    {static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge),
                     static_cast<std::size_t>(edge), 1}) {}
    /// @param n       nodes along each coordinate
    /// @param at      limited to [0, 1], NaN to 0
    /// @param stride  distance of neighboring nodes along each coordinate
    GridPlace(std::size_t n, const std::array<double, 3>& at,
              const std::array<std::size_t, 3>& stride) noexcept {
        std::size_t corner = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const double t = at[i] > 0 ? (at[i] < 1 ? at[i] : 1.0) : 0.0;
            const double place = t * static_cast<double>(n - 1);
            const std::size_t cell = std::min(static_cast<std::size_t>(place), n - 2);
            fraction[i] = place - static_cast<double>(cell);
            corner += cell * stride[i];
        }
        const auto order = [&](std::size_t i, std::size_t k) {
            if (fraction[axis[i]] < fraction[axis[k]]) std::swap(axis[i], axis[k]);
        };
        order(0, 1);
        order(1, 2);
        order(0, 1);
        node[0] = corner;
        weight[0] = 1 - fraction[axis[0]];
        for (std::size_t i = 0; i < 3; ++i) {
            node[i + 1] = node[i] + stride[axis[i]];
            weight[i + 1] = fraction[axis[i]] - (i < 2 ? fraction[axis[i + 1]] : 0.0);
        }
    }

    /// @param channel  of the first node; the next node is three numbers later.
    [[nodiscard]] double interpolate(const double* channel) const noexcept {
        double sum = 0;
        for (std::size_t i = 0; i < 4; ++i)
            sum += weight[i] * channel[3 * node[i]];
        return sum;
    }
    /// Grid::gradient().
    /// @param at  the position
    [[nodiscard]] std::array<double, 3> gradient(const double* channel, int edge,
                                                 const std::array<double, 3>& at) const noexcept {
        std::array<double, 3> slope{};
        for (std::size_t i = 0; i < 3; ++i) {
            if (!(at[axis[i]] > 0 && at[axis[i]] < 1)) continue;
            slope[axis[i]] = (channel[3 * node[i + 1]] - channel[3 * node[i]]) * (edge - 1);
        }
        return slope;
    }
};

TONEWRIGHT_NAMESPACE_END
