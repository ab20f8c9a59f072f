// SPDX-License-Identifier: Apache-2.0
#include "tonewright/pipeline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tonewright/registry.h"
#include "tonewright/view.h"
#include "unit/errors.h"
#include "unit/pipeline/shown.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string lower(std::string text) {
    for (char& c : text)
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    return text;
}

Vector3 multiplied_by_hand(const double (&m)[9], const Vector3& v) {
    return {m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
            m[6] * v[0] + m[7] * v[1] + m[8] * v[2]};
}

TEST(View, InputSpacesAreConverted) {
    // Saturated, inside Rec.709, and no two channels alike: a transposed or inverted matrix shows.
    // ACEScg -> Rec.709 (Bradford) in the ten digits of python_check/operators/spaces.py,
    // rgb_to_rgb.
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
    // `linear` is no display, because it shows no light.
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

}  // namespace
TONEWRIGHT_NAMESPACE_END
