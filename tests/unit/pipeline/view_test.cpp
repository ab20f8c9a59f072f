// SPDX-License-Identifier: Apache-2.0
#include "tonewright/view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tonewright/pipeline.h"
#include "tonewright/registry.h"
#include "unit/errors.h"
#include "unit/pipeline/shown.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input(0);

std::vector<std::string> kinds(const Pipeline& pipeline) {
    std::vector<std::string> all;
    for (const Stage& stage : pipeline)
        all.emplace_back(stage_kind(stage));
    return all;
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

TEST(View, ExposuresAreFiniteAndWithin64Stops) {
    for (const double stops : {-64.0, -0.0, 64.0})
        EXPECT_NO_THROW(check_exposure(stops)) << stops;
    for (const double stops : {-64.1, 64.1, kInfinity, -kInfinity, std::nan("")})
        EXPECT_THROW(check_exposure(stops), Error) << stops;
}

TEST(View, SceneScaleDividesAbsoluteLightByTheReferenceWhite) {
    SourceColor source;
    EXPECT_EQ(scene_scale(source, 203), 1) << "relative light";
    source.scale = 0.5;
    EXPECT_EQ(scene_scale(source, 203), 0.5);
    source.is_absolute = true;
    // 1.0 is 100 cd/m2; white at 50 cd/m2 makes it 2.
    EXPECT_EQ(scene_scale(source, 100), 0.5);
    EXPECT_EQ(scene_scale(source, 50), 1);
    EXPECT_DOUBLE_EQ(scene_scale(source, 203), 50.0 / 203);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
