// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <vector>

#include "tonewright/local.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

ScenePlanes picture_of(int width, int height, const std::function<float(int, int)>& light) {
    ScenePlanes picture;
    picture.width = width;
    picture.height = height;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (std::vector<float>& plane : picture.rgb)
                plane.push_back(light(x, y));
        }
    }
    return picture;
}

std::array<std::vector<float>, 3> fused(ScenePlanes picture, const Settings& settings = {}) {
    run_local_operator(resolve_picture_operator("exposure_fusion", settings), picture);
    return picture.rgb;
}

// Mertens, Kautz, Van Reeth 2007: weights are those of neighborhoods, so that a picture without
// contrast has none.
TEST(ExposureFusion, AUniformPictureStaysUniformAndGray) {
    for (const float light : {0.02F, 0.18F, 4.0F}) {
        const auto result = fused(picture_of(33, 17, [&](int, int) { return light; }));
        for (const std::vector<float>& plane : result) {
            const auto [least, most] = std::minmax_element(plane.begin(), plane.end());
            EXPECT_EQ(*least, *most) << "means of equal numbers";
            EXPECT_GT(plane[0], 0);
            EXPECT_LE(plane[0], 1);
        }
        // The rows of the matrix after the curve, as S. Hill prints it, sum to 1, 1 and 0.99999.
        // The float engine rounds each channel on its own: by up to 1.2e-7 here.
        const float gray = result[0][0];
        EXPECT_NEAR(result[1][0], gray, 3e-7F * gray);
        EXPECT_NEAR(result[2][0], 0.99999F * gray, 3e-7F * gray);
    }
}

TEST(ExposureFusion, CompressesAWindowIntoARoom) {
    // Half of the picture is 1000 times as bright. Both halves keep their order, and their ratio
    // is less than the tone curve alone leaves.
    const auto ratio = [](const Settings& settings) {
        const auto result =
            fused(picture_of(64, 32, [](int x, int) { return x < 32 ? 0.05F : 50.0F; }), settings);
        return result[0][16 * 64 + 56] / result[0][16 * 64 + 8];
    };
    const float of_curve = ratio({{"shadows", "0"}, {"highlights", "0"}});
    EXPECT_GT(ratio({}), 1);
    EXPECT_LT(ratio({}), of_curve / 1.5F);
    EXPECT_LT(ratio({{"shadows", "3"}}), ratio({})) << "a brighter exposure for the room";
}

TEST(ExposureFusion, AMirroredPictureHasTheMirroredResult) {
    const auto light = [](int x, int y) {
        return 0.01F * static_cast<float>((x * x + 3 * y) % 97);
    };
    const auto result = fused(picture_of(32, 16, light));
    const auto mirrored = fused(picture_of(32, 16, [&](int x, int y) { return light(31 - x, y); }));
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 32; ++x)
            EXPECT_NEAR(result[0][static_cast<std::size_t>(32 * y + x)],
                        mirrored[0][static_cast<std::size_t>(32 * y + 31 - x)], 1e-6F)
                << x << " " << y << ": float rounds other differences of two samples";
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
