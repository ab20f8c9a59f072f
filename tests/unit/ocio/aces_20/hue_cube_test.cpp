// SPDX-License-Identifier: Apache-2.0
#include "ocio/aces_20/hue_cube.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/random.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The channel-mixing stage of an operator.
CrossTalkStage mixing_stage(const Pipeline& pipeline) {
    for (const Stage& stage : pipeline) {
        if (const auto* mixing = std::get_if<CrossTalkStage>(&stage)) return *mixing;
    }
    throw Error("no channel-mixing stage");
}

/// AP1 light, log-uniform, every fifth color with a channel at 0.
std::vector<float> any_light(std::size_t count) {
    SampleRandom random(2024);
    std::vector<float> light;
    for (std::size_t i = 0; i < count; ++i) {
        for (int c = 0; c < 3; ++c)
            light.push_back(static_cast<float>(std::exp2(random.uniform(-10, 6.5))));
        if (i % 5 == 0) light[3 * i + random.bits() % 3] = 0;
    }
    return light;
}

TEST(HueStructure, OfAces20EqualsItsStage) {
    for (const Settings& settings : {Settings{}, Settings{{"limit", "p3d65"}},
                                     Settings{{"peak", "1000"}, {"limit", "rec2020"}}}) {
        const CrossTalkStage stage = mixing_stage(resolve_operator("aces_20", settings).build());
        const auto structure = find_hue_structure(stage);
        ASSERT_NE(structure, nullptr);
        Pipeline parts = structure->to_axes;
        const ReferenceEngine axes(parts);
        parts.push_back(structure->of_axes);
        const std::vector<float> light = any_light(5000);
        std::vector<double> whole(light.size());
        std::vector<double> of_parts(light.size());
        ReferenceEngine({stage}).run_rgb(light.data(), whole.data(), light.size() / 3);
        ReferenceEngine(parts).run_rgb(light.data(), of_parts.data(), light.size() / 3);
        for (std::size_t i = 0; i < light.size(); ++i)
            EXPECT_NEAR(of_parts[i], whole[i], 1e-9 * structure->peak);
        for (std::size_t i = 0; i < light.size(); i += 3) {
            const Vector3 at =
                axes({static_cast<double>(light[i]), static_cast<double>(light[i + 1]),
                      static_cast<double>(light[i + 2])});
            EXPECT_GE(std::min({at[0], at[1], at[2]}), 0) << "HSV has no negatives";
        }
        const Vector3 gray = axes({0.18, 0.18, 0.18});
        EXPECT_NEAR(gray[0], gray[1], 1e-12);
        EXPECT_NEAR(gray[0], gray[2], 1e-12);
    }
    EXPECT_EQ(find_hue_structure({{Expr::input(0), Expr::input(1), Expr::input(2)}}), nullptr);
}

/// The 3D LUT has 25 nodes a side: the shipped one has 18 times as many nodes.
TEST(HueCube, KeepsBlackGraysAndHues) {
    const CrossTalkStage stage = mixing_stage(resolve_operator("aces_20").build());
    const auto structure = find_hue_structure(stage);
    ASSERT_NE(structure, nullptr);
    const HueCubeOptions options = {.edge = 25,
                                    .primaries = find_operator("aces_20").working,
                                    .samples_per_node = 6,
                                    .rounds = 1,
                                    .thread_count = 1};
    // Nothing is kept, then the nodes are, then they are read.
    const HueCube cube = fit_hue_cube(*structure, 128, options);
    HueCubeOptions threads = options;
    threads.thread_count = 3;
    const Folder folder;
    threads.cache_folder = folder.path();
    EXPECT_EQ(fit_hue_cube(*structure, 128, threads).nodes, cube.nodes);
    EXPECT_EQ(folder.files().size(), 1U);
    EXPECT_EQ(fit_hue_cube(*structure, 128, threads).nodes, cube.nodes);
    const std::size_t n = 25;
    ASSERT_EQ(cube.nodes.size(), 3 * n * n * n);
    for (std::size_t i = 0; i < n * n; ++i)
        EXPECT_EQ(cube.nodes[3 * i * n + 2], 0) << "black, of any hue and saturation";
    for (std::size_t h = 0; h < n; ++h) {
        for (std::size_t v = 0; v < n; ++v) {
            // x = 1/5 and y = 3/5 for R = G = B, in the scale of the nodes.
            const float* gray = &cube.nodes[3 * (h * n * n + v)];
            EXPECT_NEAR(gray[0], (0.2 + 0.1) / 0.7, 1e-6);
            EXPECT_NEAR(gray[1], (0.6 - 0.4) / 0.7, 1e-6);
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
