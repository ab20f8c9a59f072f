// SPDX-License-Identifier: Apache-2.0
#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "tonewright/chart.h"
#include "tonewright/color.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;

/// Largest and smallest value of the chart's pixels [x0, x1) x [y0, y1).
std::pair<float, float> range_of(const ImageBuf& chart, int x0, int x1, int y0, int y1) {
    const auto stats = OIIO::ImageBufAlgo::computePixelStats(chart, OIIO::ROI(x0, x1, y0, y1));
    return {*std::min_element(stats.min.begin(), stats.min.end()),
            *std::max_element(stats.max.begin(), stats.max.end())};
}

TEST(Chart, EveryStopHasItsPatch) {
    const ImageBuf chart = make_chart();
    EXPECT_EQ(chart.spec().width, 1536);
    EXPECT_EQ(chart.spec().height, 864);
    EXPECT_EQ(chart.spec().format, OIIO::TypeDesc::FLOAT);
    EXPECT_EQ(chart.nchannels(), 3);
    EXPECT_EQ(chart.spec().get_string_attribute("oiio:ColorSpace"), "Linear");
    const double step = (1536 - 48) / 25.0;
    for (int s = -12; s <= 12; ++s) {
        const int x = static_cast<int>(24 + (s + 12.5) * step);
        const double expected = 0.18 * std::exp2(s);
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(chart.getchannel(x, 90, 0, c), expected, 1e-6 * expected) << s;
            // The continuous ramp below has the same value at the patch's center, within half a
            // pixel of 60 to the stop.
            const auto below = static_cast<double>(chart.getchannel(x, 150, 0, c));
            EXPECT_NEAR(std::log2(below / expected), 0, 1 / 59.0) << s;
        }
    }
}

TEST(Chart, MatchesItsTitles) {
    const ImageBuf chart = make_chart();
    const auto stats = OIIO::ImageBufAlgo::computePixelStats(chart);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(stats.nancount[c], 0U);
        EXPECT_EQ(stats.infcount[c], 0U);
    }
    // Wide-gamut patches: Rec.2020 cyan has a red of -0.5876411 - 0.0728499 in Rec.709 (ITU-R
    // BT.2087), 6 stops above mid gray.
    EXPECT_NEAR(range_of(chart, 526, 1010, 526, 724).first, -0.6604910 * 0.18 * 64, 1e-5);
    // Spheres: lights, and highlights of 500 at most where mirrors add nothing to speak of.
    const float highlights = range_of(chart, 1028, 1512, 226, 490).second;
    EXPECT_GT(highlights, 350);
    EXPECT_LT(highlights, 520);
    EXPECT_NEAR(range_of(chart, 1028, 1512, 526, 724).second, 2000, 1e-2);  // sunset
    EXPECT_NEAR(range_of(chart, 24, 508, 756, 840).first, -0.002, 1e-4);    // near black
    // Hue sweep: +10 stops at the top.
    EXPECT_NEAR(std::log2(range_of(chart, 48, 508, 226, 468).second / 0.18F), 10, 0.1);
    // White patch of the ColorChecker, sRGB 243, 243, 242.
    EXPECT_NEAR(chart.getchannel(60, 700, 0, 0), 0.896269, 1e-5);
    EXPECT_NEAR(chart.getchannel(60, 700, 0, 2), 0.887923, 1e-5);
}

TEST(Chart, PatchesHaveTheColorsOfAColorChecker) {
    // CIE L*a*b* for D50 of the 24 patches, as X-Rite publishes them for charts made before
    // November 2014.
    constexpr std::array<std::array<double, 3>, 24> kPublished = {{
        {37.986, 13.555, 14.059},  {65.711, 18.13, 17.81},    {49.927, -4.88, -21.925},
        {43.139, -13.095, 21.905}, {55.112, 8.844, -25.399},  {70.719, -33.397, -0.199},
        {62.661, 36.067, 57.096},  {40.02, 10.41, -45.964},   {51.124, 48.239, 16.248},
        {30.325, 22.976, -21.587}, {72.532, -23.709, 57.255}, {71.941, 19.363, 67.857},
        {28.778, 14.179, -50.297}, {55.261, -38.342, 31.37},  {42.101, 53.378, 28.19},
        {81.733, 4.039, 79.819},   {51.935, 49.986, -14.574}, {51.038, -28.631, -28.638},
        {96.539, -0.425, 1.186},   {81.257, -0.638, -0.335},  {66.766, -0.734, -0.504},
        {50.867, -0.153, -0.27},   {35.656, -0.421, -1.231},  {20.461, -0.079, -0.973},
    }};
    // Linear Rec.709 to XYZ for D50 by Bradford (B. Lindbloom, RGB/XYZ Matrices).
    constexpr Matrix3 kToXyz = {{{0.4360747, 0.3850649, 0.1430804},
                                 {0.2225045, 0.7168786, 0.0606169},
                                 {0.0139322, 0.0971045, 0.7141733}}};
    const ImageBuf chart = make_chart();
    for (int i = 0; i < 24; ++i) {
        const int x = 24 + (i % 6) * 484 / 6 + 40;
        const int y = 526 + (i / 6) * 198 / 4 + 25;
        Vector3 ratio{};
        for (std::size_t row = 0; row < 3; ++row) {
            for (int c = 0; c < 3; ++c)
                ratio[row] += kToXyz[row][static_cast<std::size_t>(c)] *
                              static_cast<double>(chart.getchannel(x, y, 0, c));
        }
        const Vector3 f = {std::cbrt(ratio[0] / 0.96422), std::cbrt(ratio[1]),
                           std::cbrt(ratio[2] / 0.82521)};
        const auto& lab = kPublished[static_cast<std::size_t>(i)];
        // The published 8-bit sRGB values and these are averages of different charts: up to 1.3
        // apart in lightness, and 6.3 in a* and b*. Patches differ by more than that.
        EXPECT_NEAR(116 * f[1] - 16, lab[0], 2) << i;
        EXPECT_NEAR(500 * (f[0] - f[1]), lab[1], 7) << i;
        EXPECT_NEAR(200 * (f[1] - f[2]), lab[2], 7) << i;
    }
}

TEST(Chart, IsTheSameEveryTime) {
    const ImageBuf a = make_chart(640, 360);
    const ImageBuf b = make_chart(640, 360);
    ASSERT_EQ(a.spec().image_bytes(), b.spec().image_bytes());
    EXPECT_EQ(std::memcmp(a.localpixels(), b.localpixels(), a.spec().image_bytes()), 0);
}

TEST(Chart, AnySize) {
    for (const auto& [width, height] :
         {std::pair{320, 180}, {333, 777}, {1000, 200}, {1920, 1080}}) {
        const ImageBuf chart = make_chart(width, height);
        EXPECT_EQ(chart.spec().width, width);
        EXPECT_EQ(chart.spec().height, height);
        EXPECT_GT(range_of(chart, 0, width, 0, height).second, 1000);
    }
    for (const auto& [width, height] : {std::pair{319, 180}, {320, 179}, {-1, -1}, {16385, 200}}) {
        EXPECT_THROW((void)make_chart(width, height), Error);
    }
    try {
        (void)make_chart(0, 864);
    } catch (const Error& e) {
        EXPECT_STREQ(e.what(), "width is 0; expected [320, 16384] pixels");
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
