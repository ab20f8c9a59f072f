// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "tonewright/local.h"
#include "tonewright/registry.h"
#include "unit/local/planes.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(ReinhardLocal, UniformPictureIsTheGlobalOperator) {
    // L/(1 + L) on luminance, key and log average as given; a saturated color keeps its ratios.
    ScenePlanes picture;
    picture.width = 70;
    picture.height = 40;
    const std::array<float, 3> color = {0.4F, 0.01F, 3};
    for (std::size_t c = 0; c < 3; ++c)
        picture.rgb[c].assign(70 * 40, color[c]);
    const Operator& op = *resolve_picture_operator("reinhard_local").op;
    const auto result = run(op, picture, {{"log_average", "0.36"}, {"white", "5"}});
    const double luminance = 0.5 * (0.2126 * 0.4 + 0.7152 * 0.01 + 0.0722 * 3);
    const double factor = 0.5 * (1 + luminance / 25) / (1 + luminance);
    for (std::size_t c = 0; c < 3; ++c) {
        // Kernels of up to 67 weights sum to 1 within some float roundings.
        for (const float v : result[c])
            EXPECT_NEAR(v, static_cast<double>(color[c]) * factor, 2e-6 * static_cast<double>(v));
    }
}

TEST(ReinhardLocal, PixelsOfZeroAlphaAreNotMeasured) {
    const Operator& op = *resolve_picture_operator("reinhard_local").op;
    ScenePlanes picture = make_light(24, 10);
    for (std::vector<float>& plane : picture.rgb)
        std::fill(plane.begin(), plane.begin() + 120, 0.0F);
    ScenePlanes covered = picture;
    covered.counts.assign(240, 1);
    EXPECT_EQ(run(op, covered), run(op, picture));
    std::fill(covered.counts.begin(), covered.counts.begin() + 120, std::uint8_t{0});
    EXPECT_NE(run(op, covered), run(op, picture));
    covered.counts.assign(240, 0);
    EXPECT_EQ(run(op, covered), run(op, picture)) << "where nothing is covered, all counts";
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
