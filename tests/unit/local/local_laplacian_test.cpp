// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tonewright/local.h"
#include "tonewright/registry.h"
#include "unit/local/planes.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(LocalLaplacian, SaturatedColorsKeepTheirChromaticity) {
    const Operator& op = *resolve_picture_operator("local_laplacian").op;
    const ScenePlanes picture = make_light(40, 30);
    const auto result = run(op, picture, {{"saturation", "1"}});
    for (std::size_t i = 0; i < picture.rgb[0].size(); ++i) {
        const double sum = static_cast<double>(picture.rgb[0][i]) +
                           static_cast<double>(picture.rgb[1][i]) +
                           static_cast<double>(picture.rgb[2][i]);
        const double shown = static_cast<double>(result[0][i]) + static_cast<double>(result[1][i]) +
                             static_cast<double>(result[2][i]);
        for (std::size_t c = 0; c < 3 && sum > 0; ++c) {
            EXPECT_NEAR(static_cast<double>(result[c][i]) / shown,
                        static_cast<double>(picture.rgb[c][i]) / sum, 1e-6);
        }
    }
}

TEST(LocalLaplacian, LowContrastIsLeftAlone) {
    // base = detail = 1 keeps all differences: the picture, but for its white.
    const Operator& op = *resolve_picture_operator("local_laplacian").op;
    ScenePlanes picture = make_light(65, 33, 2);
    for (std::vector<float>& plane : picture.rgb) {
        for (float& v : plane)
            v = 0.2F + v;
    }
    const auto result = run(op, picture, {{"base", "1"}, {"saturation", "1"}, {"contrast", "24"}});
    const float factor = result[0][0] / picture.rgb[0][0];
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < picture.rgb[c].size(); ++i)
            EXPECT_NEAR(result[c][i], factor * picture.rgb[c][i], 2e-5F * result[c][i]);
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
