// SPDX-License-Identifier: Apache-2.0
#include "ocio/lower.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "measure/sample_set.h"
#include "ocio/transforms.h"
#include "tonewright/ocio.h"
#include "unit/ocio/lowered_forms.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input();

/// Khronos PBR Neutral (pbrNeutral.glsl); `white` as Filament has it, mixing towards 1.
HexconeStage neutral(double start_compression, double desaturation, bool white) {
    const double start = start_compression - 0.04;
    const double d = 1 - start;
    const Expr q = max(kX, start);
    const Expr n = 1 - d * d / (q + d - start);
    const Expr g = 1 - 1 / (desaturation * (q - n) + 1);
    const Expr is_base = less(kX, start);
    return {.offset = select(less(kX, 0.08), kX - 6.25 * kX * kX, 0.04),
            .value = select(is_base, kX, white ? g + (1 - g) * n : n),
            .chroma = select(is_base, 1, (1 - g) * n / q)};
}

Pipeline shown(const HexconeStage& stage) { return {kPositive, stage, kSdr, srgb()}; }

TEST(LowerHexcone, PbrNeutralNeedsNo3dLut) {
    // On the whole sample set: CPU 7.3e-6, llvmpipe 1.7e-5.
    const SampleSet set = make_sample_set(find_input_space("lin_rec709"), {});
    std::vector<float> in;
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (set.is_non_negative(i))
            in.insert(in.end(), {set.rgb[3 * i], set.rgb[3 * i + 1], set.rgb[3 * i + 2]});
    }
    for (const bool white : {false, true}) {
        expect_no_cube(shown(neutral(0.8, 0.15, white)));
        expect_close(shown(neutral(0.8, 0.15, white)), in, 1e-5, 3e-5);
        expect_close(shown(neutral(0.8, 0.15, white)), saturated_colors(), 1e-5, 3e-5);
    }
}

TEST(LowerHexcone, PbrNeutralByHand) {
    // pbrNeutral.glsl: (1, 0.5, 0.25) less 0.04 is (0.96, 0.46, 0.21); the peak 0.96 becomes
    // n = 1 - 0.0576/0.44; the rest is scaled by n/0.96 and mixed towards n.
    const double n = 1 - 0.0576 / 0.44;
    const double g = 1 - 1 / (0.15 * (0.96 - n) + 1);
    const auto mixed = [&](double c) { return c * n / 0.96 * (1 - g) + n * g; };
    // (0.02, 0.04, 0.06): the offset is 0.02 - 6.25 * 0.0004 = 0.0175.
    const std::vector<float> in = {1, 0.5F, 0.25F, 0.02F, 0.04F, 0.06F, 0.5F, 0.5F, 0.5F};
    const std::vector<double> expected = {n,      mixed(0.46), mixed(0.21), 0.0025, 0.0225,
                                          0.0425, 0.46,        0.46,        0.46};
    for (const Form& form : run_forms({kPositive, neutral(0.8, 0.15, false)}, in)) {
        for (std::size_t i = 0; i < expected.size(); ++i)
            EXPECT_NEAR(static_cast<double>(form.out[i]), expected[i], form.is_gpu ? 3e-6 : 1e-6)
                << form.name;
    }
}

/// OpenColorIO inverts every transform: tables that fall, too, over positive and negative numbers.
TEST(LowerHexcone, PbrNeutralInverseByHand) {
    // The three colors above, from their light; and one whose peak is compressed, so that stops
    // are counted on both sides: (3, 0.5, 0.5) less 0.04 has the peak 2.96, which becomes
    // n = 1 - 0.0576/2.44.
    const double low = 1 - 0.0576 / 0.44;
    const double high = 1 - 0.0576 / 2.44;
    const auto mixed = [](double c, double peak, double n) {
        const double g = 1 - 1 / (0.15 * (peak - n) + 1);
        return c * n / peak * (1 - g) + n * g;
    };
    const std::vector<double> light = {low,
                                       mixed(0.46, 0.96, low),
                                       mixed(0.21, 0.96, low),
                                       high,
                                       mixed(0.46, 2.96, high),
                                       mixed(0.46, 2.96, high),
                                       0.0025,
                                       0.0225,
                                       0.0425};
    const std::vector<double> scene = {1, 0.5, 0.25, 3, 0.5, 0.5, 0.02, 0.04, 0.06};
    const std::vector<float> in(light.begin(), light.end());
    const LoweredOps back = inverse(lower_to_ocio({kPositive, neutral(0.8, 0.15, false)}).ops);
    for (const Form& form : run_forms(make_processor(back), in)) {
        // Without loss the tables' own precision, times the slope of the inverse, 2.44^2/0.0576 at
        // most; else OpenColorIO's resampling of the inverse at half floats.
        const double bound = form.name == "cpu lossless" ? 1e-4 : 2e-3;
        for (std::size_t i = 0; i < scene.size(); ++i)
            EXPECT_NEAR(static_cast<double>(form.out[i]), scene[i], bound * std::max(1.0, scene[i]))
                << form.name << " " << i;
    }
}

TEST(LowerHexcone, PbrNeutralWithAnyParameters) {
    for (const double start : {0.1, 0.99}) {
        for (const double desaturation : {0.0, 1.0})
            expect_close(shown(neutral(start, desaturation, false)), positive_colors(), 1e-5, 3e-5);
    }
}

TEST(LowerHexcone, GraysStayGray) {
    std::vector<float> in;
    for (int i = -1000; i <= 800; ++i)
        in.insert(in.end(), 3, std::exp2(static_cast<float>(i) / 50));
    in.insert(in.end(), {0, 0, 0, 65504, 65504, 65504, 1e6F, 1e6F, 1e6F});
    for (const bool white : {false, true}) {
        for (const Form& form : run_forms(shown(neutral(0.8, 0.15, white)), in)) {
            for (std::size_t i = 0; i < in.size(); i += 3) {
                EXPECT_EQ(form.out[i], form.out[i + 1]) << form.name << " " << in[i];
                EXPECT_EQ(form.out[i], form.out[i + 2]) << form.name << " " << in[i];
            }
        }
    }
    for (const Form& form : run_forms(shown(neutral(0.8, 0.15, false)), {0, 0, 0, -1, -2, -3})) {
        for (const float x : form.out)
            EXPECT_EQ(x, 0) << form.name << ": black";
    }
}

TEST(LowerHexcone, LosesChromaGainsChromaOrKeepsIt) {
    const Expr f = reinhard();
    const HexconeStage stages[] = {
        {0, f, 1 / (1 + kX)},                           // the largest channel's tone scale
        {0, f, max(0, 1 - kX) / (1 + kX)},              // gray from 1 on
        {0, f, 0},                                      // gray
        {0.3 * kX, f, 1 / (1 + kX) * (0.5 + 0.5 * f)},  // more chroma where it is brighter
        {0.3 * kX, f, select(less(kX, 0.5), 1, 0.5) / (1 + kX)},  // a step
        {kX / 2, 0.01 + f, 1 / (1 + kX)},                         // black is not 0
        {0, kX / (1 + kX * kX), 1 / (1 + kX * kX) * 0.75},        // value falls again
    };
    for (const HexconeStage& stage : stages) {
        SCOPED_TRACE(to_string(Pipeline{stage}));
        expect_no_cube(shown(stage));
        // Nothing here desaturates lights as the Neutrals do: the hue's float rounding is what max
        // RGB has, twice the bound of the Neutrals.
        expect_close(shown(stage), positive_colors(), 2e-5, 5e-5);
        expect_sane(shown(stage), 5e-5);
    }
}

TEST(LowerHexcone, LightAboveThePeakIsKept) {
    // `linear` output: values to 8, in float32's proportions.
    const HexconeStage stage{0, 8 * kX / (7 + kX), 8 / (7 + kX) * 0.9};
    expect_close({kPositive, stage}, positive_colors(), 8 * 1e-6, 8 * 3e-6);
}

TEST(LowerHexcone, ClampsBeforeItEndItsDomain) {
    // sqrt(3.3 - p) is not defined beyond.
    const HexconeStage stage{0, sqrt(3.3 - kX) * kX / 2, sqrt(3.3 - kX) / 4};
    const Pipeline pipeline = {ClampStage{0, 3.25}, stage, kSdr, srgb()};
    expect_close(pipeline, positive_colors(), 2e-5, 5e-5);
    const Lowered lowered = lower_to_ocio(pipeline);
    for (std::size_t i = 0; i < lowered.ops.size(); ++i) {
        const auto* lut = std::get_if<Lut1DOp>(&lowered.ops[i].op);
        if (!lut) continue;
        for (std::size_t j = 0; j < lut->values.size(); ++j)
            ASSERT_TRUE(std::isfinite(lut->values[j])) << "operation " << i << ", value " << j;
    }
}

TEST(LowerHexcone, IsTotal) {
    for (const bool white : {false, true})
        expect_sane(shown(neutral(0.8, 0.15, white)), 5e-5);
}

TEST(LowerHexcone, RefusesUnsupportedCurves) {
    const HexconeStage good = neutral(0.8, 0.15, false);
    EXPECT_THROW((void)lower_to_ocio({good}), Error) << "no clamp";
    EXPECT_THROW((void)lower_to_ocio({kPositive, MatrixStage{rgb_to_rgb(kRec2020, kRec709)}, good}),
                 Error);
    // Chroma beyond what value leaves room for: negative light.
    EXPECT_THROW((void)lower_to_ocio({kPositive, HexconeStage{0, reinhard(), 1}}), Error);
    EXPECT_THROW((void)lower_to_ocio({kPositive, HexconeStage{0, reinhard(), -0.1}}), Error);
    // Steps up and down: no monotone function is steeper than both.
    const Expr steps = select(less(kX, 0.5), 1, select(less(kX, 2), 0.5, 1));
    EXPECT_THROW((void)lower_to_ocio({kPositive, HexconeStage{0, kX, steps}}), Error);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
