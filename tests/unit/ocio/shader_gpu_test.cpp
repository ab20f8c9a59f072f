// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.h"
#include "full_counts.h"
#include "measure/sample_set.h"
#include "ocio/gpu.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/shader.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string text_of(const OperatorVariant& variant) {
    return variant.look.empty() ? variant.name : variant.name + ":look=" + variant.look;
}

/// All, or a dozen.
std::vector<OperatorVariant> tested_variants() {
    const std::vector<OperatorVariant> all = all_variants();
    if (takes_full_counts()) return all;
    std::vector<OperatorVariant> some;
    for (std::size_t i = 4; i < all.size(); i += 9)
        some.push_back(all[i]);
    return some;
}

ShaderRequest request_of(const OperatorVariant& variant, const std::string& display) {
    ShaderRequest request;
    request.view =
        make_view(resolve_operator(variant.name, {}, variant.look), "lin_rec709", 0, display);
    return request;
}

GlslGpu gpu_of(const OperatorVariant& variant, const std::string& display) {
    const Shader shader = write_shader(request_of(variant, display));
    std::vector<GlslTexture> textures;
    for (const ShaderTexture& texture : shader.textures)
        textures.push_back({texture.name, texture.edge, texture.rgba.data()});
    return {shader.text, shader.function, textures};
}

TEST(ShaderGpu, GlslShowsTheReference) {
    if (const std::string reason = OcioGpu::unavailable_reason(); !reason.empty())
        GTEST_SKIP() << reason;
    const SampleSet samples = make_sample_set(
        find_input_space("lin_rec709"),
        {.lattice_edge = count_of(33, 9), .random_count = count_of(100000U, 5000U)});
    for (const OperatorVariant& variant : tested_variants()) {
        ShaderRequest request;
        request.view =
            make_view(resolve_operator(variant.name, {}, variant.look), "lin_rec709", 0, "srgb");
        const Shader shader = write_shader(request);
        std::vector<GlslTexture> textures;
        for (const ShaderTexture& texture : shader.textures)
            textures.push_back({texture.name, texture.edge, texture.rgba.data()});
        const GlslGpu gpu(shader.text, shader.function, textures);
        std::vector<float> got(samples.rgb.size());
        std::vector<double> truth(samples.rgb.size());
        gpu.run_rgb(samples.rgb.data(), got.data(), samples.size());
        ReferenceEngine(build_view(request.view))
            .run_rgb(samples.rgb.data(), truth.data(), samples.size());
        double worst = 0;
        double worst_of_bounded = 0;
        for (std::size_t i = 0; i < got.size(); i += 3) {
            const float* const color = &samples.rgb[i];
            if (std::any_of(color, color + 3, [](float x) { return std::isnan(x); })) continue;
            const bool is_bounded =
                std::all_of(color, color + 3, [](float x) { return x >= 0 && x <= 65504; });
            for (std::size_t c = i; c < i + 3; ++c) {
                ASSERT_TRUE(std::isfinite(got[c])) << text_of(variant);
                const double error = std::fabs(static_cast<double>(got[c]) - truth[c]);
                worst = std::max(worst, error);
                if (is_bounded) worst_of_bounded = std::max(worst_of_bounded, error);
            }
        }
        // An estimate of the worst case, over a thousand probe colors: between them the derivatives
        // may be larger, and twice is what that is taken to be. Float is enough for 2e-6 where the
        // estimate is small or first order has none; docs/shaders.md says of which it is not.
        const double estimate = shader.errors.vulkan_estimate;
        const bool is_small = estimate < 6e-6 || std::isinf(estimate);
        EXPECT_LE(worst, is_small ? 2e-6 : 2 * estimate) << text_of(variant);
        // 1e-8: what the series of 1 - 2^x may be off the formula.
        EXPECT_LE(worst_of_bounded, shader.errors.guaranteed + 1e-8) << text_of(variant);
    }
}

// The hostile colors of tests/unit/shader/, through a compiler of shaders.
TEST(ShaderGpu, HostileColorsGiveFiniteNumbers) {
    if (const std::string reason = OcioGpu::unavailable_reason(); !reason.empty())
        GTEST_SKIP() << reason;
    constexpr float kInf = std::numeric_limits<float>::infinity();
    const std::vector<float> values = {0.0F,    -0.0F,   1e-45F, 1e-38F, 1e-30F, 1e-10F,
                                       0.18F,   1.0F,    16.3F,  65504,  1e30F,  kInf,
                                       -1e-45F, -1e-10F, -0.2F,  -65504, -1e30F, -kInf};
    std::vector<float> rgb;
    for (const float r : values) {
        for (const float g : values) {
            for (const float b : values)
                rgb.insert(rgb.end(), {r, g, b});
        }
    }
    SampleRandom random(3);
    const std::size_t count = count_of(1'000'000U, 20'000U);
    while (rgb.size() < 3 * count) {
        const auto x = static_cast<float>(std::exp2(random.uniform(-149, 127)));
        rgb.push_back(random.uniform(0, 1) < 0.3 ? -x : x);
    }
    std::vector<float> out(rgb.size());
    for (const OperatorVariant& variant : tested_variants()) {
        for (const char* display : {"linear", "srgb"}) {
            const GlslGpu gpu = gpu_of(variant, display);
            gpu.run_rgb(rgb.data(), out.data(), rgb.size() / 3);
            const auto bad =
                std::find_if(out.begin(), out.end(), [](float x) { return !std::isfinite(x); });
            if (bad == out.end()) continue;
            const auto c = static_cast<std::size_t>(bad - out.begin()) / 3 * 3;
            ADD_FAILURE() << text_of(variant) << " " << display << ": (" << rgb[c] << ", "
                          << rgb[c + 1] << ", " << rgb[c + 2] << ") gives " << *bad;
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
