// SPDX-License-Identifier: Apache-2.0
//
// The limit of half floats comes after the exposure, in every engine and for every input.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/random.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr float kMost = std::numeric_limits<float>::max();
constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Suns and their opposites, and what no limit should touch.
std::vector<float> suns() {
    return {3e5F,  2e5F, 8e4F, 2e5F, 5e4F, 10,    1e9F,  3e8F, 2e7F,  3e38F,  1e38F, 2e37F,
            -3e5F, 2e5F, 8e4F, 1e9F, -1,   -1e9F, kMost, 1,    0.18F, -kMost, kMost, 0,
            kInf,  1e5F, 2,    kNan, 4e5F, -kInf, 0.18F, 0.2F, 0.1F,  65504,  65536, 1e5F};
}

/// Light at the exposure, limited: what the view without exposure shows alike.
Vector3 exposed(const float* rgb, double stops) {
    Vector3 light{};
    for (std::size_t c = 0; c < 3; ++c)
        light[c] = sanitize(static_cast<double>(rgb[c]) * std::exp2(stops));
    return light;
}

const std::vector<double>& exposures() {
    static const std::vector<double> all = {-64, -40, -17, -16, -3.3, 0, 4.7, 16, 64};
    return all;
}

constexpr std::array kOperators = {"reinhard", "hable", "agx_blender", "clamp", "khronos_neutral"};

TEST(Exposure, ComesBeforeTheLimitInTheReference) {
    const std::vector<float> rgb = suns();
    for (const char* op : kOperators) {
        for (const char* input : {"lin_rec709", "lin_ap1", "lin_ap0"}) {
            const ReferenceEngine plain(
                build_view(make_view(resolve_operator(op), input, 0, "srgb")));
            for (const double stops : exposures()) {
                const ReferenceEngine engine(
                    build_view(make_view(resolve_operator(op), input, stops, "srgb")));
                for (std::size_t i = 0; i < rgb.size(); i += 3) {
                    const Vector3 in = {static_cast<double>(rgb[i]),
                                        static_cast<double>(rgb[i + 1]),
                                        static_cast<double>(rgb[i + 2])};
                    EXPECT_EQ(engine(in), plain(exposed(&rgb[i], stops)))
                        << op << " " << input << " " << stops << " " << rgb[i];
                }
            }
        }
    }
}

// Reinhard of 300000 200000 80000 at -17 stops on sRGB, by hand: x/(x + 1), IEC 61966-2-1.
TEST(Exposure, ASunKeepsItsColor) {
    const auto code = [](double x) { return 1.055 * std::pow(x / (x + 1), 1 / 2.4) - 0.055; };
    const View view = make_view(resolve_operator("reinhard"), "lin_rec709", -17, "srgb");
    const Vector3 shown = ReferenceEngine(build_view(view))({3e5, 2e5, 8e4});
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(shown[c], code(std::array{3e5, 2e5, 8e4}[c] / 131072), 1e-12);
}

TEST(Exposure, ComesBeforeTheLimitOnEveryInstructionSet) {
    const std::vector<float> rgb = suns();
    const std::string exposure(kExposureUniform);
    for (const char* op : kOperators) {
        for (const char* input : {"lin_rec709", "lin_ap1"}) {
            View view = make_view(resolve_operator(op), input, 0, "srgb");
            const ReferenceEngine plain(build_view(view));
            const double bound = view.op.op->bounds.simd;
            const Pipeline live = build_live_view(view, {exposure});
            for (const std::string& target : SimdEngine::targets()) {
                const SimdEngine engine(live, {{exposure, {0, -16, 16}}},
                                        view.op.op->bounds.simd_goal, target);
                for (const double stops : exposures()) {
                    view.exposure_stops = stops;
                    // Those that no uniform takes are compiled in.
                    const SimdEngine here =
                        std::fabs(stops) <= 16
                            ? engine.with_uniforms({{exposure, stops}})
                            : SimdEngine(build_view(view), view.op.op->bounds.simd_goal, target);
                    std::vector<float> out(rgb.size());
                    here.run_rgb(rgb.data(), out.data(), rgb.size() / 3);
                    for (std::size_t i = 0; i < rgb.size(); ++i) {
                        const Vector3 truth = plain(exposed(&rgb[i / 3 * 3], stops));
                        EXPECT_NEAR(out[i], truth[i % 3], bound)
                            << target << " " << op << " " << input << " " << stops << " "
                            << rgb[i / 3 * 3];
                    }
                }
            }
        }
    }
}

// Stored numbers are decoded first: (x^2.2) 2^stops, then the limit.
TEST(Exposure, EncodedInputsDecodeFirst) {
    const SourceColor source = find_source_color("g22_ap1_scene");
    const ReferenceEngine plain(
        build_view(make_view(resolve_operator("agx_blender"), "lin_ap1", 0, "srgb")));
    for (const double stops : {-17.0, -3.5, 0.0, 2.0}) {
        const View view = make_view(resolve_operator("agx_blender"), source, stops, "srgb");
        const Vector3 code = {310, 250, 160};  // 3e5, 2e5, 7e4
        Vector3 light{};
        for (std::size_t c = 0; c < 3; ++c)
            light[c] = sanitize(std::pow(code[c], 2.2) * std::exp2(stops));
        const Vector3 got = ReferenceEngine(build_view(view))(code);
        const Vector3 truth = plain(light);
        const std::array<float, 3> in = {310, 250, 160};
        std::array<float, 3> out{};
        SimdEngine(build_view(view), view.op.op->bounds.simd_goal)
            .run_rgb(in.data(), out.data(), 1);
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(got[c], truth[c], 1e-9) << stops;  // roundings of two powers
            EXPECT_NEAR(out[c], truth[c], view.op.op->bounds.simd) << stops;
        }
    }
}

// Every float, at the ends of exposures.
TEST(Exposure, ResultsAreFinite) {
    SampleRandom random(43);
    std::vector<float> rgb = suns();
    for (int i = 0; i < 6000; ++i)
        rgb.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(random.bits() >> 32)));
    const std::vector<double> wide(rgb.begin(), rgb.end());
    for (const char* input : {"lin_ap0", "srgb", "rec2100_pq", "rec2100_hlg", "g22_rec709_scene"}) {
        for (const char* op : {"reinhard", "agx_blender", "clamp"}) {
            for (const double stops : {-64.0, -17.0, 0.0, 17.0, 64.0}) {
                const Pipeline view = build_view(
                    make_view(resolve_operator(op), find_source_color(input), stops, "linear"));
                std::vector<float> out(rgb.size());
                SimdEngine(view).run_rgb(rgb.data(), out.data(), rgb.size() / 3);
                std::vector<double> exact(rgb.size());
                ReferenceEngine(view).run_rgb(rgb.data(), exact.data(), rgb.size() / 3);
                for (std::size_t i = 0; i < rgb.size(); ++i) {
                    ASSERT_TRUE(std::isfinite(out[i]) && std::isfinite(exact[i]))
                        << input << " " << op << " " << stops << ": " << out[i] << " " << exact[i]
                        << " of " << rgb[i / 3 * 3] << " " << rgb[i / 3 * 3 + 1] << " "
                        << rgb[i / 3 * 3 + 2];
                }
            }
        }
    }
}

// The limit has moved, not doubled: as many steps as before, and exposure 0 has none of its own.
TEST(Exposure, ViewsWithoutItAreLimitedByEngines) {
    const View view = make_view(resolve_operator("hable"), "lin_ap1", 0, "srgb");
    EXPECT_TRUE(limits_input(build_view(view)));
    EXPECT_FALSE(limits_input(build_live_view(view, {std::string(kExposureUniform)})));
    EXPECT_FALSE(limits_input(simplify(build_live_view(view, {std::string(kExposureUniform)}))));
    const View coded = make_view(resolve_operator("hable"), find_source_color("srgb"), 1, "srgb");
    EXPECT_TRUE(limits_input(build_view(coded))) << "stored numbers are limited, too";
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
