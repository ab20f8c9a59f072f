// SPDX-License-Identifier: Apache-2.0
#include "tonewright/input_encoding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tonewright/color.h"
#include "tonewright/view.h"
#include "unit/errors.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(InputEncoding, AcescctIsTheAcademys) {
    const InputEncoding e = parse_input_encoding("acescct");
    EXPECT_EQ(e.id, "acescct");
    EXPECT_EQ(e.default_input, "lin_ap1");
    EXPECT_FALSE(e.is_linear);
    // Academy S-2016-001: (log2(0.18) + 9.72)/17.52, and 2^(17.52 - 9.72) at code 1.
    EXPECT_NEAR(evaluate(e.encode, 0.18), 0.413588402492442, 1e-14);
    EXPECT_NEAR(e.scene_hi, 222.86094420380761, 1e-11);
    // Code 0 is on the straight part.
    EXPECT_NEAR(e.scene_lo, (0 - 0.0729055341958355) / 10.5402377416545, 1e-17);
    EXPECT_NEAR(evaluate(e.encode, e.scene_lo), 0, 1e-16);
    EXPECT_NEAR(evaluate(e.encode, e.scene_hi), 1, 1e-15);
}

/// OpenColorIO 2.5.1's built-in transforms of the same names from ACES2065-1, of grays, and DaVinci
/// Intermediate of its Studio config v4.0.0, 7 digits.
struct GrayCode {
    const char* encoding;
    double scene;
    double code;
};
const GrayCode kGrayCodes[] = {
    {"logc3", 0, 0.09280936},
    {"logc3", 0.001, 0.09817702},
    {"logc3", 0.18, 0.3910069},
    {"logc3", 1, 0.5706313},
    {"logc3", 20, 0.8912776},
    {"logc4", 0, 0.09286413},
    {"logc4", 0.001, 0.09606844},
    {"logc4", 0.18, 0.2783958},
    {"logc4", 1, 0.4275194},
    {"logc4", 20, 0.7050515},
    {"slog3", 0, 0.09286413},
    {"slog3", 0.001, 0.09948607},
    {"slog3", 0.18, 0.4105572},
    {"slog3", 1, 0.5960273},
    {"slog3", 20, 0.9275484},
    {"davinci", 0, 0},
    {"davinci", 0.001, 0.01044426},
    {"davinci", 0.18, 0.3360432},
    {"davinci", 1, 0.5138374},
    {"davinci", 20, 0.8298517},
    // Unreal Engine, TonemapCommon.ush: 0.18 is code 444 of 1023, a stop is 1/14.
    {"unreal_log", 0.18, 444.0 / 1023},
    {"unreal_log", 0.36, 444.0 / 1023 + 1.0 / 14},
    // SMPTE ST 2084: 100 cd/m2 is 0.50807842, 203 is 0.58068888 (ITU-R BT.2408), 10000 is 1.
    {"pq", 1, 0.5080784},
    {"pq:203", 1, 0.5806889},
    {"pq", 100, 1},
    // ITU-R BT.2408: HDR reference white, 203 cd/m2 on a display of 1000, is 75 % HLG; its peak
    // is 1.
    {"hlg:203", 1, 0.7498774},
    {"hlg:1000", 1, 1},
    // sqrt(3 * 0.18 * 0.1^(1/1.2)) by ITU-R BT.2100-2
    {"hlg", 0.18, 0.2815336},
    // IEC 61966-2-1
    {"srgb", 0.18, 0.4613561},
    // Color.hlsl, LinearToLogC: 0.244161 log10(5.555556 x + 0.047996) + 0.386036
    // Blender 5.2, config.ocio: 25 stops, mid gray 10 above the first.
    {"agx_log", 0.18, 0.4},
    {"agx_log", 0.72, 0.48},
    {"unity_logc", 0, 0.0640},
    {"unity_logc", 1, 0.5688},
};

TEST(InputEncoding, GraysHaveThePublishedCodes) {
    for (const GrayCode& row : kGrayCodes) {
        const InputEncoding e = parse_input_encoding(row.encoding);
        // Seven digits, from float32; four by hand; OpenColorIO derives LogC3's constants, of which
        // ARRI prints six digits.
        const std::string_view name = row.encoding;
        const double tolerance = name == "unity_logc" ? 5e-5 : name == "logc3" ? 1e-6 : 3e-7;
        EXPECT_NEAR(evaluate(e.encode, row.scene), row.code, tolerance)
            << row.encoding << " of " << row.scene;
        EXPECT_NEAR(evaluate(e.decode, evaluate(e.encode, row.scene)), row.scene,
                    1e-12 * std::max(1.0, row.scene))
            << row.encoding << " of " << row.scene;
    }
}

/// Linear RGB -> CIE XYZ as the makers print it, row by row.
struct PublishedMatrix {
    const char* space;
    Matrix3 to_xyz;
    double digits;
};
const PublishedMatrix kPublished[] = {
    // "LogC4 Logarithmic Color Space, Specification", 2022
    {"lin_awg4",
     {{{0.704858320407232, 0.129760295170463, 0.115837311473977},
       {0.254524176404027, 0.781477732712002, -0.036001909116029},
       {0, 0, 1.089057750759878}}},
     1e-12},
    // "Technical Summary for S-Gamut3.Cine/S-Log3 and S-Gamut3/S-Log3"
    {"lin_sgamut3",
     {{{0.706482713192318, 0.128801049790558, 0.115172164068795},
       {0.270979670813492, 0.786606411220905, -0.057586082034397},
       {-0.009677845386196, 0.004600037492520, 1.094135558236110}}},
     1e-9},
    // "DaVinci Resolve 17 Wide Gamut Intermediate", 2021
    {"lin_davinci_wg",
     {{{0.70062239, 0.14877482, 0.10105872},
       {0.27411851, 0.87363190, -0.14775041},
       {-0.09896291, -0.13789533, 1.32591599}}},
     1e-7},
};

TEST(InputEncoding, CamerasHaveTheirPublishedPrimaries) {
    for (const PublishedMatrix& row : kPublished) {
        const Matrix3 ours = rgb_to_xyz(find_input_space(row.space).primaries);
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j)
                EXPECT_NEAR(ours[i][j], row.to_xyz[i][j], row.digits) << row.space << i << j;
        }
    }
    // ARRI, "ALEXA Log C Curve, Usage in VFX": Wide Gamut 3 to Rec.709, six digits.
    const Matrix3 arri = {{{1.617523, -0.537287, -0.080237},
                           {-0.070573, 1.334613, -0.264040},
                           {-0.021102, -0.226954, 1.248056}}};
    // Both whites are D65. rgb_to_rgb() goes through ACES2065-1 by ARRI's other matrix, as an
    // OpenColorIO config does, and is up to 5.5e-3 from this one.
    const Matrix3 direct = multiply(inverse(rgb_to_xyz(kRec709)), rgb_to_xyz(kArriWideGamut3));
    const Matrix3 ours = rgb_to_rgb(kArriWideGamut3, kRec709);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            EXPECT_NEAR(direct[i][j], arri[i][j], 2e-6) << i << j;
            EXPECT_NEAR(ours[i][j], arri[i][j], 5.5e-3) << i << j;
        }
    }
}

TEST(InputEncoding, Log2CountsStopsFromMidGray) {
    const InputEncoding e = parse_input_encoding("log2");
    EXPECT_EQ(e.id, "log2:-10:6.5") << "the defaults are in the name";
    EXPECT_EQ(e.default_input, "lin_rec709");
    EXPECT_NEAR(e.scene_lo, 0.18 / 1024, 1e-18);
    EXPECT_NEAR(e.scene_hi, 0.18 * 64 * std::sqrt(2.0), 1e-13);
    EXPECT_NEAR(evaluate(e.encode, 0.18), 10 / 16.5, 1e-15);
    EXPECT_NEAR(evaluate(e.encode, 0.36), 11 / 16.5, 1e-15);
    EXPECT_NEAR(evaluate(e.encode, e.scene_lo), 0, 1e-15);
    EXPECT_NEAR(evaluate(e.encode, e.scene_hi), 1, 1e-15);
    for (const double below : {1e-6, 0.0, -4.0})
        EXPECT_NEAR(evaluate(e.encode, below), 0, 1e-15) << "finite at and below 0";
    const InputEncoding wide = parse_input_encoding("log2:-16:16");
    EXPECT_EQ(wide.id, "log2:-16:16");
    EXPECT_NEAR(evaluate(wide.encode, 0.18), 0.5, 1e-15);
}

TEST(InputEncoding, LinearIsAStraightLine) {
    const InputEncoding e = parse_input_encoding("linear:-1:3");
    EXPECT_TRUE(e.is_linear);
    EXPECT_EQ(e.scene_lo, -1);
    EXPECT_EQ(e.scene_hi, 3);
    EXPECT_EQ(evaluate(e.encode, 1.0), 0.5);
    EXPECT_EQ(evaluate(e.decode, 0.25), 0);
    EXPECT_EQ(parse_input_encoding("linear").id, "linear:0:1");
}

TEST(InputEncoding, DecodeInvertsEncode) {
    for (const char* text :
         {"acescct", "logc3", "logc4", "slog3", "davinci", "unity_logc", "unreal_log", "srgb",
          "reinhard", "agx_log", "pq", "pq:203", "log2", "log2:-3:64", "linear:0.5:8"}) {
        const InputEncoding e = parse_input_encoding(text);
        for (int i = 0; i <= 64; ++i) {
            const double code = i / 64.0;
            const double scene = evaluate(e.decode, code);
            // SMPTE ST 2084 has black at code 7.3e-7, and x/(x + 1) ends at 65504 instead of 1.
            const bool is_pq_black = e.id.starts_with("pq") && i == 0;
            const bool is_end = e.id == "reinhard" && i == 64;
            const double tolerance = is_pq_black ? 1e-6 : is_end ? 1.6e-5 : 1e-13;
            EXPECT_NEAR(evaluate(e.encode, scene), code, tolerance) << text;
            EXPECT_GE(scene, e.scene_lo - 1e-15 * std::fabs(e.scene_lo));
            EXPECT_LE(scene, e.scene_hi * (1 + 1e-14));
        }
    }
}

TEST(InputEncoding, RefusesUnknownNames) {
    const auto error = [](std::string_view text) {
        return error_of([&] { (void)parse_input_encoding(text); });
    };
    EXPECT_EQ(error("acescc"),
              "input encoding is acescc; expected acescct, logc3, logc4, slog3, davinci, "
              "unity_logc, unreal_log, srgb, reinhard, agx_log, pq, hlg, log2 or linear; did you "
              "mean acescct?");
    for (const char* text : {"pq:0", "pq:-1", "pq:nan", "pq:1e6", "pq:", "pq:100:2", "srgb:1"})
        EXPECT_NE(error(text).find(std::string("input encoding is ") + text), std::string::npos)
            << text;
    for (const char* text : {"log2:", "log2:-10", "log2:1:1", "log2:2:1", "log2:a:b", "log2:0:nan",
                             "log2:0:inf", "log2:0:1:2", "log2:0:1 ", "log2::"}) {
        EXPECT_EQ(error(text), std::string("input encoding is ") + text +
                                   "; expected log2:LO:HI with numbers LO < HI");
    }
    EXPECT_EQ(error("log2:-65:0"), "input encoding is log2:-65:0; expected [-64, 64] stops");
    EXPECT_EQ(error("log2:0:64.5"), "input encoding is log2:0:64.5; expected [-64, 64] stops");
    EXPECT_NE(error("linear:1:0"), "no error");
    EXPECT_NE(error("acescct:0:1"), "no error") << "it has no ends to choose";
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
