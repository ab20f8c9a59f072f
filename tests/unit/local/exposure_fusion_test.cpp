// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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

std::array<std::vector<float>, 3> fused(ScenePlanes picture) {
    run_local_operator(resolve_picture_operator("exposure_fusion"), picture);
    return picture.rgb;
}

// Mertens, Kautz, Van Reeth 2007: weights are those of neighborhoods, so that a picture without
// contrast has none.
TEST(ExposureFusion, AUniformPictureStaysUniformAndGray) {
    for (const float light : {0.02F, 0.18F, 4.0F}) {
        const auto result = fused(picture_of(33, 17, [&](int, int) { return light; }));
        for (const std::vector<float>& plane : result) {
            const auto [least, most] = std::minmax_element(plane.begin(), plane.end());
            EXPECT_LE(*most - *least, 1e-5F * *most) << "roundings of the pyramids";
            // Primaries are matrices of printed decimals: a hundredth of an 8-bit code.
            EXPECT_NEAR(plane[0], result[0][0], 4e-5F);
            EXPECT_GT(plane[0], 0);
            EXPECT_LE(plane[0], 1);
        }
    }
}

TEST(ExposureFusion, CompressesAWindowIntoARoom) {
    // Half of the picture is 1000 times as bright. Both halves keep their order, and their ratio
    // shrinks.
    const auto result =
        fused(picture_of(64, 32, [](int x, int) { return x < 32 ? 0.05F : 50.0F; }));
    const float room = result[0][16 * 64 + 8];
    const float window = result[0][16 * 64 + 56];
    EXPECT_GT(window, room);
    EXPECT_LT(window / room, 100);
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
                        mirrored[0][static_cast<std::size_t>(32 * y + 31 - x)], 2e-4F)
                << x << " " << y;
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
