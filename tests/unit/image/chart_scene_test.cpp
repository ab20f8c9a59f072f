// SPDX-License-Identifier: Apache-2.0
#include "image/chart_scene.h"

#include <OpenImageIO/imagebuf.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tonewright/chart.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

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

TEST(ChartScene, HasTheLightThatItsHeaderStates) {
    // The sun is 2000; highlights are at most 500.
    const OIIO::ImageBuf chart = make_chart(768, 432);
    int wrong = 0;
    EXPECT_GE(largest(chart, &wrong), 500);
    EXPECT_LE(largest(chart), 2000 * 1.001F) << "and the rounding of float";
    EXPECT_EQ(wrong, 0) << "no NaN and no infinity; colors outside Rec.709 are negative";
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
