// SPDX-License-Identifier: Apache-2.0
#include "image/chart_scene.h"

#include <OpenImageIO/imagebuf.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "measure/chart_colors.h"
#include "tonewright/chart.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr Rgb kBefore = {-1, -1, -1};

float largest(const OIIO::ImageBuf& picture, int* non_finite = nullptr) {
    float most = 0;
    for (OIIO::ImageBuf::ConstIterator<float> it(picture); !it.done(); ++it) {
        for (int c = 0; c < 3; ++c) {
            most = std::max(most, it[c]);
            if (non_finite) *non_finite += !std::isfinite(it[c]);
        }
    }
    return most;
}

void expect_color(const Rgb& actual, const Vector3& expected, double relative) {
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(actual[c], expected[c], relative * expected[c] + 1e-6) << "channel " << c;
}

/// Every pixel of the rectangle is drawn, and no other one.
void expect_drawn(Canvas& canvas, int x0, int y0, int x1, int y1) {
    for (int y = 0; y < canvas.height(); ++y) {
        for (int x = 0; x < canvas.width(); ++x) {
            const bool is_inside = x >= x0 && x < x1 && y >= y0 && y < y1;
            EXPECT_EQ(canvas.at(x, y) != kBefore, is_inside) << x << " " << y;
        }
    }
}

TEST(ChartScene, HasTheLightThatItsHeaderStates) {
    // The sun is 2000; highlights are at most 500.
    const OIIO::ImageBuf chart = make_chart(768, 432);
    int wrong = 0;
    EXPECT_GE(largest(chart, &wrong), 500);
    EXPECT_LE(largest(chart), 2000 * 1.001F) << "and the rounding of float";
    EXPECT_EQ(wrong, 0) << "no NaN and no infinity; colors outside Rec.709 are negative";
}

TEST(ChartScene, TheSunsetHasItsSunItsSkyAndItsHills) {
    Canvas canvas(220, 110, kBefore);
    draw_sunset(canvas, 10, 5, 210, 105);
    expect_drawn(canvas, 10, 5, 210, 105);
    // The sun stands at 0.66 of the width and 0.60 of the height, in front of the sky.
    expect_color(canvas.at(10 + 132, 5 + 60), {2000, 1450, 760}, 1e-6);
    const Rgb& sky = canvas.at(20, 6);
    EXPECT_GT(sky[2], sky[0]) << "blue above, far from the sun";
    const Rgb& glow = canvas.at(10 + 132, 5 + 40);
    EXPECT_GT(glow[0], glow[2]) << "red near the sun";
    EXPECT_GT(glow[0], sky[0]);
    for (const int x : {10, 110, 209})
        expect_color(canvas.at(x, 104), {0.006, 0.005, 0.007}, 1e-6);
}

/// Pixel at which the camera of the spheres sees a point: from (0, 1.9, -7.2) towards (0, 0.92, 0),
/// with a frame of +-0.24 of the distance in height.
std::array<int, 2> pixel_of(const Vector3& point, int width, int height) {
    const double length = std::hypot(0.98, 7.2);
    const double down = 0.98 / length;
    const double ahead = 7.2 / length;
    const double y = point[1] - 1.9;
    const double z = point[2] + 7.2;
    const double distance = ahead * z - down * y;
    const double right = point[0] / distance / (0.24 * width / height);
    const double above = (ahead * y + down * z) / distance / 0.24;
    return {static_cast<int>((1 + right) / 2 * width), static_cast<int>((1 - above) / 2 * height)};
}

TEST(ChartScene, TheSpheresShineInTheColorsOfTheirLamps) {
    constexpr int kWidth = 400;
    constexpr int kHeight = 200;
    Canvas canvas(kWidth, kHeight + 4, kBefore);
    draw_spheres(canvas, 0, 2, kWidth, kHeight + 2);
    expect_drawn(canvas, 0, 2, kWidth, kHeight + 2);
    const std::array<Vector3, 4> centers = {
        {{-2, 1.72, 0.9}, {-0.68, 1.86, 1.1}, {0.68, 1.86, 1.1}, {2, 1.72, 0.9}}};
    for (std::size_t i = 0; i < centers.size(); ++i) {
        SCOPED_TRACE(i);
        const auto [x, y] = pixel_of(centers[i], kWidth, kHeight);
        // The light of a lamp falls with the power 1.5 of the cosine: by a percent in a pixel.
        expect_color(canvas.at(x, y + 2), kLamps[i], 0.01);
    }
    // The gray card is matt and in the light of the key, 2.3 at most, and of the sky.
    const auto [x, y] = pixel_of({-2.5, 0.58, 0.15}, kWidth, kHeight);
    const Rgb& card = canvas.at(x, y + 2);
    EXPECT_GT(card[0], 0.18 * 0.5);
    EXPECT_LT(card[0], 0.18 * 3);
    float most = 0;
    for (int row = 2; row < kHeight + 2; ++row) {
        for (int column = 0; column < kWidth; ++column) {
            for (const float c : canvas.at(column, row)) {
                ASSERT_TRUE(std::isfinite(c) && c >= 0) << column << " " << row;
                most = std::max(most, c);
            }
        }
    }
    // The mean of nine samples of a highlight of 500 and what the mirror shows behind it.
    EXPECT_GT(most, 60) << "brighter than all lamps";
    EXPECT_LT(most, 510);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
