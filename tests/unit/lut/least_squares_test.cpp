// SPDX-License-Identifier: Apache-2.0
#include "lut/least_squares.h"

#include <gtest/gtest.h>

#include <array>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(ConjugateGradients, SolveInAsManyStepsAsThereAreUnknowns) {
    const std::array<std::array<double, 3>, 3> matrix = {{{4, 1, 0}, {1, 3, -1}, {0, -1, 2}}};
    const std::array<double, 3> wanted = {1, -2, 3};
    const auto image_of = [&](const std::array<double, 3>& x) {
        std::array<double, 3> y{};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 3; ++k)
                y[i] += matrix[i][k] * x[k];
        }
        return y;
    };
    const auto product = [](const std::array<double, 3>& a, const std::array<double, 3>& b) {
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    };
    std::array<double, 3> x{};
    std::array<double, 3> residual = image_of(wanted);
    std::array<double, 3> direction{};
    std::array<double, 3> image{};
    int steps = 0;
    conjugate_gradients(
        10, [&] { return product(residual, residual); },
        [&](float share) {
            ++steps;
            for (std::size_t i = 0; i < 3; ++i)
                direction[i] = residual[i] + static_cast<double>(share) * direction[i];
            image = image_of(direction);
            return product(direction, image);
        },
        [&](float length) {
            for (std::size_t i = 0; i < 3; ++i) {
                x[i] += static_cast<double>(length) * direction[i];
                residual[i] -= static_cast<double>(length) * image[i];
            }
        });
    EXPECT_LE(steps, 4);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(x[i], wanted[i], 1e-3);
}

TEST(LineFit, FindsAStraightLineFromItsKnownFirstNode) {
    std::array<double, 5> nodes = {2, 0, 0, 0, 0};
    LineFit line(nodes.size(), 1e-9);
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
        for (const double t : {0.25, 0.75}) {
            const double wanted = 2 + 3 * (static_cast<double>(i) + t);
            line.add(i, t, wanted - (1 - t) * nodes[i] - t * nodes[i + 1]);
        }
    }
    line.solve([&](std::size_t i, double change) { nodes[i] += change; });
    for (std::size_t i = 0; i < nodes.size(); ++i)
        EXPECT_NEAR(nodes[i], 2 + 3 * static_cast<double>(i), 1e-7) << i;
}

TEST(LineFit, WeightsDecideBetweenSamplesThatContradictEachOther) {
    double node = 0;
    LineFit line(2, 0);
    line.add(0, 1, 1, 3);
    line.add(0, 1, 5, 1);
    line.solve([&](std::size_t, double change) { node += change; });
    EXPECT_NEAR(node, 2, 1e-12);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
