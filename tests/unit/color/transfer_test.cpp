// SPDX-License-Identifier: Apache-2.0
#include "tonewright/color.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

double at(const Expr& f, double x) { return evaluate(f, x); }
const Expr kX = Expr::input();

TEST(Transfer, SrgbIsIec61966) {
    const Expr e = srgb_encode(kX);
    EXPECT_EQ(at(e, 0), 0);
    EXPECT_NEAR(at(e, 0.001), 0.01292, 1e-15);
    EXPECT_NEAR(at(e, 0.0031308), 0.040449936, 1e-12);
    EXPECT_NEAR(at(e, 0.0031309), 0.0404511777786, 1e-12);
    EXPECT_NEAR(at(e, 0.18), 0.4613561295004, 1e-12);
    EXPECT_NEAR(at(e, 0.5), 0.735356983052, 1e-12);
    EXPECT_NEAR(at(e, 1), 1, 1e-15);
    EXPECT_NEAR(at(e, -0.01), -0.1292, 1e-15) << "negatives follow the straight part";
    for (const double x : {-0.2, 0.0, 0.002, 0.02, 0.5, 1.0, 4.0}) {
        EXPECT_NEAR(at(srgb_decode(e), x), x, 1e-14 * std::max(1.0, x)) << x;
    }
}

TEST(Transfer, PqIsSt2084) {
    const Expr e = pq_encode_nits(kX);
    EXPECT_NEAR(at(e, 0), 7.30955902578e-07, 1e-17) << "c1^m2";
    EXPECT_NEAR(at(e, 0.005), 0.0150763990424, 1e-12);
    EXPECT_NEAR(at(e, 1), 0.1499457321002, 1e-12);
    EXPECT_NEAR(at(e, 100), 0.508078421517, 1e-12);
    EXPECT_NEAR(at(e, 203), 0.580688881042, 1e-12);
    EXPECT_NEAR(at(e, 1000), 0.751827096247, 1e-12);
    EXPECT_NEAR(at(e, 10000), 1, 1e-12);
    EXPECT_NEAR(at(e, -100), -0.508078421517, 1e-12);
    for (const double nits : {0.01, 1.0, 203.0, 9999.0}) {
        EXPECT_NEAR(at(pq_decode_nits(e), nits), nits, 1e-9 * nits);
    }
}

TEST(Transfer, HlgIsBt2100) {
    const Expr e = hlg_oetf(kX);
    EXPECT_EQ(at(e, 0), 0);
    EXPECT_NEAR(at(e, 0.01), 0.173205080757, 1e-12);
    EXPECT_NEAR(at(e, 1.0 / 12), 0.5, 1e-12);
    EXPECT_NEAR(at(e, 0.18), 0.672358132128, 1e-12);
    EXPECT_NEAR(at(e, 0.265), 0.750027752031, 1e-12);
    EXPECT_NEAR(at(e, 1), 0.999999995066, 1e-12);
    for (const double x : {-0.3, 0.0, 0.01, 0.08, 0.09, 0.5, 1.0}) {
        EXPECT_NEAR(at(hlg_inverse_oetf(e), x), x, 1e-14);
    }
}

TEST(Transfer, PurePowersClampNegatives) {
    EXPECT_DOUBLE_EQ(at(bt1886_encode(kX), 0.5), std::pow(0.5, 1 / 2.4));
    EXPECT_DOUBLE_EQ(at(bt1886_decode(kX), 0.5), std::pow(0.5, 2.4));
    EXPECT_EQ(at(power_encode(kX, 2.2), -1), 0);
}

TEST(Transfer, AcescctIsS2016001) {
    const Expr e = acescct_encode(kX);
    EXPECT_NEAR(at(e, 0), 0.0729055341958355, 1e-16) << "equation 1, first case";
    EXPECT_NEAR(at(e, 0.0078125), 0.155251141552511, 1e-14) << "the standard's break";
    EXPECT_NEAR(at(e, 0.18), 0.413588402492442, 1e-14) << "(log2(0.18) + 9.72) / 17.52";
    EXPECT_NEAR(at(acescct_decode(kX), 1), 222.86094420380761, 1e-10) << "2^7.8";
    for (const double x : {-0.005, 0.0, 0.001, 0.0078125, 0.01, 0.18, 100.0}) {
        EXPECT_NEAR(at(acescct_decode(e), x), x, 1e-13 * std::max(1.0, x));
    }
}

TEST(Pq, DecodesCodesBeyondTheStandardAsItsLargest) {
    // SMPTE ST 2084 ends at 10000 cd/m2, code 1; at 1.95 its formula divides by 0 and is no number
    // beyond.
    const Expr decode = pq_decode_nits(Expr::input());
    for (const double code : {1.0, 1.5, 1.95, 2.0, 65504.0}) {
        EXPECT_NEAR(evaluate(decode, code), 10000, 1e-6) << code;
        EXPECT_NEAR(evaluate(decode, -code), -10000, 1e-6) << code;
    }
}

// ---------------------------------------------------------------------------------------------
// Log curves of cameras: the makers' formulas, computed with 30 digits outside of this project

struct CurvePoint {
    double light;
    double code;
    double tolerance = 2e-12;  // half a unit of the last digit
};

void expect_curve(const char* name, const Expr& decode, const std::optional<Expr>& encode,
                  const std::vector<CurvePoint>& points) {
    for (const CurvePoint& point : points) {
        if (encode) {
            EXPECT_NEAR(at(*encode, point.light), point.code, point.tolerance) << name;
        }
        // The same tolerance as light: the slope of the decoding curve there, with a quarter more
        // for its change.
        const double slope =
            std::abs(at(decode, point.code + 1e-6) - at(decode, point.code - 1e-6)) / 2e-6;
        EXPECT_NEAR(at(decode, point.code), point.light, 1.25 * slope * point.tolerance + 1e-12)
            << name << " code " << point.code;
    }
}

TEST(LogCurve, ArriLogC3IsThatOfThePaper) {
    // "ALEXA Log C Curve, Usage in VFX", 2017, EI 800:
    // 0.247190 log10(5.555556 x + 0.052272) + 0.385537 above 0.010591, 5.367655 x + 0.092809 below.
    expect_curve(
        "LogC3", arri_logc3_decode(kX), arri_logc3_encode(kX),
        {{0, 0.092809}, {0.005, 0.119647275}, {0.18, 0.39100683203408}, {1, 0.57063155812042}});
    EXPECT_NEAR(at(arri_logc3_encode(kX), 0.18) * 1023, 400, 1e-4) << "printed as 400 of 1023";
}

TEST(LogCurve, ArriLogC4IsThatOfTheSpecification) {
    // "LogC4 Logarithmic Color Space, Specification", 2022: (log2(a x + 64) - 6)/14 b + c with
    // a = (2^18 - 16)/117.45, b = 928/1023 and c = 95/1023; from x = t, code 0, down a straight
    // line of the same slope.
    expect_curve("LogC4", arri_logc4_decode(kX), arri_logc4_encode(kX),
                 {{-0.023736856550441, -0.05},
                  {-0.018056996119911, 0},
                  {0, 95.0 / 1023},
                  {0.18, 0.27839583654827},
                  {1, 0.42751936483531},
                  {469.8, 1}});
}

TEST(LogCurve, SonySLog3IsThatOfTheTechnicalSummary) {
    // (420 + 261.5 log10((x + 0.01)/0.19))/1023 from 0.01125 on, 95 + (171.2102946929 - 95)
    // x/0.01125 below. Its table has codes 95, 420 and 598 of 0 %, 18 % and 90 %.
    expect_curve("S-Log3", sony_slog3_decode(kX), sony_slog3_encode(kX),
                 {{0, 95.0 / 1023},
                  {0.005, 0.12597384368107},
                  {0.18, 420.0 / 1023},
                  {0.9, 0.58445284207507}});
    EXPECT_EQ(std::round(at(sony_slog3_encode(kX), 0.9) * 1023), 598);
}

TEST(LogCurve, DaVinciIntermediateIsThatOfThePaper) {
    // "DaVinci Resolve 17 Wide Gamut Intermediate", 2021: 0.07329248 (log2(x + 0.0075) + 7) above
    // 0.00262409, 10.44426855 x below. Its table has the first six decimals.
    expect_curve("DaVinci Intermediate", davinci_intermediate_decode(kX),
                 davinci_intermediate_encode(kX),
                 {{-0.01, -0.1044426855},
                  {0, 0},
                  {0.001, 0.01044426855},
                  {0.18, 0.336043272385},
                  {1, 0.513837441116},
                  {10, 0.756598982755},
                  {100, 0.999999987017}});
}

TEST(LogCurve, CanonLogsAreThoseOfTheInputTransforms) {
    // Canon, "Input Transform" version 202007, of r = x/0.9:
    // 0.24136077 log10(87.099375 r + 1) + 0.092864125, mirrored at black;
    // 0.36726845 log10(14.98325 r + 1) + 0.12240537 above r = 0.014, 1.9754798 r + 0.12512219 down
    // to -0.014, 0.12783901 - 0.36726845 log10(1 - 14.98325 r) below.
    expect_curve("Canon Log 2", canon_log2_decode(kX), {},
                 {{-0.0052202218330502, 0.05}, {0, 0.092864125}, {0.18, 0.398254692038}});
    expect_curve("Canon Log 3", canon_log3_decode(kX), {},
                 {{-0.016082010373323, 0.09},
                  {0, 0.12512219},
                  {0.005, 0.13609707777778},
                  {0.18, 0.343389370374}});
}

TEST(LogCurve, PanasonicVLogIsThatOfTheManual) {
    // "V-Log/V-Gamut Reference Manual", 2014: 0.241514 log10(x + 0.00873) + 0.598206 from 0.01 on,
    // 5.6 x + 0.125 below. Its table has codes 128, 433 and 602 of 0 %, 18 % and 90 %.
    expect_curve("V-Log", panasonic_vlog_decode(kX), {},
                 {{0, 0.125}, {0.005, 0.153}, {0.18, 0.423311448760}, {0.9, 0.588167438154}});
}

TEST(LogCurve, RedLog3G10IsThatOfThePaper) {
    // "White Paper on REDWideGamutRGB and Log3G10", 2017, of y = x + 0.01:
    // 0.224282 log10(155.975327 y + 1), 15.1927 y below 0. Mid gray is a third, and ten stops above
    // it are 1, both within 2e-6.
    expect_curve("Log3G10", red_log3g10_decode(kX), {},
                 {{-0.02, -0.151927},
                  {-0.01, 0},
                  {0, 0.0915514877147},
                  {0.18, 0.333332912026},
                  {1, 0.493448519771},
                  {184.32, 0.999998759501}});
}

TEST(LogCurve, CineonHasBlackAndWhiteOfKodaksPaper) {
    const Expr f = cineon_decode(kX);
    EXPECT_NEAR(at(f, 95.0 / 1023), 0, 1e-15);
    EXPECT_NEAR(at(f, 685.0 / 1023), 1, 1e-15);
    // 0.002 density a code at gamma 0.6: 90.3 codes are a stop. Black is 10^(-590/300) = 0.0108.
    const double black = std::pow(10, -590.0 / 300);
    const auto above_black = [&](double code) { return at(f, code / 1023) * (1 - black) + black; };
    EXPECT_NEAR(above_black(685 - 300 * std::log10(2)), 0.5, 1e-12);
    EXPECT_NEAR(above_black(985), 10, 1e-11);
    EXPECT_LT(at(f, 0), 0) << "below black";
}

TEST(LogCurve, AcesccIsS2014003) {
    // Table 1 of the standard: 0 is (-16 + 9.72)/17.52, 2^-15 and 1 lie on both formulas.
    const Expr f = acescc_decode(kX);
    EXPECT_NEAR(at(f, (-16 + 9.72) / 17.52), 0, 1e-18);
    EXPECT_NEAR(at(f, (-15 + 9.72) / 17.52), std::exp2(-15), 1e-18);
    EXPECT_NEAR(at(f, std::nextafter((-15 + 9.72) / 17.52, -1)), std::exp2(-15), 1e-17);
    EXPECT_NEAR(at(f, 9.72 / 17.52), 1, 1e-14);
    EXPECT_NEAR(at(f, 0.4135884024924423), 0.18, 1e-15) << "(log2(0.18) + 9.72)/17.52";
    // Above the toe it is ACEScct.
    for (const double code : {0.2, 0.5, 1.0, 1.4})
        EXPECT_EQ(at(f, code), at(acescct_decode(kX), code));
}

TEST(LogCurve, UnityAndUnrealHaveTheirMidGray) {
    // Color.hlsl, LinearToLogC: 0.244161 log10(5.555556 x + 0.047996) + 0.386036, ALEXA's EI 1000.
    expect_curve("Unity LogC", unity_logc_decode(kX), unity_logc_encode(kX),
                 {{0, 0.0640377049094}, {0.18, 0.391007034502}, {1, 0.568781573786}});
    // TonemapCommon.ush: 14 stops are the range of codes.
    EXPECT_NEAR(at(unreal_log_encode(kX), 0.18), 444.0 / 1023, 1e-15);
    EXPECT_NEAR(at(unreal_log_encode(kX), 0.36) - at(unreal_log_encode(kX), 0.18), 1.0 / 14, 1e-15);
    for (const double light : {0.0, -1.0, 1e-9})
        EXPECT_NEAR(at(unreal_log_encode(kX), light), 0, 1e-15);
}

TEST(LogCurve, DecodesWhatItEncodesAndRises) {
    const struct {
        const char* name;
        Expr encode;
        Expr decode;
        double least;  // light from which on the curve has an inverse
    } curves[] = {
        {"LogC3", arri_logc3_encode(kX), arri_logc3_decode(kX), -0.5},
        {"LogC4", arri_logc4_encode(kX), arri_logc4_decode(kX), -0.5},
        {"S-Log3", sony_slog3_encode(kX), sony_slog3_decode(kX), -0.5},
        {"DaVinci Intermediate", davinci_intermediate_encode(kX), davinci_intermediate_decode(kX),
         -0.5},
        {"Unity LogC", unity_logc_encode(kX), unity_logc_decode(kX), -0.008},
        {"Unreal log", unreal_log_encode(kX), unreal_log_decode(kX), 0.00267},
    };
    for (const auto& curve : curves) {
        double last = -kInfinity;
        for (const double light :
             {-0.5, -0.1, -0.008, -1e-4, 0.0, 1e-4, 0.00045, 0.001, 0.0026, 0.003, 0.01, 0.0106,
              0.011, 0.0113, 0.18, 1.0, 16.0, 300.0, 65504.0}) {
            if (light < curve.least) continue;
            const double code = at(curve.encode, light);
            EXPECT_GT(code, last) << curve.name << " at " << light;
            last = code;
            // Codes near 1 have 2^-53 each, which a decade of 0.24 makes 4 units of light. The
            // printed constants leave a gap of up to 5e-9 where two formulas meet.
            EXPECT_NEAR(at(curve.decode, code), light, 5e-9 + 1e-13 * std::abs(light))
                << curve.name;
        }
    }
}

TEST(LogCurve, SpecialNumbersStayOrdered) {
    for (const Expr& decode : {arri_logc3_decode(kX), arri_logc4_decode(kX), sony_slog3_decode(kX),
                               davinci_intermediate_decode(kX), canon_log2_decode(kX),
                               canon_log3_decode(kX), panasonic_vlog_decode(kX),
                               red_log3g10_decode(kX), cineon_decode(kX), acescc_decode(kX)}) {
        EXPECT_EQ(at(decode, kInfinity), kInfinity);
        double last = at(decode, -2);
        EXPECT_TRUE(std::isfinite(last));
        // Steps that are no multiple of a break.
        for (double code = -2 + 0.0137; code < 2; code += 0.0137) {
            EXPECT_GE(at(decode, code), last) << code;
            last = at(decode, code);
        }
    }
}

// ---------------------------------------------------------------------------------------------
// Code values of ITU-T H.273, table 3

TEST(Transfer, Bt709InverseIsItem12) {
    // 1.099 0.18^0.45 - 0.099 = 0.409007728864; the straight part ends at 4.5 * 0.018 = 0.081.
    const Expr f = bt709_inverse_oetf(kX);
    EXPECT_NEAR(at(f, 0.409007728864), 0.18, 1e-12);
    EXPECT_NEAR(at(f, 1), 1, 1e-15);
    EXPECT_NEAR(at(f, 0.045), 0.01, 1e-17);
    EXPECT_NEAR(at(f, -0.45), -0.1, 1e-16) << "negatives follow the straight part";
    // The recommendation's constants are rounded: 1.099 0.018^0.45 - 0.099 is 0.08125, so
    // the parts meet within 2.5e-4 of a code.
    EXPECT_NEAR(at(f, 0.081), 0.018, 2.5e-4 / 4.5);
}

TEST(Transfer, Smpte240mIsTheReferenceReproducer) {
    const Expr f = smpte_240m_decode(kX);
    EXPECT_NEAR(at(f, 1), 1, 1e-15);
    EXPECT_NEAR(at(f, 0.08), 0.02, 1e-17) << "4 L below 0.0228";
    EXPECT_NEAR(at(f, 1.1115 * std::pow(0.18, 0.45) - 0.1115), 0.18, 1e-15);
    EXPECT_NEAR(at(f, -0.4), -0.1, 1e-16);
}

TEST(Transfer, ExtendedGamutsMirrorNegatives) {
    // IEC 61966-2-4 mirrors at the same scale, ITU-R BT.1361 at a quarter.
    EXPECT_DOUBLE_EQ(at(xvycc_decode(kX), 0.5), std::pow(0.5, 2.4));
    EXPECT_DOUBLE_EQ(at(xvycc_decode(kX), -0.5), -std::pow(0.5, 2.4));
    EXPECT_DOUBLE_EQ(at(bt1361_decode(kX), 0.5), std::pow(0.5, 2.4));
    EXPECT_DOUBLE_EQ(at(bt1361_decode(kX), -0.25), -0.25) << "code -0.25 is the least";
    EXPECT_DOUBLE_EQ(at(bt1361_decode(kX), -0.125), -std::pow(0.5, 2.4) / 4);
}

TEST(Transfer, LogRangesEndAtTheirDecades) {
    for (const double decades : {2.0, 2.5}) {
        const Expr f = log_range_decode(kX, decades);
        EXPECT_NEAR(at(f, 1), 1, 1e-15);
        EXPECT_NEAR(at(f, 0.5), std::pow(10, -decades / 2), 1e-15);
        EXPECT_NEAR(at(f, 0), std::pow(10, -decades), 1e-15);
        EXPECT_EQ(at(f, -3), at(f, 0)) << "no jump at the end";
    }
}

TEST(Transfer, St428HasTheReferenceWhiteOf48Nits) {
    const Expr f = st428_decode(kX);
    EXPECT_NEAR(at(f, 1), 52.37 / 48, 1e-15);
    // Its white of 48 cd/m2 is code 3960 of 4095 (SMPTE ST 428-1, annex; DCI 1.3, table 10).
    EXPECT_NEAR(at(f, 3960.0 / 4095), 1, 2.6 * 0.5 / 3960) << "half a code";
    EXPECT_EQ(at(f, -0.1), 0);
}

TEST(Transfer, PowersDecodeWhatTheyEncode) {
    for (const double exponent : {1.8, 2.2, 2.6}) {
        EXPECT_DOUBLE_EQ(at(power_decode(kX, exponent), 0.5), std::pow(0.5, exponent));
        for (const double x : {0.0, 1e-6, 0.18, 1.0, 12.0})
            EXPECT_NEAR(at(power_encode(power_decode(kX, exponent), exponent), x), x,
                        1e-14 * std::max(1.0, x));
        EXPECT_EQ(at(power_decode(kX, exponent), -0.5), 0);
    }
}

TEST(Transfer, HlgOotfIsThe1Point2Power) {
    // ITU-R BT.2100-2: gamma is 1.2 on a display of 1000 cd/m2.
    EXPECT_NEAR(at(hlg_ootf_luminance(kX), 0.1), 0.0630957344480193, 1e-15) << "10^-1.2";
    EXPECT_NEAR(at(hlg_inverse_ootf_luminance(kX), 0.0630957344480193), 0.1, 1e-15);
    EXPECT_EQ(at(hlg_ootf_luminance(kX), 1), 1);
    EXPECT_EQ(at(hlg_ootf_luminance(kX), 0), 0);
    double last = -1;
    for (const double x : {-1e-3, 0.0, 1e-6, 2.6e-5, 2.7e-5, 1e-4, 0.01, 0.5, 1.0, 4.0}) {
        const double scene = at(hlg_inverse_ootf_luminance(kX), x);
        EXPECT_GT(scene, last) << "rises through the straight part";
        last = scene;
        EXPECT_NEAR(at(hlg_ootf_luminance(kX), scene), x, 1e-15 * std::max(1.0, x)) << x;
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
