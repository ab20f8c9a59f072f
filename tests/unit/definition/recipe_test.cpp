// SPDX-License-Identifier: Apache-2.0

#include "tonewright/definition.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "tonewright/registry.h"
#include "tonewright/view.h"
#include "unit/definition/definitions.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(Definition, OwnCurveIsTheExpressionOfABuiltIn) {
    const auto op = parsed(
        "[parameter.white]\ndefault = 4\nmin = 0.01\nmax = 65504\n"
        "[[stage]]\nclamp = [0, 65504]\n"
        "[[stage]]\ncurve = \"x/(1 + x)\"\n");
    expect_same(built(*op), resolve_operator("reinhard").build(), "reinhard");
}

TEST(Definition, StagesAreThoseOfOperators) {
    const auto op = parsed(R"tone(
[primaries]
working = "ap1"
output = { red = [0.64, 0.33], green = [0.3, 0.6], blue = [0.15, 0.06], white = [0.3127, 0.329] }
[output]
kind = "code_value"
power = 2.4
peak = "1 + k"
[parameter.k]
default = 0.5
min = 0
max = 1
unit = "stops"
doc = "what it does"
[[stage]]
matrix = [[1, 0, 0], [0, "2*3", 0], [0, 0, "1 - k"]]
name = "rotate"
[[stage]]
clamp = [0, inf]
[[stage]]
tone_scale = "x/(x + k)"
[[stage]]
curve = "x/(x + k)"
apply = "max"
[[stage]]
curve = "x*x"
inverse = "sqrt(x)"
[[stage]]
curve = ["x", "x*2", "x*3"]
[[stage]]
hue_preserving = "x*k"
[[stage]]
hexcone = { offset = "x*0.04", value = "x", chroma = "1" }
[[stage]]
temporaries = "low = min(min(r, g), b)"
cross_talk = ["r - low", "g - low*k", "b"]
)tone");
    EXPECT_TRUE(op->working == kAP1);
    const ResolvedOperator resolved = resolve(*op, nullptr, {}, "");
    EXPECT_TRUE(resolved.output_primaries() == kRec709);
    EXPECT_EQ(op->output, OutputKind::code_value);
    EXPECT_EQ(op->code_power, 2.4);
    EXPECT_EQ(resolved.peak(), 1.5);
    const Expr x = Expr::input(0);
    const Expr g = Expr::input(1);
    const Expr b = Expr::input(2);
    const Expr low = min(min(x, g), b);
    // The luminance of ACEScg: SMPTE RP 177 on its primaries.
    const Vector3 weights = rgb_to_xyz(kAP1)[1];
    const Pipeline expected = {
        MatrixStage{{{{1, 0, 0}, {0, 6, 0}, {0, 0, 0.5}}}},
        ClampStage{0, kInfinity},
        ToneScaleStage{ToneScaleStage::Norm::luminance, weights, x / (x + 0.5)},
        ToneScaleStage{ToneScaleStage::Norm::max_rgb, {}, x / (x + 0.5)},
        curve_stage(x * x, sqrt(x)),
        CurveStage{{x, x * 2, x * 3}, std::nullopt},
        HuePreservingStage{x * 0.5},
        HexconeStage{x * 0.04, x, 1},
        CrossTalkStage{{x - low, g - low * 0.5, b}}};
    const Pipeline stages = resolved.build();
    ASSERT_EQ(stages.size(), expected.size());
    for (std::size_t i = 0; i < stages.size(); ++i) {
        EXPECT_EQ(stage_kind(stages[i]), stage_kind(expected[i])) << i;
        expect_same({stages[i]}, {expected[i]}, "stage " + std::to_string(i));
    }
    EXPECT_STREQ(std::get<MatrixStage>(stages[0]).name, "rotate");
    EXPECT_TRUE(std::get<CurveStage>(stages[4]).inverse.has_value());
    // A live parameter stays a uniform: of the matrix, too.
    const std::vector<Expr> live = [&] {
        const std::array<Expr, 3> rgb = compose(build_live(resolved, {"k"}));
        return std::vector<Expr>(rgb.begin(), rgb.end());
    }();
    EXPECT_EQ(uniforms_of(live), std::vector<std::string>{"k"});
    const auto bound = bind_uniforms(build_live(resolved, {"k"}), {{"k", 0.5}});
    expect_same(bound, stages, "bound");
}

TEST(Definition, ChoicesAndLooksChooseStagesAndValues) {
    const auto op = parsed(R"tone(
[parameter.mode]
default = "soft"
choices = ["soft", "hard"]
[parameter.n]
default = 1
min = 0
max = 9
[look.red]
title = "Red"
[[stage]]
curve = "mode == mode.soft ? x*2 : x*3"
[[stage]]
when = "look == look.red"
curve = ["x*5", "x", "x"]
[[stage]]
when = "n > 4"
curve = "x*7"
)tone");
    const auto red_of_1 = [&](const Settings& settings, const std::string& look) {
        return evaluate(compose(built(*op, settings, look))[0], std::array{1.0, 1.0, 1.0});
    };
    EXPECT_EQ(red_of_1({}, ""), 2);
    EXPECT_EQ(red_of_1({{"mode", "hard"}}, ""), 3);
    EXPECT_EQ(red_of_1({}, "red"), 10);
    EXPECT_EQ(red_of_1({{"n", "5"}}, ""), 14);
    EXPECT_TRUE(live_parameters(*op).empty()) << "n decides which stages there are";
}

TEST(Definition, ParametersComeFromPicturesAndDisplays) {
    const auto op = parsed(
        "[parameter.a]\ndefault = 1\nmin = 0\nmax = 9\nfrom_picture = \"log_average\"\n"
        "[parameter.p]\ndefault = 100\nmin = 100\nmax = 2000\nfrom_display = \"peak\"\n"
        "[parameter.gamut]\ndefault = \"rec709\"\nchoices = [\"rec709\", \"p3d65\", \"rec2020\"]\n"
        "from_display = \"gamut\"\n" +
        kStage);
    SceneStatistics statistics;
    statistics.log_average = 0.5;
    const ResolvedOperator resolved = resolve(*op, nullptr, {}, "");
    EXPECT_EQ(resolve_for_picture(resolved, statistics).settings.at("a"), "0.5");
    const ResolvedOperator shown = resolve_for_display(resolved, {kP3D65, true, 1000});
    EXPECT_EQ(shown.params.number("p"), 1000);
    EXPECT_EQ(shown.params.choice("gamut"), "p3d65");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
