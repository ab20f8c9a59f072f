// SPDX-License-Identifier: Apache-2.0
#include "tonewright/lut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.h"
#include "unit/lut/lut_cases.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// size^3 triplets, red fastest, of f(r, g, b) at the nodes.
template <class F>
Lut cube_of(int size, const F& f) {
    Lut lut;
    lut.size = size;
    for (int b = 0; b < size; ++b) {
        for (int g = 0; g < size; ++g) {
            for (int r = 0; r < size; ++r) {
                const double last = size - 1;
                for (const double y : f(Vector3{r / last, g / last, b / last}))
                    lut.values.push_back(static_cast<float>(y));
            }
        }
    }
    return lut;
}

void expect_near(const Vector3& actual, const Vector3& expected, double tolerance,
                 const Vector3& at) {
    for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_NEAR(actual[c], expected[c], tolerance)
            << "channel " << c << " of (" << at[0] << ", " << at[1] << ", " << at[2] << ")";
    }
}

TEST(Interpolate, IdentityCubeIsExact) {
    // Sixteenths are floats, so what is left is double rounding.
    const Lut lut = cube_of(17, [](const Vector3& v) { return v; });
    for (const Vector3& v : table_inputs(5000)) {
        expect_near(interpolate(lut, v), v, 1e-15, v);
        expect_near(interpolate(lut, v, LutInterpolation::trilinear), v, 1e-15, v);
    }
}

TEST(Interpolate, TetrahedralReproducesAffineFunctions) {
    // Different in every channel and every direction: a swapped axis or channel shows. The
    // coefficients are dyadic, so the nodes are exact floats.
    const auto f = [](const Vector3& v) {
        return Vector3{0.5 * v[0] + 0.25 * v[1] - 0.125 * v[2] + 1,
                       2 * v[0] - 0.75 * v[1] + 0.0625 * v[2],
                       -1.5 * v[0] + 0.375 * v[1] + 4 * v[2] - 0.25};
    };
    const Lut lut = cube_of(33, f);
    for (const Vector3& v : table_inputs(5000))
        expect_near(interpolate(lut, v), f(v), 1e-14, v);
}

TEST(Interpolate, AxesAreNotSwapped) {
    const auto f = [](const Vector3& v) { return Vector3{v[0], v[1] * v[1], std::sqrt(v[2])}; };
    const Lut lut = cube_of(17, f);
    // Node (r, g, b) = (1, 4, 9) sixteenths.
    const Vector3 node = {1 / 16.0, 4 / 16.0, 9 / 16.0};
    expect_near(interpolate(lut, node), {1 / 16.0, 1 / 16.0, 3 / 4.0}, 1e-15, node);
    // Red is fastest: the entry after the first is red's.
    const Lut red = cube_of(3, [](const Vector3& v) { return Vector3{v[0], 0, 0}; });
    EXPECT_EQ(red.values[3], 0.5F);
    EXPECT_EQ(interpolate(red, {0.5, 0, 0})[0], 0.5);
    EXPECT_EQ(interpolate(red, {0, 0.5, 1})[0], 0);
}

TEST(Interpolate, TrilinearAndTetrahedralAgreeAtNodes) {
    SampleRandom random(22);
    const Lut lut = cube_of(17, [&](const Vector3&) {
        return Vector3{random.uniform(-1, 2), random.uniform(-1, 2), random.uniform(-1, 2)};
    });
    double apart = 0;
    for (std::size_t node = 0; node < 17 * 17 * 17; ++node) {
        const Vector3 v = {static_cast<double>(node % 17) / 16,
                           static_cast<double>(node / 17 % 17) / 16,
                           static_cast<double>(node / 289) / 16};
        const Vector3 tetrahedral = interpolate(lut, v);
        ASSERT_EQ(tetrahedral, interpolate(lut, v, LutInterpolation::trilinear));
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_EQ(tetrahedral[c], static_cast<double>(lut.values[3 * node + c]));
        }
        const Vector3 between = {v[0] * 0.9, v[1] * 0.9, v[2] * 0.9};
        apart =
            std::max(apart, std::fabs(interpolate(lut, between)[0] -
                                      interpolate(lut, between, LutInterpolation::trilinear)[0]));
    }
    EXPECT_GT(apart, 0.1) << "between nodes they are two things";
}

TEST(Interpolate, WeightsAreThoseOfTheirDefinitions) {
    // One cell with one corner at 1. Tetrahedral: with x >= y >= z the sorted fractions, the near
    // corner weighs 1-x, the one along x weighs x-y, the one along x and y weighs y-z, the far z.
    for (std::size_t corner = 0; corner < 8; ++corner) {
        Lut lut;
        lut.size = 2;
        lut.values.assign(24, 0.0F);
        for (std::size_t c = 0; c < 3; ++c)
            lut.values[3 * corner + c] = 1;
        for (const Vector3& v : table_inputs(300)) {
            double lowest_inside = 1;    // smallest fraction of the axes that the corner has
            double highest_outside = 0;  // largest of those that it has not
            double trilinear = 1;
            for (std::size_t c = 0; c < 3; ++c) {
                const bool has = (corner >> c & 1) != 0;
                if (has) lowest_inside = std::min(lowest_inside, v[c]);
                if (!has) highest_outside = std::max(highest_outside, v[c]);
                trilinear *= has ? v[c] : 1 - v[c];
            }
            const double tetrahedral = std::max(0.0, lowest_inside - highest_outside);
            ASSERT_NEAR(interpolate(lut, v)[1], tetrahedral, 1e-15) << "corner " << corner;
            ASSERT_NEAR(interpolate(lut, v, LutInterpolation::trilinear)[1], trilinear, 1e-15)
                << "corner " << corner;
        }
    }
}

TEST(Interpolate, HoldsTheEndsOfTheDomain) {
    const Lut cube = cube_of(17, [](const Vector3& v) { return v; });
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(interpolate(cube, {-3, 2, nan}), (Vector3{0, 1, 0}));
    EXPECT_EQ(interpolate(cube, {-kInfinity, kInfinity, 1}), (Vector3{0, 1, 1}));
    Lut curve;
    curve.dimension = 1;
    curve.size = 3;
    curve.channels = 1;
    curve.values = {0, 0.5F, 2};
    EXPECT_EQ(interpolate(curve, {-1, 2, nan}), (Vector3{0, 2, 0}));
    EXPECT_EQ(interpolate(curve, {0.25, 0.5, 0.75}), (Vector3{0.25, 0.5, 1.25}));
}

TEST(Interpolate, CurvesMayDifferByChannel) {
    Lut lut;
    lut.dimension = 1;
    lut.size = 2;
    lut.channels = 3;
    lut.values = {0, 1, 2, 10, 11, 12};
    EXPECT_EQ(interpolate(lut, {0.5, 0.5, 0.5}), (Vector3{5, 6, 7}));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
