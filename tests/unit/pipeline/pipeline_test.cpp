// SPDX-License-Identifier: Apache-2.0
#include "tonewright/pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "base/format_number.h"
#include "base/strings.h"
#include "pipeline/tone_curve.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input(0);
const Expr kR = Expr::input(0);
const Expr kG = Expr::input(1);
const Expr kB = Expr::input(2);

using Norm = ToneScaleStage::Norm;

/// By plain recursion over the expressions: no engine is under test here.
Vector3 shown(const Pipeline& pipeline, const Vector3& rgb) {
    const std::array<Expr, 3> f = compose(pipeline);
    return {evaluate(f[0], rgb), evaluate(f[1], rgb), evaluate(f[2], rgb)};
}

Vector3 shown(const Stage& stage, const Vector3& rgb) { return shown(Pipeline{stage}, rgb); }

void expect_rgb(const Vector3& actual, const Vector3& expected, double tolerance,
                const std::string& what = "") {
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(actual[c], expected[c], tolerance) << what << ", channel " << c;
    }
}

/// The text of the Error that `f` throws.
template <class F>
std::string error_of(const F& f) {
    try {
        f();
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

std::string resolve_error(std::string_view name, const Settings& settings = {},
                          std::string_view look = {}) {
    return error_of([&] { (void)resolve_operator(name, settings, look); });
}

/// Sums and products of a few doubles in another order: some units of 2^-53.
constexpr double kRounding = 1e-14;

// ---------------------------------------------------------------------------------------------
// Stages

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

/// Where the middle channel lies between the smallest and the largest, and which ones those are.
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

// ---------------------------------------------------------------------------------------------
// Pipelines

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

// ---------------------------------------------------------------------------------------------
// Parameters

TEST(Resolve, DefaultsAreComplete) {
    const ResolvedOperator op = resolve_operator("reinhard_extended");
    EXPECT_EQ(op.op->id, "reinhard_extended");
    EXPECT_EQ(op.params.number("white"), 4);
    EXPECT_EQ(op.params.choice("apply"), "channels");
    EXPECT_EQ(op.params.look(), "");
    EXPECT_EQ(op.label, "reinhard_extended");
    EXPECT_THROW((void)op.params.number("apply"), Error) << "a choice is no number";
    EXPECT_THROW((void)op.params.choice("white"), Error);
}

TEST(Resolve, PresetsSetAndSettingsWin) {
    const ResolvedOperator preset = resolve_operator("reinhard_extended:luminance");
    EXPECT_EQ(preset.params.choice("apply"), "luminance");
    EXPECT_EQ(preset.params.number("white"), 4) << "what the preset does not name is the default";
    EXPECT_EQ(preset.label, "reinhard_extended:luminance");

    const ResolvedOperator both =
        resolve_operator("reinhard_extended:luminance", {{"apply", "max"}, {"white", "2.5"}});
    EXPECT_EQ(both.params.choice("apply"), "max");
    EXPECT_EQ(both.params.number("white"), 2.5);
    EXPECT_EQ(both.label, "reinhard_extended:luminance apply=max white=2.5");

    const ResolvedOperator look = resolve_operator("agx_sobotka", {}, "punchy");
    EXPECT_EQ(look.params.look(), "punchy");
    EXPECT_EQ(look.label, "agx_sobotka look=punchy");
}

TEST(Resolve, OneGrammarForAll) {
    const auto label_of = [](std::string_view text) { return resolve_operator(text).label; };
    for (const char* text : {"hable", "Hable", "HABLE", "Hable (Uncharted 2)", " hable "})
        EXPECT_EQ(label_of(text), "hable") << text;
    for (const char* text : {"AgX", "agx", "AgX (Blender)", "agx-blender", "AGX BLENDER"})
        EXPECT_EQ(label_of(text), "agx_blender") << text;
    for (const char* text :
         {"AgX Punchy", "agx_punchy", "AgX - Punchy", "agx_blender:look=punchy", "AgX:look=Punchy",
          "agx_blender look=punchy", "AgX Punchy:look=punchy"})
        EXPECT_EQ(label_of(text), "agx_blender look=punchy") << text;
    for (const char* text : {"hable:white=4:exposure_bias=1", "Hable:Exposure-Bias=1:WHITE=4",
                             "hable white=4 exposure_bias=1"})
        EXPECT_EQ(label_of(text), "hable exposure_bias=1 white=4") << text;
    EXPECT_EQ(label_of("reinhard:luminance"), "reinhard:luminance");
    EXPECT_EQ(label_of("Reinhard:Apply=Hue-Preserving"), "reinhard apply=hue_preserving");
    EXPECT_EQ(label_of("reinhard:luminance:apply=channels"), "reinhard:luminance apply=channels")
        << "the operator's default, but not the preset's";
    EXPECT_EQ(resolve_operator("hable:white=4", {{"White", "4"}}).settings,
              (Settings{{"white", "4"}}));
}

TEST(Resolve, ContradictionsAreRefused) {
    EXPECT_EQ(resolve_error("hable:white=4:white=5"), "hable: white is 4 and 5; expected it once");
    EXPECT_EQ(resolve_error("hable:white=4", {{"white", "5"}}),
              "hable: white is 4 and 5; expected it once");
    EXPECT_EQ(resolve_error("hable", {{"white", "4"}, {"WHITE", "5"}}),
              "hable: white is 5 and 4; expected it once");
    EXPECT_EQ(resolve_error("AgX Punchy", {}, "greyscale"),
              "agx_blender: look is punchy and greyscale; expected one");
    EXPECT_EQ(resolve_error("reinhard:luminance:max"),
              "reinhard: preset is luminance and max; expected one");
}

/// Every operator with each preset and look, and with a setting that is hard to write.
TEST(Resolve, PrintedNamesResolve) {
    const auto expect_same = [](const ResolvedOperator& op) {
        const ResolvedOperator again = resolve_picture_operator(operator_text(op));
        EXPECT_EQ(again.op, op.op) << operator_text(op);
        EXPECT_EQ(again.params, op.params) << operator_text(op);
        EXPECT_EQ(resolve_picture_operator(op.label).params, op.params) << op.label;
    };
    for (const OperatorVariant& v : all_variants())
        expect_same(resolve_operator(v.name, {}, v.look));
    for (const Operator& op : local_operators())
        expect_same(resolve_picture_operator(op.id));
    expect_same(
        resolve_operator("reinhard_extended:luminance", {{"white", "2.5"}, {"apply", "max"}}));
    const std::string primaries = "0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329";
    const ResolvedOperator spaced = resolve_operator("aces_20", {{"primaries", primaries}});
    EXPECT_EQ(operator_text(spaced), "aces_20:primaries=" + primaries);
    expect_same(spaced);
    EXPECT_EQ(operator_text(resolve_operator("hable", {{"white", "11.2"}})), "hable")
        << "the default says nothing";
}

TEST(Resolve, NamesMeanOneOperator) {
    std::map<std::string, std::string> meant;
    const auto claim = [&](const std::string& name, const std::string& what) {
        const auto [known, is_new] = meant.emplace(folded_name(name), what);
        EXPECT_TRUE(is_new || known->second == what)
            << name << " is " << known->second << " and " << what;
        EXPECT_EQ(name.find(':'), std::string::npos) << name;
    };
    for (const Operator& op : all_operators()) {
        for (const std::string& name : {op.id, op.view, op.title}) {
            claim(name, op.id);
            EXPECT_EQ(&find_operator(name), &op) << name;
        }
        for (const std::string& name : {op.view, op.title}) {
            for (const Look& look : op.looks)
                claim(name + " " + look.title, op.id + " look=" + look.id);
        }
    }
}

TEST(Resolve, ReadsNumbersAsTyped) {
    for (const auto& [text, value] : std::map<std::string, double>{{"2", 2},
                                                                   {"2.50", 2.5},
                                                                   {"1e3", 1000},
                                                                   {".5", 0.5},
                                                                   {"0.01", 0.01},
                                                                   {"65504", 65504}}) {
        EXPECT_EQ(resolve_operator("reinhard_extended", {{"white", text}}).params.number("white"),
                  value)
            << text;
    }
}

TEST(Resolve, UnknownNamesGetTheNearest) {
    EXPECT_EQ(resolve_error("habel"),
              "operator is habel; expected an id from the list of operators; did you mean hable?");
    EXPECT_EQ(resolve_error("foo"), "operator is foo; expected an id from the list of operators");
    EXPECT_EQ(
        resolve_error("filmic"),
        "operator is filmic; expected an id from the list of operators; Blender's Filmic is a "
        "table "
        "without a formula: give its LUT file as the operator (docs/choosing.md); filmic formulas "
        "are hable and unreal");
    EXPECT_EQ(resolve_error("agx_blender:punchy"),
              "agx_blender: preset is punchy; expected formula or hdr; did you mean look=punchy?");
    EXPECT_EQ(resolve_error("photoshop"),
              "operator is photoshop; expected an id from the list of operators");
    EXPECT_EQ(resolve_error("reinhard_extended", {{"whit", "2"}}),
              "reinhard_extended: parameter is whit; expected white, apply, "
              "color_correction, saturation or saturation_from; did you mean white?");
    EXPECT_EQ(resolve_error("clamp", {{"white", "2"}}),
              "clamp: parameter is white; expected none: clamp has no parameters");
    EXPECT_EQ(resolve_error("reinhard:lumnance"),
              "reinhard: preset is lumnance; expected luminance or max; did you mean luminance?");
    EXPECT_EQ(resolve_error("reinhard:"), "reinhard: preset is ; expected luminance or max");
    EXPECT_EQ(resolve_error("clamp:filmic"),
              "clamp: preset is filmic; expected none: clamp has no presets");
    EXPECT_EQ(resolve_error("agx_sobotka", {}, "goldn"),
              "agx_sobotka: look is goldn; expected golden or punchy; did you mean golden?");
    EXPECT_EQ(resolve_error("hable", {}, "golden"),
              "hable: look is golden; expected none: hable has no looks");
    EXPECT_EQ(resolve_error("reinhard", {{"apply", "chanels"}}),
              "reinhard: apply is chanels; expected channels, luminance, max or "
              "hue_preserving; did you mean channels?");
    EXPECT_EQ(resolve_error("reinhard", {{"apply", ""}}),
              "reinhard: apply is ; expected channels, luminance, max or hue_preserving");
}

TEST(Resolve, RefusesTextsThatAreNotNumbersOrOutOfRange) {
    for (const char* text :
         {"-2",   "0",   "0.0099999", "65504.01", "1e999", "-1e999", "nan", "NaN",
          "-nan", "inf", "infinity",  "-inf",     "",      " ",      "4x",  "4 ",
          " 4",   "+4",  "0x10",      "four",     "4,5",   "4.5.6",  "1e",  "--4"}) {
        EXPECT_EQ(resolve_error("reinhard_extended", {{"white", text}}),
                  std::string("reinhard_extended: white is ") + text +
                      "; expected [0.01, 65504] scene-linear");
    }
    EXPECT_EQ(resolve_error("hable", {{"toe_numerator", "1"}}),
              "hable: toe_numerator is 1; expected [0, 0.9]")
        << "a pure number has no unit";
}

TEST(Resolve, RefusesSettingsThatContradictEachOther) {
    const Settings crossed = {{"toe_numerator", "0.5"}, {"toe_denominator", "0.3"}};
    const std::string message = resolve_error("hable", crossed);
    EXPECT_EQ(message.rfind("hable: curve at white is -", 0), 0U) << message;
    EXPECT_NE(message.find("; expected above 0 (toe_numerator below toe_denominator"),
              std::string::npos)
        << message;
    // Lottes' curve x^a/(b x^(ad) + c) has a shoulder for b > 0, which is mid_out >
    // (mid_in/hdr_max)^a, and a toe for c > 0, which is mid_out < (mid_in/hdr_max)^(a(1 - d)).
    // Filament's has d = 1.
    const auto refuses_mid_out = [](const char* name, const char* mid_out,
                                    const std::string& expected) {
        const std::string said = resolve_error(name, {{"contrast", "1"}, {"mid_out", mid_out}});
        EXPECT_EQ(said.rfind(std::string(name) + ": mid_out is " + mid_out + expected, 0), 0U)
            << said;
    };
    refuses_mid_out("filament_generic", "0.0179", "; expected between 0.018");  // 0.18 / 10
    refuses_mid_out("filament_generic", "1", "; expected between 0.018");
    refuses_mid_out("lottes", "0.0224", "; expected above 0.0225");  // 0.18 / 8
    refuses_mid_out("lottes", "0.92", "; expected below 0.916");     // (0.18 / 8)^0.023
    EXPECT_EQ(resolve_error("filament_generic", {{"contrast", "1"}, {"mid_out", "0.0181"}}),
              "no error");
    EXPECT_EQ(resolve_error("lottes", {{"contrast", "1"}, {"mid_out", "0.0226"}}), "no error");
    EXPECT_EQ(resolve_error("lottes", {{"contrast", "1"}, {"mid_out", "0.91"}}), "no error");
    // E = F: h(x) = (x(Ax + CB) + DF)/(x(Ax + B) + DF) - 1 < 0, for C below 1.
    EXPECT_NE(resolve_error("hable", {{"toe_numerator", "0.3"}}), "no error");
    EXPECT_EQ(resolve_error("hable", {{"toe_numerator", "0.05"}}), "no error");
}

const std::string kResponseFile = TONEWRIGHT_TEST_DATA "/synthetic_response.rf";

TEST(Resolve, TextsAreTakenAsTheyAre) {
    const ResolvedOperator none = resolve_operator("camera_response");
    EXPECT_EQ(none.params.text("file"), "");
    EXPECT_EQ(none.params.text("curve"), "");
    EXPECT_EQ(none.params.number("iso"), 6);
    EXPECT_THROW((void)none.params.text("iso"), Error) << "a number is no text";
    EXPECT_THROW((void)none.params.number("file"), Error);
    EXPECT_THROW((void)none.params.choice("file"), Error);
    EXPECT_THROW((void)resolve_operator("reinhard").params.text("apply"), Error);

    const ResolvedOperator file = resolve_operator("camera_response", {{"file", kResponseFile}});
    EXPECT_EQ(file.params.text("file"), kResponseFile);
    EXPECT_EQ(file.label, "camera_response file=" + kResponseFile);
    EXPECT_EQ(resolve_operator("camera_response", {{"file", ""}}).label, "camera_response");
    const Vector3 gray = {0.5, 0.5, 0.5};
    EXPECT_NE(shown(file.build(), gray), shown(none.build(), gray));
    const ResolvedOperator blue =
        resolve_operator("camera_response", {{"file", kResponseFile}, {"curve", "blue"}});
    EXPECT_EQ(shown(blue.build(), gray)[0], shown(file.build(), gray)[2]);
}

TEST(Resolve, UnknownTextsAreErrors) {
    EXPECT_EQ(resolve_error("camera_response", {{"curve", "gold"}}),
              "camera_response: curve is gold; expected a file that has it");
    // A file that is missing is no wrong usage: the command exits with another code.
    EXPECT_THROW((void)resolve_operator("camera_response", {{"file", "/nonexistent.rf"}}),
                 FileError);
    const std::string missing = resolve_error("camera_response", {{"file", "/nonexistent.rf"}});
    EXPECT_EQ(missing.rfind("camera_response: /nonexistent.rf", 0), 0U) << missing;
    const std::string curve =
        resolve_error("camera_response", {{"file", kResponseFile}, {"curve", "gold"}});
    EXPECT_EQ(curve.rfind("camera_response: ", 0), 0U) << curve;
    EXPECT_NE(curve.find("gold"), std::string::npos) << curve;
}

TEST(Parameter, KindsAreMadeByTheirFunctions) {
    using Kind = ParameterSpec::Kind;
    const ParameterSpec number = number_parameter("a", "stops", 1, 0, 2, "help");
    EXPECT_EQ(number.kind, Kind::number);
    EXPECT_EQ(number.from_picture, nullptr);
    const ParameterSpec choice = choice_parameter("b", {"x", "y"}, "y", "help");
    EXPECT_EQ(choice.kind, Kind::choice);
    EXPECT_EQ(choice.default_choice, "y");
    const ParameterSpec text = text_parameter("c", "help");
    EXPECT_EQ(text.kind, Kind::text);
    EXPECT_EQ(text.default_choice, "");
    EXPECT_TRUE(text.choices.empty());
    const ParameterSpec statistic = statistic_parameter(
        number, "mean", [](const SceneStatistics& s) { return s.mean_luminance; });
    EXPECT_EQ(statistic.kind, Kind::number);
    EXPECT_EQ(statistic.name, "a");
    EXPECT_EQ(statistic.default_value, 1);
    EXPECT_EQ(statistic.statistic, "mean");
    SceneStatistics s;
    s.mean_luminance = 0.25;
    EXPECT_EQ(statistic.from_picture(s), 0.25);
}

// ---------------------------------------------------------------------------------------------
// Statistics

SceneStatistics some_scene() {
    SceneStatistics s;
    s.log_average = 0.11;
    s.mean_luminance = 0.37;
    s.minimum_luminance = 0.0003;
    s.maximum_luminance = 41.7;
    s.mean_rgb = {0.5, 0.3, 0.2};
    s.maximum_rgb = {50, 40, 30};
    return s;
}

TEST(Statistics, FillUnsetParameters) {
    EXPECT_EQ(resolve_for_picture(resolve_operator("exponential"), some_scene()).settings,
              (Settings{{"average", "0.37"}}));
    EXPECT_EQ(resolve_for_picture(resolve_operator("drago"), some_scene()).settings,
              (Settings{{"log_average", "0.11"}, {"maximum", "41.7"}}));
    EXPECT_EQ(resolve_operator("exponential").params.number("average"), 1)
        << "without a picture the default";
    // An operator that asks nothing of a picture gets nothing.
    EXPECT_EQ(resolve_for_picture(resolve_operator("hable"), some_scene()).settings, Settings{});
    EXPECT_EQ(
        resolve_for_picture(resolve_operator("hable", {{"white", "4"}}), some_scene()).settings,
        (Settings{{"white", "4"}}));
}

TEST(Statistics, TheUserWins) {
    EXPECT_EQ(resolve_for_picture(resolve_operator("exponential", {{"average", "3"}}), some_scene())
                  .settings,
              (Settings{{"average", "3"}}));
    EXPECT_EQ(resolve_for_picture(resolve_operator("drago", {{"maximum", "9"}, {"bias", "0.7"}}),
                                  some_scene())
                  .settings,
              (Settings{{"bias", "0.7"}, {"log_average", "0.11"}, {"maximum", "9"}}));
}

/// A preset that lives as long as this does: no operator has one that sets a statistic.
class PresetForTest {
  public:
    // The registry's vector is const, its elements are not.
    PresetForTest(std::string_view id, Preset preset)
        : op_(const_cast<Operator&>(find_operator(id))) {
        op_.presets.push_back(std::move(preset));
    }
    ~PresetForTest() { op_.presets.pop_back(); }
    PresetForTest(const PresetForTest&) = delete;
    PresetForTest& operator=(const PresetForTest&) = delete;

  private:
    Operator& op_;
};

TEST(Statistics, ThenThePreset) {
    const PresetForTest preset("drago", {"bright", "Bright", {{"maximum", "20"}}});
    const Settings of_picture =
        resolve_for_picture(resolve_operator("drago:bright"), some_scene()).settings;
    EXPECT_EQ(of_picture, (Settings{{"log_average", "0.11"}}));
    const Params params = resolve_operator("drago:bright", of_picture).params;
    EXPECT_EQ(params.number("maximum"), 20);
    EXPECT_EQ(params.number("log_average"), 0.11);
    const Settings of_user =
        resolve_for_picture(resolve_operator("drago:bright", {{"maximum", "7"}}), some_scene())
            .settings;
    EXPECT_EQ(resolve_operator("drago:bright", of_user).params.number("maximum"), 7);
}

TEST(Statistics, AreLimitedToTheInterval) {
    SceneStatistics s = some_scene();
    s.mean_luminance = 1e9;
    EXPECT_EQ(resolve_for_picture(resolve_operator("exponential"), s).settings,
              (Settings{{"average", "65504"}}));
    EXPECT_EQ(resolve_for_picture(resolve_operator("exponential"), {}).settings,
              (Settings{{"average", "1e-06"}}));
}

TEST(Statistics, KeepEveryDigit) {
    SceneStatistics s;
    s.mean_luminance = 0.1 + 0.2;  // 0.30000000000000004
    EXPECT_EQ(resolve_operator("exponential",
                               resolve_for_picture(resolve_operator("exponential"), s).settings)
                  .params.number("average"),
              0.1 + 0.2);
}

TEST(Statistics, OfEveryPictureAreAccepted) {
    // Black; one gray; a pixel of light in the dark; the brightest there is.
    SceneStatistics uniform = {0.18, 0.18, 0.18, 0.18, {0.18, 0.18, 0.18}, {0.18, 0.18, 0.18}};
    SceneStatistics spark = {65504, 0.01, 65504, 65504, {0.01, 0.01, 0.01}, {65504, 65504, 65504}};
    SceneStatistics dim = {5e-324, 5e-324, 5e-324, 5e-324, {0, 0, 7e-323}, {0, 0, 7e-323}};
    SceneStatistics wide = {1, 100, 1e-45, 65504, {100, 100, 100}, {65504, 65504, 65504}};
    for (const SceneStatistics& s : {SceneStatistics{}, uniform, spark, dim, wide, some_scene()}) {
        for (const Operator& op : all_operators()) {
            EXPECT_EQ(
                resolve_error(op.id, resolve_for_picture(resolve_operator(op.id), s).settings),
                "no error");
            for (const Preset& preset : op.presets) {
                const std::string name = op.id + ":" + preset.id;
                EXPECT_EQ(
                    resolve_error(name, resolve_for_picture(resolve_operator(name), s).settings),
                    "no error");
            }
        }
    }
}

// ---------------------------------------------------------------------------------------------
// How a curve meets color

const Vector3 kColor = {2, 0.5, 0.1};
const double kL = 0.2126 * 2 + 0.7152 * 0.5 + 0.0722 * 0.1;

Pipeline reinhard(const Settings& settings) {
    return resolve_operator("reinhard", settings).build();
}

TEST(Apply, NormsAndChannels) {
    expect_rgb(shown(reinhard({}), kColor), {2.0 / 3, 0.5 / 1.5, 0.1 / 1.1}, kRounding);
    // f(n)/n = 1/(1 + n)
    expect_rgb(shown(reinhard({{"apply", "luminance"}}), kColor),
               {2 / (1 + kL), 0.5 / (1 + kL), 0.1 / (1 + kL)}, kRounding);
    expect_rgb(shown(reinhard({{"apply", "max"}}), kColor), {2.0 / 3, 0.5 / 3, 0.1 / 3}, kRounding);
    const double lo = 0.1 / 1.1;
    expect_rgb(shown(reinhard({{"apply", "hue_preserving"}}), kColor),
               {2.0 / 3, lo + (2.0 / 3 - lo) * 0.4 / 1.9, lo}, kRounding);
}

/// Mantiuk et al. 2009 written out, for f = L/(1 + L), whose contrast d ln f/d ln L is 1/(1 + L).
Vector3 corrected(bool is_nonlinear, bool is_from_contrast, double s) {
    if (is_from_contrast) {
        const double k1 = is_nonlinear ? 1.6774 : 2.3892;
        const double power = std::pow(1 / (1 + kL), is_nonlinear ? 0.9925 : 0.8552);
        s *= (1 + k1) * power / (1 + k1 * power);
    }
    Vector3 out{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double ratio = kColor[c] / kL;
        out[c] = (is_nonlinear ? std::pow(ratio, s) : (ratio - 1) * s + 1) * kL / (1 + kL);
    }
    return out;
}

TEST(Apply, ColorCorrections) {
    for (const bool is_nonlinear : {false, true}) {
        for (const bool is_from_contrast : {false, true}) {
            for (const char* s : {"0", "0.6", "1", "1.7"}) {
                const Settings settings = {
                    {"apply", "luminance"},
                    {"color_correction", is_nonlinear ? "nonlinear" : "luminance_preserving"},
                    {"saturation", s},
                    {"saturation_from", is_from_contrast ? "contrast" : "fixed"}};
                const Pipeline p = reinhard(settings);
                expect_rgb(shown(p, kColor),
                           corrected(is_nonlinear, is_from_contrast, std::stod(s)), kRounding,
                           to_string(p));
                EXPECT_EQ(shown(p, {0, 0, 0}), (Vector3{0, 0, 0})) << "black is black";
                EXPECT_EQ(shown(p, {-1, -1, -1}), (Vector3{0, 0, 0}));
            }
        }
    }
}

TEST(Apply, NonlinearCorrectionKeepsAChannelThatIsBlack) {
    for (const char* from : {"fixed", "contrast"}) {
        // Also where the curve is so flat that its contrast is next to nothing.
        for (const double light : {0.2, 60000.0}) {
            const Vector3 out = shown(reinhard({{"apply", "luminance"},
                                                {"color_correction", "nonlinear"},
                                                {"saturation", "0.6"},
                                                {"saturation_from", from}}),
                                      {light, light / 2, 0});
            EXPECT_GT(out[1], 0);
            EXPECT_EQ(out[2], 0);
        }
    }
}

TEST(Apply, LuminancePreservingKeepsTheLuminanceOfTheCurve) {
    const Vector3 out = shown(reinhard({{"apply", "luminance"},
                                        {"color_correction", "luminance_preserving"},
                                        {"saturation", "0.4"}}),
                              kColor);
    EXPECT_NEAR(0.2126 * out[0] + 0.7152 * out[1] + 0.0722 * out[2], kL / (1 + kL), kRounding);
}

TEST(Apply, SettingsThatContradictEachOtherNameTheOperator) {
    for (const char* apply : {"channels", "max", "hue_preserving"}) {
        EXPECT_EQ(resolve_error("reinhard", {{"apply", apply}, {"color_correction", "nonlinear"}}),
                  std::string("reinhard: color_correction is nonlinear; expected ratio with "
                              "apply=") +
                      apply);
    }
    EXPECT_EQ(resolve_error("reinhard_extended:luminance", {{"saturation", "0.5"}}),
              "reinhard_extended: saturation is 0.5; expected 1 with color_correction=ratio");
    EXPECT_EQ(resolve_error("exponential", {{"saturation_from", "contrast"}}),
              "exponential: saturation_from is contrast; expected fixed with "
              "color_correction=ratio");
    EXPECT_EQ(resolve_error("reinhard", {{"saturation", "2.5"}}),
              "reinhard: saturation is 2.5; expected [0, 2]");
}

Params apply_params(const std::string& apply) {
    return resolve_operator("reinhard", {{"apply", apply}}).params;
}

TEST(Apply, NormsNeedACurveThatStartsAtBlack) {
    const ToneCurve lifted{.f = kX / (1 + kX) + 0.125};
    for (const char* apply : {"luminance", "max"}) {
        EXPECT_EQ(error_of([&] { (void)apply_tone_curve(lifted, apply_params(apply)); }),
                  std::string("apply is ") + apply +
                      "; expected channels or hue_preserving: the curve is 0.125 at black, and a "
                      "factor cannot lift 0");
    }
    for (const char* apply : {"channels", "hue_preserving"}) {
        expect_rgb(shown(apply_tone_curve(lifted, apply_params(apply)), {0, 0, 0}),
                   {0.125, 0.125, 0.125}, kRounding);
    }
    // One that starts below 0 starts at 0: f(1) = 0.25, f(0.25) < 0.
    const ToneCurve crushed{.f = kX - 0.75};
    const Pipeline p = apply_tone_curve(crushed, apply_params("max"));
    expect_rgb(shown(p, {1, 0.5, 0}), {0.25, 0.125, 0}, kRounding);
    EXPECT_EQ(shown(p, {0.25, 0.5, 0}), (Vector3{0, 0, 0}));
}

TEST(Apply, OfCodeValuesNormsScaleTheLight) {
    // Code x/(1 + x) of power 2; n = 4: code 0.8, light 0.64, so all are scaled by 0.16.
    const ToneCurve code{.f = kX / (1 + kX), .code_power = 2};
    expect_rgb(shown(apply_tone_curve(code, apply_params("max")), {4, 1, 0}),
               {0.8, std::sqrt(0.16), 0}, kRounding);
    expect_rgb(shown(apply_tone_curve(code, apply_params("channels")), {4, 1, 0}), {0.8, 0.5, 0},
               kRounding);
    expect_rgb(shown(apply_tone_curve(code, apply_params("hue_preserving")), {4, 1, 0}),
               {0.8, 0.2, 0}, kRounding);
}

TEST(Apply, ParametersFollowTheOperatorsOwn) {
    const std::vector<ParameterSpec> all =
        with_apply("max", {number_parameter("white", "", 4, 1, 9, "help")});
    std::vector<std::string> names;
    for (const ParameterSpec& p : all)
        names.push_back(p.name);
    EXPECT_EQ(names, (std::vector<std::string>{"white", "apply", "color_correction", "saturation",
                                               "saturation_from"}));
    EXPECT_EQ(all[1].default_choice, "max");
}

// ---------------------------------------------------------------------------------------------
// DocumentedDifferences

TEST(DocumentedDifferences, SayWhatTheUserSees) {
    using Kind = DocumentedDifference::Kind;
    const auto text = [](Kind kind, double value, const char* when = "") {
        return to_string(DocumentedDifference{kind, value, when});
    };
    EXPECT_EQ(text(Kind::black, 0.00287), "lifts black to 0.0029");
    EXPECT_EQ(text(Kind::black, -0.0023), "takes black to -0.0023, which displays clip");
    EXPECT_EQ(text(Kind::black, 0, "soft"), "soft: black is 0");
    EXPECT_EQ(text(Kind::crushes_black, 0.004), "shows grays up to 0.004 as black");
    EXPECT_EQ(text(Kind::never_reaches_white, 0.9826),
              "never reaches white: at most 0.983 of display white");
    EXPECT_EQ(text(Kind::exceeds_white, 1.287), "exceeds white, up to 1.29; SDR displays clip it");
    EXPECT_EQ(text(Kind::exceeds_white, kInfinity),
              "exceeds white without limit; SDR displays clip it");
    EXPECT_EQ(text(Kind::not_monotone, 0.0044), "non-monotone below 0.0044");
    EXPECT_EQ(text(Kind::not_monotone, kInfinity), "non-monotone");
    EXPECT_EQ(text(Kind::tints_gray, 0.0574), "tints gray: its channels differ by up to 0.057");
    EXPECT_EQ(text(Kind::jumps, 0.00104), "jumps by 0.001 from one gray to the next");
    EXPECT_EQ(text(Kind::exceeds_white, 10, "hdr"),
              "hdr: exceeds white, up to 10; SDR displays clip it");
}

// ---------------------------------------------------------------------------------------------
// Registry

bool is_lower_snake(const std::string& id) {
    if (id.empty() || id.front() < 'a' || id.front() > 'z' || id.back() == '_') return false;
    return std::all_of(id.begin(), id.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    });
}

bool is_line(const std::string& text) {
    return !text.empty() &&
           std::all_of(text.begin(), text.end(), [](char c) { return c >= 32 && c < 127; });
}

std::string lower(std::string text) {
    for (char& c : text)
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    return text;
}

TEST(Registry, IsSortedByUniqueIds) {
    const auto& all = all_operators();
    ASSERT_FALSE(all.empty());
    for (std::size_t i = 0; i + 1 < all.size(); ++i)
        EXPECT_LT(all[i].id, all[i + 1].id);
    for (const Operator& op : all) {
        EXPECT_TRUE(is_lower_snake(op.id)) << op.id;
        EXPECT_EQ(&find_operator(op.id), &op);
    }
}

TEST(Registry, OperatorsAreDescribed) {
    std::set<std::string> views;
    for (const Operator& op : all_operators()) {
        SCOPED_TRACE(op.id);
        EXPECT_TRUE(views.insert(lower(op.view)).second) << "OCIO compares views without case";
        EXPECT_LE(op.view.size(), 63U) << "Blender's limit";
        for (const std::string* text :
             {&op.title, &op.view, &op.character, &op.source, &op.license, &op.negatives}) {
            EXPECT_TRUE(is_line(*text)) << "one line of plain text: " << *text;
        }
        for (const std::string& warning : op.warnings)
            EXPECT_TRUE(is_line(warning) && warning.back() != '.') << warning;
        const bool is_bound_as_usual =
            op.bounds.simd == 1e-6 && op.bounds.ocio_cpu == 0 && op.bounds.ocio_gpu == 0;
        EXPECT_TRUE(is_bound_as_usual || is_line(op.bounds.reason)) << "a bound needs its reason";
        ASSERT_NE(op.build, nullptr);
        EXPECT_TRUE(op.output == OutputKind::display_linear || op.code_power > 1);
    }
}

TEST(Registry, KnownDefectsAreInNoListAndNoNameFindsThem) {
    ASSERT_GE(known_defects().size(), 5U);
    for (const Operator& defect : known_defects()) {
        SCOPED_TRACE(defect.id);
        EXPECT_TRUE(is_lower_snake(defect.id));
        EXPECT_TRUE(is_line(defect.defect) && defect.defect.back() != '.');
        EXPECT_TRUE(is_line(defect.source) && is_line(defect.license));
        EXPECT_FALSE(resolve_operator(defect.meant).op->is_defect());
        for (const std::vector<Operator>* listed : {&all_operators(), &local_operators()}) {
            for (const Operator& op : *listed)
                EXPECT_NE(op.id, defect.id);
        }
        for (const OperatorVariant& v : all_variants())
            EXPECT_NE(v.name, defect.id);
        const std::string error = resolve_error(defect.id, {});
        EXPECT_NE(error.find("expected an id"), std::string::npos) << error;
        for (const Operator& other : known_defects())
            EXPECT_EQ(error.find(other.id, error.find("expected")), std::string::npos) << error;
    }
    for (const Operator& op : all_operators())
        EXPECT_TRUE(!op.is_defect() && op.meant.empty()) << op.id;
}

TEST(Registry, ParametersAreWellFormed) {
    for (const Operator& op : all_operators()) {
        std::set<std::string> names;
        for (const ParameterSpec& p : op.parameters) {
            SCOPED_TRACE(op.id + " " + p.name);
            EXPECT_TRUE(is_lower_snake(p.name));
            EXPECT_TRUE(names.insert(p.name).second) << "twice";
            EXPECT_TRUE(is_line(p.help));
            EXPECT_EQ(p.from_picture != nullptr, !p.statistic.empty());
            switch (p.kind) {
                case ParameterSpec::Kind::number:
                    EXPECT_LT(p.min, p.max);
                    EXPECT_LE(p.min, p.default_value);
                    EXPECT_GE(p.max, p.default_value);
                    EXPECT_TRUE(std::isfinite(p.min) && std::isfinite(p.max));
                    EXPECT_TRUE(p.choices.empty());
                    break;
                case ParameterSpec::Kind::choice:
                    EXPECT_EQ(std::count(p.choices.begin(), p.choices.end(), p.default_choice), 1);
                    EXPECT_EQ(std::set<std::string>(p.choices.begin(), p.choices.end()).size(),
                              p.choices.size());
                    EXPECT_EQ(p.from_picture, nullptr);
                    break;
                case ParameterSpec::Kind::text:
                    EXPECT_TRUE(p.choices.empty());
                    EXPECT_EQ(p.from_picture, nullptr);
                    break;
            }
        }
    }
}

TEST(Registry, PresetsAndLooksResolve) {
    for (const Operator& op : all_operators()) {
        std::set<std::string> ids;
        for (const Preset& preset : op.presets) {
            SCOPED_TRACE(op.id + ":" + preset.id);
            EXPECT_TRUE(is_lower_snake(preset.id));
            EXPECT_TRUE(ids.insert(preset.id).second);
            EXPECT_TRUE(is_line(preset.title));
            EXPECT_FALSE(preset.settings.empty());
            EXPECT_EQ(resolve_error(op.id + ":" + preset.id), "no error");
        }
        ids.clear();
        for (const Look& look : op.looks) {
            SCOPED_TRACE(op.id + " look " + look.id);
            EXPECT_TRUE(is_lower_snake(look.id));
            EXPECT_TRUE(ids.insert(look.id).second);
            EXPECT_TRUE(is_line(look.title) && is_line(look.help));
            EXPECT_EQ(resolve_error(op.id, {}, look.id), "no error");
        }
    }
}

/// The picture of a set of colors in one list of numbers.
std::vector<double> picture(const ResolvedOperator& op) {
    const std::vector<Vector3> colors = {{0, 0, 0},        {0.01, 0.01, 0.01}, {0.18, 0.18, 0.18},
                                         {0.7, 0.3, 0.05}, {2, 4, 1},          {30, 3, 9}};
    std::vector<double> numbers;
    const Pipeline pipeline = op.build();
    for (const Vector3& rgb : colors) {
        const Vector3 out = shown(pipeline, rgb);
        numbers.insert(numbers.end(), out.begin(), out.end());
    }
    return numbers;
}

/// Half of the parameters moved, by little or much: some are read with certain others only.
Settings random_settings(const Operator& op, std::mt19937& random) {
    const auto uniform = [&] { return static_cast<double>(random()) * 0x1p-32; };
    Settings settings;
    for (const ParameterSpec& p : op.parameters) {
        if (p.kind == ParameterSpec::Kind::text || uniform() < 0.5) continue;
        if (p.kind == ParameterSpec::Kind::choice) {
            settings[p.name] = p.choices[random() % p.choices.size()];
        } else {
            const double end = uniform() < 0.5 ? p.min : p.max;
            const double way = std::pow(10, -5 * uniform());
            settings[p.name] = shortest(p.default_value + way * (end - p.default_value));
        }
    }
    return settings;
}

/// True when some settings show another picture, or are refused, without what they have of `p`.
bool does_something(const Operator& op, const ParameterSpec& p) {
    std::mt19937 random(7);
    for (int i = 0; i < 2000; ++i) {
        const Settings with = random_settings(op, random);
        Settings without = with;
        if (without.erase(p.name) == 0 || resolve_error(op.id, with) != "no error") continue;
        if (resolve_error(op.id, without) != "no error") return true;
        if (picture(resolve_operator(op.id, with)) != picture(resolve_operator(op.id, without)))
            return true;
    }
    return false;
}

TEST(Registry, EveryParameterPresetAndLookHasAnEffect) {
    for (const Operator& op : all_operators()) {
        const std::vector<double> normal = picture(resolve_operator(op.id));
        for (const ParameterSpec& p : op.parameters) {
            if (p.kind == ParameterSpec::Kind::text) continue;  // names a file, or what is in it
            EXPECT_TRUE(does_something(op, p)) << op.id << ": " << p.name << " is never read";
        }
        for (const Preset& preset : op.presets) {
            EXPECT_NE(picture(resolve_operator(op.id + ":" + preset.id)), normal)
                << op.id << ":" << preset.id;
        }
        for (const Look& look : op.looks)
            EXPECT_NE(picture(resolve_operator(op.id, {}, look.id)), normal) << look.id;
    }
}

TEST(Registry, DialectsAreAtLeastTwo) {
    std::map<std::string, int> count;
    for (const Operator& op : all_operators()) {
        EXPECT_TRUE(op.dialects.empty() || is_line(op.dialects)) << op.id;
        ++count[op.dialects];
    }
    count.erase("");
    for (const auto& [name, n] : count)
        EXPECT_GE(n, 2) << name;
}

// ---------------------------------------------------------------------------------------------
// Views

std::vector<std::string> kinds(const Pipeline& pipeline) {
    std::vector<std::string> all;
    for (const Stage& stage : pipeline)
        all.emplace_back(stage_kind(stage));
    return all;
}

Pipeline view_of(std::string_view op, std::string_view display, double stops = 0,
                 std::string_view input = "lin_rec709") {
    return build_view(make_view(resolve_operator(op), input, stops, display));
}

using Kinds = std::vector<std::string>;

TEST(View, StagesComeInOrder) {
    EXPECT_EQ(kinds(view_of("reinhard", "native")), (Kinds{"matrix", "clamp", "curve"}));
    EXPECT_EQ(kinds(view_of("reinhard", "linear")), (Kinds{"matrix", "clamp", "curve", "matrix"}));
    EXPECT_EQ(kinds(view_of("reinhard", "srgb")),
              (Kinds{"matrix", "clamp", "curve", "clamp", "curve"}));
    EXPECT_EQ(kinds(view_of("reinhard", "display_p3")),
              (Kinds{"matrix", "clamp", "curve", "clamp", "matrix", "clamp", "curve"}));
    // clamp, inset, shaper's ends, sigmoid; no negative, decode; SDR; encode
    EXPECT_EQ(
        kinds(view_of("agx_sobotka", "srgb")),
        (Kinds{"matrix", "clamp", "matrix", "clamp", "curve", "clamp", "curve", "clamp", "curve"}));
}

TEST(View, CodeValuesAreDecodedOnce) {
    for (const double x : {0.0, 0.003, 0.18, 1.0, 6.0, 15.0}) {
        const Vector3 rgb = {x, 0.6 * x, 0.2 * x};
        const Vector3 code = shown(view_of("agx_sobotka", "native"), rgb);
        Vector3 light{};
        Vector3 rec1886{};
        Vector3 srgb{};
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_GT(code[c], -1e-12);
            ASSERT_LT(code[c], 1 + 1e-12);
            light[c] = std::pow(std::max(code[c], 0.0), 2.2);
            rec1886[c] = std::pow(light[c], 1 / 2.4);
            srgb[c] = light[c] <= 0.0031308 ? 12.92 * light[c]
                                            : 1.055 * std::pow(light[c], 1 / 2.4) - 0.055;
        }
        expect_rgb(shown(view_of("agx_sobotka", "linear"), rgb), light, kRounding, "linear");
        expect_rgb(shown(view_of("agx_sobotka", "rec1886"), rgb), rec1886, kRounding, "rec1886");
        expect_rgb(shown(view_of("agx_sobotka", "srgb"), rgb), srgb, kRounding, "srgb");
        // On a 2.2 display the operator's own code values come back.
        expect_rgb(shown(view_of("agx_sobotka", "g22"), rgb), code, 1e-12, "g22");
    }
}

TEST(View, LinearAndNativeAreNotLimited) {
    // Reinhard's equation 4 with white 4: 16 (1 + 16/16)/17
    const Vector3 bright = {16, 16, 16};
    const double over = 32.0 / 17;
    expect_rgb(shown(view_of("reinhard_extended", "native"), bright), {over, over, over},
               kRounding);
    expect_rgb(shown(view_of("reinhard_extended", "linear"), bright), {over, over, over},
               kRounding);
    expect_rgb(shown(view_of("reinhard_extended", "srgb"), bright), {1, 1, 1}, kRounding);
    // Wrensch's polynomial at 0 is -0.00232: native keeps it, light is never negative.
    EXPECT_LT(shown(view_of("agx_minimal", "native"), {0, 0, 0})[0], -0.002);
    EXPECT_EQ(shown(view_of("agx_minimal", "linear"), {0, 0, 0}), (Vector3{0, 0, 0}));
}

/// Operator output -> light of the display, as a view of it has it.
Pipeline light_of(const Operator& op, const Display& display) {
    const ResolvedOperator resolved{&op, {}, "", nullptr, {}};
    const DisplayLimit limit = display_limit(resolved, display);
    Pipeline stages = display_light_stages(resolved, limit);
    if (!(limit.primaries == display.primaries))
        stages.push_back(MatrixStage{rgb_to_rgb(limit.primaries, display.primaries)});
    return stages;
}

TEST(View, DisplayLightIsDecodedAndLimited) {
    Operator linear;
    const Display& srgb = find_display("srgb");
    EXPECT_EQ(shown(light_of(linear, srgb), {-1, 0.5, 3}), (Vector3{0, 0.5, 1}));
    Operator code;
    code.output = OutputKind::code_value;
    code.code_power = 2;
    EXPECT_EQ(shown(light_of(code, srgb), {-1, 0.5, 3}), (Vector3{0, 0.25, 1}));
}

TEST(View, LightAboveWhiteNeedsAnOperatorAndADisplayThatHaveIt) {
    Operator op;
    const Display& srgb = find_display("srgb");
    const Display& pq = find_display("rec2100_pq");
    const auto peak = [&](const Display& display) {
        return display_limit({&op, {}, "", nullptr, {}}, display).peak;
    };
    EXPECT_EQ(peak(srgb), 1);
    EXPECT_EQ(peak(pq), 1) << "an SDR picture on an HDR display";
    op.peak = [](const Params&) { return 10.0; };
    EXPECT_EQ(peak(srgb), 1);
    EXPECT_EQ(peak(pq), 10);
    EXPECT_EQ(peak(find_display("rec2100_hlg")), 10);
    op.peak = [](const Params&) { return 40.0; };
    EXPECT_EQ(peak(pq), 40);
    EXPECT_EQ(peak(find_display("rec2100_hlg")), 10) << "HLG of 1000 cd/m2";
}

TEST(View, HdrDisplaysShowLightInUnitsOf100Nits) {
    // ITU-R BT.2100-2 and Report BT.2408: 100 and 203 cd/m2 in PQ; 75 % HLG is 203 cd/m2 of 1000.
    const Vector3 white = {1, 1, 1};
    constexpr double pq_100 = 0.508078421517;
    constexpr double pq_203 = 0.580688881042;
    for (const char* display : {"rec2100_pq", "p3d65_pq"}) {
        expect_rgb(shown(view_of("clamp", display), white), {pq_100, pq_100, pq_100}, 1e-12);
        const View bright = make_view(resolve_operator("clamp"), "lin_rec709", 0, display, 203);
        expect_rgb(shown(build_view(bright), white), {pq_203, pq_203, pq_203}, 1e-12);
    }
    const View hlg = make_view(resolve_operator("clamp"), "lin_rec709", 0, "rec2100_hlg", 203);
    expect_rgb(shown(build_view(hlg), white), {0.7498774, 0.7498774, 0.7498774}, 5e-8);
    // OpenColorIO's DISPLAY - CIE-XYZ-D65_to_REC.2100-HLG-1000nit of 1, 18 and 100 cd/m2
    for (const auto& [light, code] :
         {std::pair{0.01, 0.0974004}, std::pair{0.18, 0.3247812}, std::pair{1.0, 0.6296203}}) {
        expect_rgb(shown(view_of("clamp", "rec2100_hlg"), {light, light, light}),
                   {code, code, code}, 5e-8);
    }
    // A saturated color: BT.2100-2 by hand. Red of Rec.2020 at 100 cd/m2 of 1000: the luminance is
    // 0.02627 of the peak, the scene light 0.1 * 0.02627^(-1/6), the code its OETF.
    const double scene = 0.1 * std::pow(0.02627, -1 / 6.0);
    const double a = 0.17883277;
    const double red = a * std::log(12 * scene - (1 - 4 * a)) + 0.5 - a * std::log(4 * a);
    expect_rgb(shown(Pipeline(find_display("rec2100_hlg").encode), {1, 0, 0}), {red, 0, 0}, 1e-9);
}

TEST(View, DisplaysDecideWhatTheUserDoesNot) {
    const auto number = [](const View& v, const char* name) { return v.op.params.number(name); };
    const auto view = [](const Settings& settings, const char* display, double white = 100) {
        return make_view(resolve_operator("uchimura", settings), "lin_rec709", 0, display, white);
    };
    EXPECT_EQ(number(view({}, "srgb"), "max_brightness"), 1);
    EXPECT_EQ(number(view({}, "rec2100_pq"), "max_brightness"), 10);
    EXPECT_EQ(number(view({{"max_brightness", "4"}}, "rec2100_pq"), "max_brightness"), 4);
    EXPECT_NEAR(number(view({}, "rec2100_pq", 200), "max_brightness"), 5, 1e-12)
        << "1000 cd/m2 are five times a white of 200";
    EXPECT_EQ(view({}, "rec2100_pq").op.label, "uchimura") << "nobody has set it";
    const View p3 = make_view(resolve_operator("agx_blender"), "lin_rec709", 0, "display_p3");
    EXPECT_EQ(p3.op.params.choice("limit"), "p3d65");
    EXPECT_EQ(make_view(p3.op, "lin_rec709", 0, "srgb").op.params.choice("limit"), "rec709")
        << "what a display decided is open on another one";
    const View preset = make_view(resolve_operator("agx_blender:hdr"), "lin_rec709", 0, "srgb");
    EXPECT_EQ(preset.op.params.choice("range"), "hdr") << "a preset is the user's word";
}

TEST(View, ReferenceWhiteIsOneInAbsoluteSources) {
    // SMPTE ST 2084 of 203 and 100 cd/m2.
    constexpr double pq_203 = 0.580688881042;
    constexpr double pq_100 = 0.508078421517;
    const auto view = [](SourceColor source, const char* display, double white, double stops = 0) {
        return build_view(
            make_view(resolve_operator("clamp"), std::move(source), stops, display, white));
    };
    const SourceColor pq = find_source_color("rec2100_pq");
    const auto gray = [](double x) { return Vector3{x, x, x}; };
    expect_rgb(shown(view(pq, "linear", 203), gray(pq_203)), gray(1), 1e-11);
    expect_rgb(shown(view(pq, "linear", 203), gray(pq_100)), gray(100 / 203.0), 1e-11);
    expect_rgb(shown(view(pq, "linear", 100), gray(pq_100)), gray(1), 1e-11);
    // 75 % HLG is 203 cd/m2 on a display of 1000 (Report ITU-R BT.2408).
    const SourceColor hlg = find_source_color("rec2100_hlg");
    expect_rgb(shown(view(hlg, "linear", 406), gray(0.7498774)), gray(0.5), 1e-6);
    expect_rgb(shown(view(hlg, "linear", 100, -2), gray(0.7498774)), gray(2.03 / 4), 1e-6);
    // The number counts for both, so that it changes no code value up to white.
    for (const double white : {100.0, 203.0}) {
        for (const double x : {0.1, 0.3, pq_100})
            expect_rgb(shown(view(pq, "rec2100_pq", white), gray(x)), gray(x), 1e-9);
    }
    // Linear numbers in cd/m2, also beyond half floats: the disk of the sun has 1.6e9 cd/m2.
    const SourceColor nits = in_units(find_source_color("lin_rec709"), InputUnits::luminance);
    expect_rgb(shown(view(nits, "linear", 203), {203, 101.5, 0}), {1, 0.5, 0}, 1e-14);
    expect_rgb(shown(view(nits, "linear", 100, -24), {1.6e9, 4e8, 100}),
               {1.6e7 / 16777216, 4e6 / 16777216, 1 / 16777216.0}, 1e-14);
    EXPECT_EQ(in_units(pq, InputUnits::luminance).scale, pq.scale) << "PQ already is absolute";
    EXPECT_NE(error_of([&] {
                  (void)view(find_source_color("lin_ap1"), "srgb", 203);
              }).find("reference white is 203; expected 100 with display srgb"),
              std::string::npos);
    EXPECT_NE(error_of([&] { (void)parse_input_units("nits"); }).find("input units is nits"),
              std::string::npos);
}

TEST(View, ReferenceWhiteHasAnInterval) {
    for (const double white : {49.0, 1001.0, std::nan("")}) {
        EXPECT_NE(error_of([&] {
                      (void)make_view(resolve_operator("clamp"), "lin_rec709", 0, "rec2100_pq",
                                      white);
                  }).find("; expected [50, 1000] cd/m2"),
                  std::string::npos);
    }
}

TEST(View, KnowsWhichGamutIsInsideWhich) {
    for (const Display& display : all_displays()) {
        EXPECT_TRUE(is_inside(kRec709, display.primaries)) << display.id;
        EXPECT_TRUE(is_inside(display.primaries, display.primaries)) << display.id;
        EXPECT_FALSE(is_inside(kAP0, display.primaries)) << display.id;
    }
    EXPECT_FALSE(is_inside(kP3D65, kRec709));
    EXPECT_FALSE(is_inside(kRec2020, kRec709));
    EXPECT_FALSE(is_inside(kRec2020, kP3D65));
}

TEST(View, AGamutInsideTheDisplaysIsLimitedAsItsOwn) {
    Operator op;  // works in Rec.709
    EXPECT_EQ(kinds(light_of(op, find_display("srgb"))), (Kinds{"clamp"}));
    EXPECT_EQ(kinds(light_of(op, find_display("display_p3"))), (Kinds{"clamp", "matrix"}));
    // (3, 0, 0) is the red of Rec.709, not a brighter one.
    expect_rgb(shown(light_of(op, find_display("display_p3")), {3, 0, 0}),
               shown(light_of(op, find_display("display_p3")), {1, 0, 0}), kRounding);
}

TEST(View, AWiderGamutIsLimitedWhereTheDisplayEnds) {
    Operator op;
    op.working = kRec2020;
    const Display& srgb = find_display("srgb");
    EXPECT_EQ(kinds(light_of(op, srgb)), (Kinds{"matrix", "clamp"}));
    EXPECT_EQ(kinds(light_of(op, find_display("rec2020"))), (Kinds{"clamp"}));
    op.output = OutputKind::code_value;
    EXPECT_EQ(kinds(light_of(op, srgb)), (Kinds{"clamp", "curve", "matrix", "clamp"}));
    op.output = OutputKind::display_linear;
    // ITU-R BT.2087-0, annex 2, in its four decimals, half a unit of the last three times. A limit
    // of green's 1.1 before the matrix would show (0.2208, 1.0682, 0.2258).
    expect_rgb(shown(light_of(op, srgb), {0.5, 1.1, 0.3}),
               {1.6605 * 0.5 - 0.5876 * 1.1 - 0.0728 * 0.3, 1,
                -0.0182 * 0.5 - 0.1006 * 1.1 + 1.1187 * 0.3},
               1e-4);
    // The green of Rec.2020 has red and blue below 0.
    expect_rgb(shown(light_of(op, srgb), {0, 0.5, 0}), {0, 1.1329 * 0.5, 0}, 5e-5);
    // White stays white.
    expect_rgb(shown(light_of(op, srgb), {1, 1, 1}), {1, 1, 1}, kRounding);
    // The gamut of the output counts, not the one it works in.
    op.output_primaries = [](const Params&) { return kRec709; };
    EXPECT_EQ(kinds(light_of(op, srgb)), (Kinds{"clamp"}));
}

TEST(View, ExposureIsAFactorOfTwoAStop) {
    EXPECT_EQ(shown(view_of("clamp", "linear", -3), {4, 2, 1}), (Vector3{0.5, 0.25, 0.125}));
    EXPECT_EQ(shown(view_of("clamp", "linear", 2), {0.125, 0.0625, 0.01}),
              (Vector3{0.5, 0.25, 0.04}));
    expect_rgb(shown(view_of("clamp", "linear", 0.5), {0.5, 0.25, 0}),
               {std::sqrt(0.5), std::sqrt(0.125), 0}, kRounding);
}

Vector3 multiplied_by_hand(const double (&m)[9], const Vector3& v) {
    return {m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
            m[6] * v[0] + m[7] * v[1] + m[8] * v[2]};
}

TEST(View, InputSpacesAreConverted) {
    // Saturated, inside Rec.709, and no two channels alike: a transposed or inverted matrix shows.
    // ACEScg -> Rec.709 (Bradford) in the ten digits of python_check/operators.py, rgb_to_rgb.
    const double ap1[9] = {1.7050509927,  -0.6217921207, -0.0832588720,  //
                           -0.1302564175, 1.1408047366,  -0.0105483191,  //
                           -0.0240033568, -0.1289689761, 1.1529723329};
    const Vector3 rgb = {0.6, 0.3, 0.1};
    expect_rgb(shown(view_of("clamp", "linear", 0, "lin_ap1"), rgb), multiplied_by_hand(ap1, rgb),
               1e-10, "half a unit of the tenth digit, three times");
    // ITU-R BT.2087-0, annex 2, prints BT.2020 -> BT.709 with four decimals.
    const double bt2087[9] = {1.6605,  -0.5876, -0.0728,  //
                              -0.1246, 1.1329,  -0.0083,  //
                              -0.0182, -0.1006, 1.1187};
    expect_rgb(shown(view_of("clamp", "linear", 0, "lin_rec2020"), rgb),
               multiplied_by_hand(bt2087, rgb), 6e-5, "half a unit of the fourth decimal");
    EXPECT_EQ(shown(view_of("clamp", "linear", 0, "lin_rec709"), rgb), rgb);
    // The exposure is in the same matrix.
    const Vector3 darker = multiplied_by_hand(ap1, {0.15, 0.075, 0.025});
    expect_rgb(shown(view_of("clamp", "linear", -2, "lin_ap1"), rgb), darker, 1e-10);
}

TEST(View, DisplayPrimariesAreConverted) {
    // CSS Color 4 shows the red, green and blue of sRGB in display-p3 coordinates; matrix in ten
    // digits as printed for Display P3.
    const double p3[9] = {0.8224619687, 0.1775380313, 0,  //
                          0.0331941989, 0.9668058011, 0,  //
                          0.0170826307, 0.0723974407, 0.9105199286};
    const auto srgb = [](double x) {
        return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
    };
    for (const Vector3& rgb : {Vector3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.7, 0.2, 0.05}}) {
        Vector3 expected = multiplied_by_hand(p3, rgb);
        for (double& x : expected)
            x = srgb(x);
        // Half a unit of the tenth digit times the slope of the sRGB curve, 12.92.
        expect_rgb(shown(view_of("clamp", "display_p3"), rgb), expected, 2e-9);
    }
    expect_rgb(shown(view_of("clamp", "display_p3"), {1, 0, 0}), {0.91749, 0.20029, 0.13856}, 6e-6,
               "color(display-p3 0.91749 0.20029 0.13856) is #f00");
}

TEST(View, WhiteStaysWhiteOnEveryDisplay) {
    for (const InputSpace& space : all_input_spaces()) {
        for (const Display& display : all_displays()) {
            // 2 is beyond white: the clamp in between keeps it at the peak.
            const Vector3 white = shown(display.encode, {1, 1, 1});
            const Vector3 black = shown(display.encode, {0, 0, 0});
            expect_rgb(shown(view_of("clamp", display.id, 0, space.id), {2, 2, 2}), white,
                       kRounding, space.id + " to " + display.id);
            expect_rgb(shown(view_of("clamp", display.id, 0, space.id), {0, 0, 0}), black,
                       kRounding, space.id + " to " + display.id);
        }
    }
}

TEST(View, DisplaysEncodeAsTheirStandardsSay) {
    const Vector3 rgb = {0.5, 0.5, 0.5};
    // IEC 61966-2-1: 1.055 * 0.5^(1/2.4) - 0.055
    const double srgb = 0.735356983052;
    // SMPTE ST 2084 and BT.2100-2 by hand
    const double y = std::pow(50.0 / 10000, 2610.0 / 16384);
    const double pq_of_50 = std::pow((0.8359375 + 18.8515625 * y) / (1 + 18.6875 * y), 2523.0 / 32);
    const double hlg_of_50 = std::sqrt(3 * std::pow(0.05, 1 / 1.2));
    const std::map<std::string, double> expected = {{"srgb", srgb},
                                                    {"display_p3", srgb},
                                                    {"rec1886", std::pow(0.5, 1 / 2.4)},
                                                    {"rec2020", std::pow(0.5, 1 / 2.4)},
                                                    {"g22", std::pow(0.5, 1 / 2.2)},
                                                    // ST 2084 and HLG of 50 cd/m2, see
                                                    // HdrDisplaysShowLightInUnitsOf100Nits
                                                    {"rec2100_pq", pq_of_50},
                                                    {"p3d65_pq", pq_of_50},
                                                    {"rec2100_hlg", hlg_of_50}};
    EXPECT_EQ(expected.size(), all_displays().size()) << "a display without expected values";
    for (const auto& [id, code] : expected)
        expect_rgb(shown(view_of("clamp", id), rgb), {code, code, code}, 1e-12, id);
}

TEST(View, DecodingInvertsEncoding) {
    for (const Display& display : all_displays()) {
        for (const double x : {0.0, 0.001, 0.01, 0.18, 0.5, 1.0}) {
            const Vector3 light = {x, x / 2, 0.25};
            // PQ to the power of 78 and back: some hundred roundings.
            expect_rgb(shown(display.decode, shown(display.encode, light)), light, 1e-13,
                       display.id);
        }
    }
}

TEST(View, NamesAreFoundByIdTitleAliasAndInAnyCase) {
    for (const char* name : {"lin_ap1", "ACEScg", "acescg", "LIN_AP1", "ACES - ACEScg"})
        EXPECT_EQ(find_input_space(name).id, "lin_ap1") << name;
    EXPECT_EQ(find_input_space("linear").id, "lin_rec709") << "what OIIO calls an EXR";
    EXPECT_EQ(find_input_space("aces2065-1").id, "lin_ap0");
    EXPECT_EQ(find_input_space("aces2065_1").id, "lin_ap0");
    for (const char* name : {"display_p3", "Display P3", "displayP3_Display"})
        EXPECT_EQ(find_display(name).id, "display_p3") << name;
    for (const char* name : {"display-p3", "DISPLAY p3", "displayP3-Display"})
        EXPECT_EQ(find_display(name).id, "display_p3") << name;
    EXPECT_EQ(find_input_space("Linear_Rec.2020").id, "lin_rec2020");
    EXPECT_EQ(find_source_color("SRGB-AP1 scene").name, "srgb_ap1_scene");
    EXPECT_EQ(find_source_color("gamma 1.8").name, "Gamma1.8");
    const View view = make_view(resolve_operator("clamp"), "acescg", 0, "REC.1886");
    EXPECT_EQ(view.input, "lin_ap1") << "views hold ids";
    EXPECT_EQ(view.display, "rec1886");
    EXPECT_EQ(make_view(resolve_operator("clamp"), "acescg", 0, "Native").display, "native");
}

TEST(View, NamesAreUnambiguous) {
    std::map<std::string, std::string> owner;
    const auto claim = [&](const std::string& name, const std::string& id) {
        const auto [it, is_new] = owner.emplace(lower(name), id);
        EXPECT_TRUE(is_new || it->second == id) << name << " is " << it->second << " and " << id;
    };
    for (const InputSpace& space : all_input_spaces()) {
        claim(space.id, space.id);
        claim(space.title, space.id);
        for (const std::string& alias : space.aliases)
            claim(alias, space.id);
    }
    owner.clear();
    for (const Display& display : all_displays()) {
        claim(display.id, display.id);
        claim(display.title, display.id);
        for (const std::string& alias : display.aliases)
            claim(alias, display.id);
        EXPECT_NE(lower(display.id), kLinearOutput);
        EXPECT_NE(lower(display.id), kNativeOutput);
    }
}

TEST(View, UnknownNamesGetTheNearest) {
    const auto view_error = [](std::string_view input, double stops, std::string_view display) {
        return error_of([&] { (void)make_view(resolve_operator("clamp"), input, stops, display); });
    };
    EXPECT_EQ(view_error("lin_rec708", 0, "srgb"),
              "input is lin_rec708; expected lin_rec709, lin_ap1, lin_ap0, lin_rec2020, "
              "lin_p3d65, lin_egamut, lin_awg3, lin_awg4, lin_sgamut3, lin_sgamut3cine or "
              "lin_davinci_wg; did you mean lin_rec709?");
    EXPECT_EQ(view_error("bayer", 0, "srgb"),
              "input is bayer; expected lin_rec709, lin_ap1, lin_ap0, lin_rec2020, "
              "lin_p3d65, lin_egamut, lin_awg3, lin_awg4, lin_sgamut3, lin_sgamut3cine or "
              "lin_davinci_wg");
    EXPECT_EQ(view_error("lin_rec709", 0, "srbg"),
              "display is srbg; expected srgb, display_p3, rec1886, rec2020, g22, rec2100_pq, "
              "rec2100_hlg, p3d65_pq, linear or native; did you mean srgb?");
    // Where no light is shown, `linear` is no display.
    EXPECT_EQ(error_of([] { (void)find_display("linear"); }),
              "display is linear; expected srgb, display_p3, rec1886, rec2020, g22, rec2100_pq, "
              "rec2100_hlg or p3d65_pq");
    EXPECT_EQ(view_error("lin_rec709", 65, "srgb"), "exposure is 65; expected [-64, 64] stops");
    EXPECT_EQ(view_error("lin_rec709", -64.5, "srgb"),
              "exposure is -64.5; expected [-64, 64] stops");
    EXPECT_EQ(view_error("lin_rec709", std::nan(""), "srgb"),
              "exposure is nan; expected [-64, 64] stops");
    EXPECT_EQ(view_error("lin_rec709", kInfinity, "srgb"),
              "exposure is inf; expected [-64, 64] stops");
    for (const double end : {-64.0, 64.0})
        EXPECT_EQ(view_error("lin_rec709", end, "srgb"), "no error");
}

TEST(View, SuggestionsAreOfTheSameFamily) {
    const auto said = [](std::string_view display) {
        const std::string message = error_of([&] { (void)find_display(display); });
        const std::size_t at = message.find("did you mean");
        return at == std::string::npos ? std::string() : message.substr(at);
    };
    EXPECT_EQ(said("rec709"), "did you mean srgb, rec1886 or g22?") << "those of its primaries";
    EXPECT_EQ(said("p3"), "did you mean display_p3 or p3d65_pq?");
    EXPECT_EQ(said("hlg"), "did you mean rec2100_hlg?");
    EXPECT_EQ(said("crt"), "");
}

TEST(View, MisspeltOutputsGetTheNearestToo) {
    EXPECT_NE(error_of([] {
                  (void)make_view(resolve_operator("clamp"), "lin_rec709", 0, "nativ");
              }).find("did you mean native?"),
              std::string::npos);
}

TEST(View, KeepsGraysWithinHalfACodeOfTenBits) {
    EXPECT_TRUE(keeps_grays({}));
    EXPECT_TRUE(keeps_grays(view_of("hable", "srgb")));
    const auto offset = [](double codes) {
        return Pipeline{CurveStage{{0.5, 0.5 + codes / 1023, 0.5}, std::nullopt}};
    };
    EXPECT_TRUE(keeps_grays(offset(0.49)));
    EXPECT_FALSE(keeps_grays(offset(0.51)));
    EXPECT_TRUE(keeps_grays(offset(-0.49)));
    EXPECT_FALSE(keeps_grays(offset(-0.51)));
    // Golden is a warm look: slopes 1, 0.9, 0.5.
    EXPECT_FALSE(keeps_grays(build_view(
        make_view(resolve_operator("agx_sobotka", {}, "golden"), "lin_rec709", 0, "srgb"))));
    // Tinted in the brightest stop alone.
    EXPECT_FALSE(keeps_grays({CurveStage{{kX, kX, select(less(8000, kX), 0, kX)}, std::nullopt}}));
    EXPECT_FALSE(keeps_grays({CurveStage{{kX, kX, select(less(kX, 4e-6), 1, kX)}, std::nullopt}}));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
