// SPDX-License-Identifier: Apache-2.0
#include "ocio/gpu.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "full_counts.h"
#include "measure/sample_set.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/shader.h"
#include "unit/shader/hostile_colors.h"

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

GlslGpu gpu_of(const Shader& shader) {
    std::vector<GlslTexture> textures;
    for (const ShaderTexture& texture : shader.textures)
        textures.push_back({texture.name, texture.size, texture.rgba.data()});
    return {shader.text, shader.function, textures};
}

TEST(ShaderGpu, GlslShowsTheReference) {
    if (const std::string reason = OcioGpu::unavailable_reason(); !reason.empty())
        GTEST_SKIP() << reason;
    const SampleSet samples = make_sample_set(
        find_input_space("lin_rec709"),
        {.gamut_grid_size = count_of(33, 9), .random_count = count_of(100000U, 5000U)});
    for (const OperatorVariant& variant : tested_variants()) {
        ShaderRequest request;
        request.view =
            make_view(resolve_operator(variant.name, {}, variant.look), "lin_rec709", 0, "srgb");
        const Shader shader = write_shader(request);
        const GlslGpu gpu = gpu_of(shader);
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

/// Largest error over the colors whose channels are numbers.
double worst_error(const Shader& shader, const View& view, const std::vector<float>& rgb) {
    std::vector<float> got(rgb.size());
    std::vector<double> truth(rgb.size());
    gpu_of(shader).run_rgb(rgb.data(), got.data(), rgb.size() / 3);
    ReferenceEngine(build_view(view)).run_rgb(rgb.data(), truth.data(), rgb.size() / 3);
    double worst = 0;
    for (std::size_t i = 0; i < rgb.size(); ++i) {
        const double error = std::fabs(static_cast<double>(got[i]) - truth[i]);
        worst = std::isnan(error) ? kInfinity : std::max(worst, error);
    }
    return worst;
}

// Operators whose curves are fitted, in arrays and in textures. The polynomials are within 3 units
// of 2^-24; 2e-6 is what float is enough for. ACES works through matrices with negative
// coefficients.
TEST(ShaderGpu, FittedCurvesShowTheReference) {
    if (const std::string reason = OcioGpu::unavailable_reason(); !reason.empty())
        GTEST_SKIP() << reason;
    SampleSet samples = make_sample_set(find_input_space("lin_rec709"),
                                        {.gamut_grid_size = 9, .random_count = 5000});
    std::replace_if(
        samples.rgb.begin(), samples.rgb.end(), [](float x) { return std::isnan(x); }, 0.18F);
    for (const char* op : {"agx_sobotka", "uchimura", "lottes", "hable_piecewise", "aces_13"}) {
        ShaderRequest request;
        request.view = make_view(resolve_operator(op), "lin_rec709", 0, "srgb");
        request.curves = ShaderCurves::fitted;
        const ShaderErrors errors = measure_shader(request);
        EXPECT_TRUE(std::isinf(errors.guaranteed)) << op;
        for (const ShaderTables tables : {ShaderTables::array, ShaderTables::texture}) {
            request.tables = tables;
            const Shader shader = write_shader(request, &errors);
            EXPECT_NE(shader.text.find("_table_cell("), std::string::npos) << op;
            EXPECT_LE(worst_error(shader, request.view, samples.rgb),
                      std::max(2e-6, op == std::string("aces_13") ? 2 * errors.vulkan_estimate : 0))
                << op;
        }
    }
}

/// Colors through a table and a grid of `edge` nodes a side, in front of an operator that limits
/// them to [0, 1].
View through_tables(int edge, Table table) {
    View view = make_view(resolve_operator("clamp"), "lin_rec709", 0, "native");
    view.input = "through tables";
    view.input_decode = {
        curve_stage(lookup(std::make_shared<const Table>(std::move(table)), Expr::input())),
        GridStage{Expr::input(), std::make_shared<const Grid>(edge, [edge] {
                      std::vector<double> nodes;
                      SampleRandom random(7);
                      for (int i = 0; i < 3 * edge * edge * edge; ++i)
                          nodes.push_back(random.uniform(0, 1));
                      return nodes;
                  })}};
    return view;
}

// The same numbers from arrays and from textures: tables with one row of texels and with more, at
// equal and at other distances, in lines and in steps, and a grid.
TEST(ShaderGpu, ArraysAndTexturesHoldTheSameNumbers) {
    if (const std::string reason = OcioGpu::unavailable_reason(); !reason.empty())
        GTEST_SKIP() << reason;
    std::vector<float> rgb;
    SampleRandom random(11);
    for (int i = 0; i < 30000; ++i)
        rgb.push_back(static_cast<float>(random.uniform(-0.1, 1.1)));
    for (const std::size_t count : {1U, 5U, 256U, 700U}) {
        for (const bool has_positions : {false, true}) {
            for (const auto how : {Table::Interpolation::linear, Table::Interpolation::step}) {
                Table table{{}, how};
                for (std::size_t i = 0; i < count; ++i) {
                    table.samples.push_back(random.uniform(0, 1));
                    if (!has_positions) continue;
                    const double end = static_cast<double>(i) / static_cast<double>(count);
                    table.positions.push_back(end * end);
                }
                ShaderRequest request;
                request.view = through_tables(5, table);
                const ShaderErrors unmeasured;
                std::vector<double> truth(rgb.size());
                ReferenceEngine(build_view(request.view))
                    .run_rgb(rgb.data(), truth.data(), rgb.size() / 3);
                std::array<std::vector<float>, 2> got;
                for (std::size_t k = 0; k < 2; ++k) {
                    request.tables = k == 0 ? ShaderTables::array : ShaderTables::texture;
                    const Shader shader = write_shader(request, &unmeasured);
                    EXPECT_EQ(shader.textures.size(), 2 * k);
                    got[k].resize(rgb.size());
                    gpu_of(shader).run_rgb(rgb.data(), got[k].data(), rgb.size() / 3);
                }
                EXPECT_EQ(got[0], got[1]) << count << " " << has_positions;
                std::size_t far = 0;
                // 700 cells of noise and 4 of the grid in three channels: a rounding of 2^-24
                // grows 8400 times.
                for (std::size_t i = 0; i < rgb.size(); ++i)
                    far += std::fabs(static_cast<double>(got[0][i]) - truth[i]) > 5e-4 ? 1 : 0;
                // A float may round to the next step: 700 steps take 1e-7 each of the range that
                // 30,000 numbers are drawn from, and a color has three results.
                EXPECT_LE(far, how == Table::Interpolation::step ? 30U : 0U)
                    << count << " " << has_positions;
            }
        }
    }
}

// Through a compiler of shaders.
TEST(ShaderGpu, HostileColorsGiveFiniteNumbers) {
    if (const std::string reason = OcioGpu::unavailable_reason(); !reason.empty())
        GTEST_SKIP() << reason;
    const std::vector<float> rgb = hostile_colors(count_of(1'000'000U, 20'000U));
    std::vector<float> out(rgb.size());
    const ShaderErrors unmeasured;
    for (const OperatorVariant& variant : tested_variants()) {
        for (const char* display : {"linear", "srgb"}) {
            const GlslGpu gpu = gpu_of(write_shader(request_of(variant, display), &unmeasured));
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
