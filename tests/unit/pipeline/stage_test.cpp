// SPDX-License-Identifier: Apache-2.0
#include "tonewright/pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pipeline/tone_curve.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"
#include "unit/pipeline/shown.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input(0);
const Expr kR = Expr::input(0);
const Expr kG = Expr::input(1);
const Expr kB = Expr::input(2);

using Norm = ToneScaleStage::Norm;

Vector3 shown(const Stage& stage, const Vector3& rgb) { return shown(Pipeline{stage}, rgb); }

/// One stage of each kind that changes nothing, in the order of the variant.
Pipeline identities() {
    return {MatrixStage{kIdentity3}, curve_stage(kX), HuePreservingStage{kX},
            ClampStage{-kInfinity, kInfinity}, CrossTalkStage{{kR, kG, kB}}};
}

TEST(Stage, KindsHaveNames) {
    EXPECT_EQ(stage_kind(MatrixStage{kIdentity3}), "matrix");
    EXPECT_EQ(stage_kind(curve_stage(kX)), "curve");
    EXPECT_EQ(stage_kind(ToneScaleStage{Norm::luminance, kRec709Weights, kX}), "tone scale");
    EXPECT_EQ(stage_kind(HuePreservingStage{kX}), "hue-preserving curve");
    EXPECT_EQ(stage_kind(HexconeStage{kX, kX, kX}), "hexcone");
    EXPECT_EQ(stage_kind(ClampStage{}), "clamp");
    EXPECT_EQ(stage_kind(CrossTalkStage{{kR, kG, kB}}), "cross-talk");
}

TEST(Stage, KnowsThatItIsAnIdentity) {
    for (const Stage& stage : identities())
        EXPECT_TRUE(is_identity(stage)) << stage_kind(stage);
    Matrix3 nearly = kIdentity3;
    nearly[2][0] = 1e-300;
    EXPECT_FALSE(is_identity(MatrixStage{nearly}));
    EXPECT_FALSE(is_identity(exposure_stage(0.001)));
    EXPECT_TRUE(is_identity(exposure_stage(0)));
    EXPECT_FALSE(is_identity(CurveStage{{kX, kX, kX * 2}, std::nullopt})) << "one channel of three";
    EXPECT_FALSE(is_identity(ClampStage{-kInfinity, 65504}));
    EXPECT_FALSE(is_identity(ClampStage{0, kInfinity}));
    EXPECT_FALSE(is_identity(CrossTalkStage{{kR, kB, kG}})) << "swapped channels";
    EXPECT_FALSE(is_identity(HuePreservingStage{kX * 2}));
}

TEST(Stage, AnIdentityChangesNoPixel) {
    Pipeline stages = identities();
    stages.push_back(ToneScaleStage{Norm::luminance, kRec709Weights, kX});
    stages.push_back(ToneScaleStage{Norm::max_rgb, {}, kX});
    const std::vector<Vector3> colors = {
        {0.2, 0.5, 4}, {-1, -2, -3}, {0, 0, 0}, {-3, 0.5, 0.1}, {65504, -65504, 1}};
    for (const Stage& stage : stages) {
        if (!is_identity(stage)) continue;
        for (const Vector3& rgb : colors) {
            // The tone scale multiplies by f(n)/n: one division, one product. The hue-preserving
            // curve divides by a range of twice the peak, and multiplies.
            expect_rgb(shown(stage, rgb), rgb, 65504 * 0x1p-50, std::string(stage_kind(stage)));
        }
    }
}

TEST(Stage, KnowsWhetherItMixesChannels) {
    for (const Stage& stage : identities())
        EXPECT_FALSE(mixes_channels(stage)) << stage_kind(stage);
    EXPECT_FALSE(mixes_channels(MatrixStage{{{{2, 0, 0}, {0, 3, 0}, {0, 0, 4}}}}));
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            Matrix3 m = kIdentity3;
            m[i][j] = 0.5;
            EXPECT_EQ(mixes_channels(MatrixStage{m}), i != j) << "row " << i << ", column " << j;
        }
    }
    EXPECT_FALSE(mixes_channels(CurveStage{{kX, kX * 2, kX * kX}, std::nullopt}));
    EXPECT_FALSE(mixes_channels(ClampStage{0, 1}));
    EXPECT_TRUE(mixes_channels(ToneScaleStage{Norm::max_rgb, {}, kX / (1 + kX)}));
    EXPECT_TRUE(mixes_channels(HuePreservingStage{kX / (1 + kX)}));
    EXPECT_TRUE(mixes_channels(HexconeStage{0, kX, 1}));
    EXPECT_TRUE(mixes_channels(CrossTalkStage{{kR, kG, kR + kB}}));
}

TEST(Stage, PerChannelMeansOneFunctionForEachChannel) {
    const Stage half = curve_stage(kX / 2);
    EXPECT_TRUE(is_per_channel({}));
    EXPECT_TRUE(is_per_channel({exposure_stage(1), ClampStage{0, 1}, half}));
    EXPECT_FALSE(is_per_channel({CurveStage{{kX, kX, kX / 2}, std::nullopt}}))
        << "apart, not alike";
    EXPECT_FALSE(is_per_channel({MatrixStage{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 2}}}}}));
    EXPECT_FALSE(is_per_channel({CrossTalkStage{{kG, kB, kR}}})) << "alike, not apart";
    EXPECT_FALSE(is_per_channel({ToneScaleStage{Norm::max_rgb, {}, kX / (1 + kX)}}));
    EXPECT_FALSE(is_per_channel({HuePreservingStage{kX / (1 + kX)}}));
    EXPECT_TRUE(is_per_channel({CrossTalkStage{{kR * 2, kG * 2, kB * 2}}}))
        << "what it does counts, not how it is written";
    // There and back: a permutation's inverse is exact.
    const Matrix3 turn = {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}};
    EXPECT_FALSE(is_per_channel({MatrixStage{turn}, half}));
    EXPECT_TRUE(is_per_channel({MatrixStage{turn}, MatrixStage{inverse(turn)}, half}));
}

TEST(Stage, MatrixActsOnColumns) {
    const MatrixStage m{{{{1, 2, 3}, {4, 5, 6}, {7, 8, 10}}}};
    EXPECT_EQ(shown(m, {1, 10, 100}), (Vector3{321, 654, 1087}));
    EXPECT_EQ(shown(m, {1, 0, 0}), (Vector3{1, 4, 7})) << "the first column";
}

TEST(Stage, CurvesBelongToTheirChannel) {
    EXPECT_EQ(shown(CurveStage{{kX + 1, kX * 2, kX * kX}, std::nullopt}, {3, 5, 7}),
              (Vector3{4, 10, 49}));
    const CurveStage same_for_all = curve_stage(kX / (1 + kX), kX / (1 - kX));
    EXPECT_TRUE(same_for_all.is_uniform());
    EXPECT_EQ(shown(same_for_all, {1, 3, 0}), (Vector3{0.5, 0.75, 0}));
    ASSERT_TRUE(same_for_all.inverse);
    for (const Expr& g : *same_for_all.inverse)
        EXPECT_EQ(evaluate(g, 0.75), 3);
    EXPECT_FALSE((CurveStage{{kX, kX + 1, kX}, std::nullopt}.is_uniform()));
    EXPECT_FALSE((CurveStage{{kX, kX, kX + 1}, std::nullopt}.is_uniform()));
}

TEST(Stage, ClampHasTwoEnds) {
    EXPECT_EQ(shown(ClampStage{-1, 2}, {-3, 0.5, 7}), (Vector3{-1, 0.5, 2}));
    EXPECT_EQ(shown(ClampStage{}, {-3, 0, 7e9}), (Vector3{0, 0, 7e9})) << "0 to infinity";
}

TEST(Stage, CrossTalkReadsAllChannels) {
    EXPECT_EQ(shown(CrossTalkStage{{kR + kG, kG * kB, kB - kR}}, {2, 3, 5}), (Vector3{5, 15, 3}));
}

TEST(Stage, ToneScaleScalesByTheNorm) {
    const Expr f = kX / (1 + kX);
    // n = 4/4 + 1/2 + 2/4 = 2, f(n)/n = 1/3
    const ToneScaleStage luminance{Norm::luminance, {0.25, 0.5, 0.25}, f};
    expect_rgb(shown(luminance, {4, 1, 2}), {4.0 / 3, 1.0 / 3, 2.0 / 3}, kRounding);
    // n = 4, f(n)/n = 0.8/4
    const ToneScaleStage largest{Norm::max_rgb, {}, f};
    expect_rgb(shown(largest, {4, 1, 2}), {0.8, 0.2, 0.4}, kRounding);
    expect_rgb(shown(largest, {1, 4, 2}), {0.2, 0.8, 0.4}, kRounding);
    expect_rgb(shown(largest, {2, 1, 4}), {0.4, 0.2, 0.8}, kRounding);
    // A negative channel under a positive norm keeps its sign: n = 1 - 0.5 + 0.5 = 1, f(n)/n = 1/2
    expect_rgb(shown(luminance, {4, -1, 2}), {2, -0.5, 1}, kRounding);
}

TEST(Stage, ToneScaleIsBlackWhereTheNormIsNotPositive) {
    const Vector3 black = {0, 0, 0};
    for (const Norm norm : {Norm::luminance, Norm::max_rgb}) {
        const ToneScaleStage s{norm, kRec709Weights, kX / (1 + kX)};
        EXPECT_EQ(shown(s, black), black) << "0/0 has a limit";
        EXPECT_EQ(shown(s, {-1, -2, -3}), black);
    }
    const ToneScaleStage s{Norm::luminance, kRec709Weights, kX / (1 + kX)};
    EXPECT_EQ(shown(s, {1, -1, 1}), black) << "0.2126 - 0.7152 + 0.0722 is negative";
}

/// The middle channel keeps its place between the smallest and the largest, and all three keep
/// their order.
void expect_same_hue(const Vector3& a, const Vector3& b) {
    const auto place = [](const Vector3& c) {
        const auto [lo, hi] = std::minmax_element(c.begin(), c.end());
        Vector3 relative{};
        for (std::size_t i = 0; i < 3; ++i)
            relative[i] = (c[i] - *lo) / (*hi - *lo);
        return relative;
    };
    expect_rgb(place(a), place(b), kRounding);
}

TEST(Stage, HuePreservingMapsTheEndsAndKeepsTheMiddlesPlace) {
    const HuePreservingStage s{kX / (1 + kX)};
    // f(4) = 0.8, f(1) = 0.5, and 2 is a third of the way: 0.6
    expect_rgb(shown(s, {4, 1, 2}), {0.8, 0.5, 0.6}, kRounding);
    expect_rgb(shown(s, {1, 2, 4}), {0.5, 0.6, 0.8}, kRounding);
    expect_rgb(shown(s, {2, 4, 1}), {0.6, 0.8, 0.5}, kRounding);
    expect_rgb(shown(s, {1, 4, 4}), {0.5, 0.8, 0.8}, kRounding);
    expect_rgb(shown(s, {4, 1, 1}), {0.8, 0.5, 0.5}, kRounding);
    expect_rgb(shown(s, {3, 3, 3}), {0.75, 0.75, 0.75}, kRounding);
    EXPECT_EQ(shown(s, {0, 0, 0}), (Vector3{0, 0, 0}));
    const HuePreservingStage shifted{kX / (1 + kX) - 0.5};
    expect_rgb(shown(shifted, {4, 1, 2}), {0.3, 0, 0.1}, kRounding);
    for (const Vector3& rgb : {Vector3{9, 0.01, 3}, {0.2, 0.7, 0}, {30, 60, 50}, {5, 5, 1}})
        expect_same_hue(shown(s, rgb), rgb);
}

TEST(Stage, HexconeScalesTheDistancesFromTheLargest) {
    // min 1, so p = 4 - 1/2 = 7/2, value 7/9 and chroma 2/9.
    const HexconeStage s{kX / 2, kX / (1 + kX), 1 / (1 + kX)};
    expect_rgb(shown(s, {4, 1, 2}), {7.0 / 9, 1.0 / 9, 3.0 / 9}, kRounding);
    expect_rgb(shown(s, {2, 4, 1}), {3.0 / 9, 7.0 / 9, 1.0 / 9}, kRounding);
    expect_rgb(shown(s, {1, 2, 4}), {1.0 / 9, 3.0 / 9, 7.0 / 9}, kRounding);
    expect_rgb(shown(s, {4, 4, 4}), {2.0 / 3, 2.0 / 3, 2.0 / 3}, kRounding);  // p = 2
    EXPECT_EQ(shown(s, {0, 0, 0}), (Vector3{0, 0, 0}));
    for (const Vector3& rgb : {Vector3{9, 0.01, 3}, {0.2, 0.7, 0}, {30, 60, 50}, {5, 5, 1}})
        expect_same_hue(shown(s, rgb), rgb);
}

TEST(Stage, ExposureIsAPowerOfTwo) {
    EXPECT_EQ(shown(exposure_stage(3), {1, 0.25, -2}), (Vector3{8, 2, -16}));
    expect_rgb(shown(exposure_stage(-0.5), {1, 2, 0}), {std::sqrt(0.5), std::sqrt(2.0), 0},
               kRounding);
}

TEST(Pipeline, ComposesInOrder) {
    const Stage plus_one = curve_stage(kX + 1);
    const Stage twice = exposure_stage(1);
    EXPECT_EQ(shown(Pipeline{plus_one, twice}, {1, 2, 3}), (Vector3{4, 6, 8}));
    EXPECT_EQ(shown(Pipeline{twice, plus_one}, {1, 2, 3}), (Vector3{3, 5, 7}));
    EXPECT_EQ(shown(Pipeline{}, {1, 2, 3}), (Vector3{1, 2, 3}));
}

TEST(Pipeline, SimplifyMultipliesMatricesInTheRightOrder) {
    const Matrix3 a = {{{1, 2, 0}, {0, 1, 3}, {4, 0, 1}}};
    const Matrix3 b = {{{0, 1, 0}, {5, 0, 1}, {1, 1, 1}}};
    const Pipeline simple = simplify({MatrixStage{a}, MatrixStage{b}});
    ASSERT_EQ(simple.size(), 1U);
    // b a by hand: a's second row; five times its first plus its third; the sum of the three.
    const Matrix3 product = {{{0, 1, 3}, {9, 10, 1}, {5, 3, 4}}};
    EXPECT_EQ(std::get<MatrixStage>(simple[0]).m, product);
    EXPECT_EQ(shown(simple, {1, 0, 0}), (Vector3{0, 9, 5})) << "a b would give (10, 3, 1)";
}

TEST(Pipeline, SimplifyDropsIdentities) {
    EXPECT_TRUE(simplify(identities()).empty());
    const Matrix3 turn = {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}};
    const Pipeline there_and_back = {MatrixStage{turn}, curve_stage(kX),
                                     MatrixStage{inverse(turn)}};
    EXPECT_TRUE(simplify(there_and_back).empty()) << "an identity between them does not part them";
    const Stage clamp = ClampStage{0, 1};
    EXPECT_EQ(simplify({exposure_stage(1), clamp, exposure_stage(-1)}).size(), 3U)
        << "a clamp does";
    // A pair that cancels leaves a matrix before it free to meet the one after it.
    const Pipeline four = {exposure_stage(1), MatrixStage{turn}, MatrixStage{inverse(turn)},
                           exposure_stage(2)};
    const Pipeline one = simplify(four);
    ASSERT_EQ(one.size(), 1U);
    EXPECT_EQ(std::get<MatrixStage>(one[0]).m, scale(kIdentity3, 8));
}

TEST(Pipeline, SimplifyKeepsThePicture) {
    const std::vector<Vector3> colors = {{0.18, 0.18, 0.18}, {4, 0.02, 0.5},  {0, 0, 0},
                                         {-0.3, 0.4, 2},     {1e-5, 900, 30}, {-2, -3, -4}};
    for (const Operator& op : all_operators()) {
        for (const char* input : {"lin_rec709", "lin_ap1"}) {
            const Pipeline view =
                build_view(make_view(resolve_operator(op.id), input, 0, "rec2020"));
            for (const Vector3& rgb : colors) {
                // Only the multiplication of two matrices of the view moves a last bit.
                expect_rgb(shown(simplify(view), rgb), shown(view, rgb), 1e-12, op.id);
            }
        }
    }
}

TEST(Pipeline, PrintsOneStageALine) {
    const Pipeline p = {exposure_stage(1),
                        ClampStage{0, kInfinity},
                        curve_stage(kX / (1 + kX)),
                        CurveStage{{kX, kX * 2, kX * 3}, std::nullopt},
                        ToneScaleStage{Norm::luminance, kRec709Weights, kX * kX},
                        ToneScaleStage{Norm::max_rgb, {}, kX * kX},
                        HuePreservingStage{kX * kX},
                        HexconeStage{kX * 0.5, kX / (1 + kX), 1 / (1 + kX)},
                        CrossTalkStage{{kG, kB, kR}}};
    EXPECT_EQ(to_string(p),
              "matrix: [2 0 0 | 0 2 0 | 0 0 2]\n"
              "clamp: [0, inf]\n"
              "curve: x/(1 + x)\n"
              "curve: x | x*2 | x*3\n"
              "tone scale: of luminance: x*x\n"
              "tone scale: of max(r, g, b): x*x\n"
              "hue-preserving curve: x*x\n"
              "hexcone: offset x*0.5, value x/(1 + x), chroma 1/(1 + x)\n"
              "cross-talk: g | b | r\n");
}

TEST(Stage, ApplyComposesWithAnyExpressions) {
    // A pipeline of one stage composes the same from other expressions than the inputs.
    for (const Stage& stage : std::vector<Stage>{MatrixStage{{{{1, 2, 3}, {4, 5, 6}, {7, 8, 10}}}},
                                                 curve_stage(kX / (kX + 1)), ClampStage{-1, 2},
                                                 CrossTalkStage{{max(kR, kG), kB, kR - kB}},
                                                 HuePreservingStage{kX * kX}}) {
        const std::array<Expr, 3> swapped = {kB, kR, kG};
        const std::array<Expr, 3> applied = apply_stage(stage, swapped);
        const std::array<Expr, 3> composed = compose({stage});
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_TRUE(same(applied[c], substitute(composed[c], swapped))) << stage_kind(stage);
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
