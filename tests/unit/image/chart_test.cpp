// SPDX-License-Identifier: Apache-2.0
#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "tonewright/chart.h"

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
            // The continuous ramp below has the same value at the patch's centre, within half a
            // pixel of 60 to the stop.
            const auto below = static_cast<double>(chart.getchannel(x, 150, 0, c));
            EXPECT_NEAR(std::log2(below / expected), 0, 1 / 59.0) << s;
        }
    }
}

TEST(Chart, HoldsWhatItsTitlesSay) {
    const ImageBuf chart = make_chart();
    const auto stats = OIIO::ImageBufAlgo::computePixelStats(chart);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(stats.nancount[c], 0U);
        EXPECT_EQ(stats.infcount[c], 0U);
    }
    // Wide-gamut patches: Rec.2020 cyan has a red of -0.5876411 - 0.0728499 in Rec.709 (ITU-R
    // BT.2087), 6 stops above mid grey.
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
        EXPECT_STREQ(e.what(), "chart: width is 0; expected [320, 16384] pixels");
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
