// SPDX-License-Identifier: Apache-2.0
#include "pipeline/tone_curve.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tonewright/pipeline.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"
#include "unit/errors.h"
#include "unit/pipeline/shown.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input(0);

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

}  // namespace
TONEWRIGHT_NAMESPACE_END
