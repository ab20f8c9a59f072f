// SPDX-License-Identifier: Apache-2.0
#include "tonewright/lut.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>

#include "base/atomic_file.h"
#include "base/format_number.h"
#include "base/random.h"
#include "base/strings.h"
#include "lut/clf.h"
#include "lut/half_domain.h"
#include "measure/error_metric.h"
#include "measure/sample_set.h"
#include "tonewright/engine.h"
#include "tonewright/generated_files.h"
#include "tonewright/registry.h"
#include "unit/lut/lut_cases.h"

namespace fs = std::filesystem;

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input();
constexpr unsigned kMinusZero = 0x8000;
constexpr unsigned kLargestHalf = 0x7BFF;
constexpr unsigned kHalfInfinity = 0x7C00;

template <class F>
std::string error_of(const F& f) {
    try {
        f();
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

// ---------------------------------------------------------------------------------------------
// Input encodings

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

TEST(LutFormatName, RoundTrips) {
    EXPECT_EQ(parse_lut_format("cube"), LutFormat::cube);
    EXPECT_EQ(parse_lut_format("clf"), LutFormat::clf);
    EXPECT_EQ(parse_lut_format("spi1d"), LutFormat::spi1d);
    EXPECT_EQ(parse_lut_format("spi3d"), LutFormat::spi3d);
    EXPECT_EQ(parse_lut_format("raw"), LutFormat::raw);
    EXPECT_EQ(lut_format_names().size(), 14U);
    for (const std::string& name : lut_format_names())
        EXPECT_EQ(name_of(parse_lut_format(name)), name);
    EXPECT_EQ(error_of([] { (void)parse_lut_format("cub"); }),
              "format is cub; expected cube, clf, ctf, spi1d, spi3d, csp, resolve_cube, 3dl, "
              "lut, icc, hald, strip, strip_up or raw; did you mean cube?");
}

// ---------------------------------------------------------------------------------------------
// Half floats

TEST(HalfDomain, ValuesAreIeee754Binary16) {
    EXPECT_EQ(half_value(0x0000), 0);
    EXPECT_FALSE(std::signbit(half_value(0x0000)));
    EXPECT_EQ(half_value(kMinusZero), 0);
    EXPECT_TRUE(std::signbit(half_value(kMinusZero)));
    EXPECT_EQ(half_value(0x0001), 0x1p-24) << "smallest subnormal";
    EXPECT_EQ(half_value(0x03FF), 1023 * 0x1p-24) << "largest subnormal";
    EXPECT_EQ(half_value(0x0400), 0x1p-14) << "smallest normal";
    EXPECT_EQ(half_value(0x3555), 0.333251953125);
    EXPECT_EQ(half_value(0x3BFF), 1 - 0x1p-11);
    EXPECT_EQ(half_value(0x3C00), 1);
    EXPECT_EQ(half_value(0x3C01), 1 + 0x1p-10);
    EXPECT_EQ(half_value(0xC000), -2);
    EXPECT_EQ(half_value(kLargestHalf), 65504);
    EXPECT_EQ(half_value(kHalfInfinity), kInfinity);
    EXPECT_EQ(half_value(0xFC00), -kInfinity);
    EXPECT_TRUE(std::isnan(half_value(0x7C01)));
    EXPECT_TRUE(std::isnan(half_value(0xFFFF)));
    for (unsigned bits = 0; bits < kHalfInfinity; ++bits) {
        ASSERT_LT(half_value(bits), half_value(bits + 1));
        ASSERT_EQ(half_value(bits | kMinusZero), -half_value(bits));
    }
}

TEST(HalfDomain, SamplesAreInTheOrderOfTheBits) {
    const std::vector<float> table = sample_half_domain(2 * kX + 1, -kHalfMax, kHalfMax);
    ASSERT_EQ(table.size(), 65536U);
    for (unsigned bits = 0; bits < 65536; ++bits) {
        const unsigned magnitude = bits & 0x7FFF;
        if (magnitude > kLargestHalf) continue;
        ASSERT_EQ(table[bits], static_cast<float>(2 * half_value(bits) + 1)) << bits;
    }
}

TEST(HalfDomain, SpecialEntriesHaveTheirRule) {
    // 1/(x + 2) would tell a wrong entry from a right one everywhere; atan2 tells -0 from +0.
    const Expr f = atan2(kX, -1) + kX / 70000;
    ASSERT_NE(evaluate(f, 0.0), evaluate(f, -0.0)) << "the case is one";
    const std::vector<float> table = sample_half_domain(f, -kHalfMax, kHalfMax);
    EXPECT_EQ(table[kMinusZero], table[0]) << "OCIO's GPU path reads +0 there";
    EXPECT_EQ(table[0], static_cast<float>(evaluate(f, 0.0)));
    for (unsigned bits = 0; bits < 65536; ++bits) {
        const float expected = static_cast<float>(std::isnan(half_value(bits))
                                                      ? evaluate(f, 0.0)
                                                      : evaluate(f, sanitize(half_value(bits))));
        if (bits == kMinusZero) continue;
        ASSERT_EQ(table[bits], expected) << bits << ", " << half_value(bits);
    }
    EXPECT_EQ(table[kHalfInfinity], table[kLargestHalf]);
    EXPECT_EQ(table[kHalfInfinity | kMinusZero], table[kLargestHalf | kMinusZero]);
}

/// A table as its readers see it.
Lut half_lut(std::vector<float> values) {
    Lut lut;
    lut.dimension = 1;
    lut.size = 65536;
    lut.channels = 1;
    lut.is_half_domain = true;
    lut.values = std::move(values);
    return lut;
}

TEST(HalfDomain, HoldsItsEndsWithoutAKinkInside) {
    // Both ends lie between two half floats. A straight line is reproduced by interpolating between
    // any two entries, so inside the interval every error would be the ends' doing.
    constexpr double kLo = 0.0123456;
    constexpr double kHi = 16.3;
    const Lut lut = half_lut(sample_half_domain(0.25 * kX - 1, kLo, kHi));
    for (int i = 0; i <= 100000; ++i) {
        const double x = kLo + (kHi - kLo) * i / 100000;
        // Values of up to 3 in float.
        ASSERT_NEAR(interpolate(lut, {x, x, x})[0], 0.25 * x - 1, 3 * 0x1p-24) << x;
    }
    // Beyond the next half float the end's value holds.
    const auto at = [&](double x) { return interpolate(lut, {x, x, x})[0]; };
    for (const double x : {17.0, 1000.0, 65504.0, 1e30})
        EXPECT_NEAR(at(x), 0.25 * kHi - 1, 3 * 0x1p-24) << x;
    for (const double x : {0.0123, 0.001, 0.0, -0.0, -3.0, -65504.0})
        EXPECT_NEAR(at(x), 0.25 * kLo - 1, 3 * 0x1p-24) << x;
    EXPECT_EQ(lut.values[0x7E00], lut.values[0]) << "NaN";
}

TEST(HalfDomain, SmoothCurvesLoseNothingAtAShapersEnds) {
    // AgX's log2 between its ends: error of a chord between neighboring halves, h^2/8 f'' with
    // h = x 2^-10 and f'' = 1/(ln 2 x^2), is 1.7e-7; and float rounding of values up to 12.5.
    const double lo = std::exp2(-12.47393);
    const double hi = std::exp2(4.026069);
    const Lut lut = half_lut(sample_half_domain(log2(kX), lo, hi));
    for (int i = 0; i <= 100000; ++i) {
        const double x = lo * std::pow(hi / lo, i / 100000.0);
        ASSERT_NEAR(interpolate(lut, {x, x, x})[0], std::log2(x), 1.8e-7 + 12.5 * 0x1p-24) << x;
    }
}

TEST(HalfDomain, EntriesBeyondTheEndsStayFinite) {
    // The entry below this lower end is 0, where log2 has no value.
    for (const float y : sample_half_domain(log2(kX), 0x1p-25, kHalfMax))
        ASSERT_TRUE(std::isfinite(y));
    for (const float y : sample_half_domain(sqrt(kX), 0, kHalfMax))
        ASSERT_TRUE(std::isfinite(y));
    for (const float y : sample_half_domain(1 / kX, 1, 2))
        ASSERT_TRUE(y >= 0.49F && y <= 1.01F);
}

TEST(HalfDomain, InterpolationIsExactAtHalvesAndStraightBetween) {
    const Lut lut = half_lut(sample_half_domain(kX * kX, -kHalfMax, kHalfMax));
    for (unsigned bits = 0; bits <= kLargestHalf; bits += 7) {
        const double x = half_value(bits);
        ASSERT_EQ(interpolate(lut, {x, -x, 0})[0], static_cast<double>(static_cast<float>(x * x)));
        ASSERT_EQ(interpolate(lut, {x, -x, 0})[1], static_cast<double>(static_cast<float>(x * x)));
    }
    // Half way from 1 to its neighbor: (1 + (1 + 2^-10)^2)/2.
    const double x = 1 + 0x1p-11;
    EXPECT_EQ(interpolate(lut, {x, x, x})[2], (1 + (1 + 0x1p-10) * (1 + 0x1p-10)) / 2);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(interpolate(lut, {nan, kInfinity, -kInfinity}), interpolate(lut, {0, 65504, -65504}));
}

// ---------------------------------------------------------------------------------------------
// Interpolation

/// size^3 triplets, red fastest, of f(r, g, b) at the nodes.
template <class F>
Lut cube_of(int size, const F& f) {
    Lut lut;
    lut.size = size;
    for (int b = 0; b < size; ++b) {
        for (int g = 0; g < size; ++g) {
            for (int r = 0; r < size; ++r) {
                const double last = size - 1;
                for (const double y : f(Vector3{r / last, g / last, b / last}))
                    lut.values.push_back(static_cast<float>(y));
            }
        }
    }
    return lut;
}

void expect_near(const Vector3& actual, const Vector3& expected, double tolerance,
                 const Vector3& at) {
    for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_NEAR(actual[c], expected[c], tolerance)
            << "channel " << c << " of (" << at[0] << ", " << at[1] << ", " << at[2] << ")";
    }
}

TEST(Interpolate, IdentityCubeIsExact) {
    // Sixteenths are floats, so what is left is double rounding.
    const Lut lut = cube_of(17, [](const Vector3& v) { return v; });
    for (const Vector3& v : table_inputs(5000)) {
        expect_near(interpolate(lut, v), v, 1e-15, v);
        expect_near(interpolate(lut, v, true), v, 1e-15, v);
    }
}

TEST(Interpolate, TetrahedralReproducesAffineFunctions) {
    // Different in every channel and every direction: a swapped axis or channel shows. The
    // coefficients are dyadic, so the nodes are exact floats.
    const auto f = [](const Vector3& v) {
        return Vector3{0.5 * v[0] + 0.25 * v[1] - 0.125 * v[2] + 1,
                       2 * v[0] - 0.75 * v[1] + 0.0625 * v[2],
                       -1.5 * v[0] + 0.375 * v[1] + 4 * v[2] - 0.25};
    };
    const Lut lut = cube_of(33, f);
    for (const Vector3& v : table_inputs(5000))
        expect_near(interpolate(lut, v), f(v), 1e-14, v);
}

TEST(Interpolate, AxesAreNotSwapped) {
    const auto f = [](const Vector3& v) { return Vector3{v[0], v[1] * v[1], std::sqrt(v[2])}; };
    const Lut lut = cube_of(17, f);
    // Node (r, g, b) = (1, 4, 9) sixteenths.
    const Vector3 node = {1 / 16.0, 4 / 16.0, 9 / 16.0};
    expect_near(interpolate(lut, node), {1 / 16.0, 1 / 16.0, 3 / 4.0}, 1e-15, node);
    // Red is fastest: the entry after the first is red's.
    const Lut red = cube_of(3, [](const Vector3& v) { return Vector3{v[0], 0, 0}; });
    EXPECT_EQ(red.values[3], 0.5F);
    EXPECT_EQ(interpolate(red, {0.5, 0, 0})[0], 0.5);
    EXPECT_EQ(interpolate(red, {0, 0.5, 1})[0], 0);
}

TEST(Interpolate, TrilinearAndTetrahedralAgreeAtNodes) {
    SampleRandom random(22);
    const Lut lut = cube_of(17, [&](const Vector3&) {
        return Vector3{random.uniform(-1, 2), random.uniform(-1, 2), random.uniform(-1, 2)};
    });
    double apart = 0;
    for (std::size_t node = 0; node < 17 * 17 * 17; ++node) {
        const Vector3 v = {static_cast<double>(node % 17) / 16,
                           static_cast<double>(node / 17 % 17) / 16,
                           static_cast<double>(node / 289) / 16};
        const Vector3 tetrahedral = interpolate(lut, v);
        ASSERT_EQ(tetrahedral, interpolate(lut, v, true));
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_EQ(tetrahedral[c], static_cast<double>(lut.values[3 * node + c]));
        }
        const Vector3 between = {v[0] * 0.9, v[1] * 0.9, v[2] * 0.9};
        apart = std::max(
            apart, std::fabs(interpolate(lut, between)[0] - interpolate(lut, between, true)[0]));
    }
    EXPECT_GT(apart, 0.1) << "between nodes they are two things";
}

TEST(Interpolate, WeightsAreThoseOfTheirDefinitions) {
    // One cell with one corner at 1. Tetrahedral: with x >= y >= z the sorted fractions, the near
    // corner weighs 1-x, the one along x weighs x-y, the one along x and y weighs y-z, the far z.
    for (std::size_t corner = 0; corner < 8; ++corner) {
        Lut lut;
        lut.size = 2;
        lut.values.assign(24, 0.0F);
        for (std::size_t c = 0; c < 3; ++c)
            lut.values[3 * corner + c] = 1;
        for (const Vector3& v : table_inputs(300)) {
            double lowest_inside = 1;    // smallest fraction of the axes that the corner has
            double highest_outside = 0;  // largest of those that it has not
            double trilinear = 1;
            for (std::size_t c = 0; c < 3; ++c) {
                const bool has = (corner >> c & 1) != 0;
                if (has) lowest_inside = std::min(lowest_inside, v[c]);
                if (!has) highest_outside = std::max(highest_outside, v[c]);
                trilinear *= has ? v[c] : 1 - v[c];
            }
            const double tetrahedral = std::max(0.0, lowest_inside - highest_outside);
            ASSERT_NEAR(interpolate(lut, v)[1], tetrahedral, 1e-15) << "corner " << corner;
            ASSERT_NEAR(interpolate(lut, v, true)[1], trilinear, 1e-15) << "corner " << corner;
        }
    }
}

TEST(Interpolate, HoldsTheEndsOfTheDomain) {
    const Lut cube = cube_of(17, [](const Vector3& v) { return v; });
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(interpolate(cube, {-3, 2, nan}), (Vector3{0, 1, 0}));
    EXPECT_EQ(interpolate(cube, {-kInfinity, kInfinity, 1}), (Vector3{0, 1, 1}));
    Lut curve;
    curve.dimension = 1;
    curve.size = 3;
    curve.channels = 1;
    curve.values = {0, 0.5F, 2};
    EXPECT_EQ(interpolate(curve, {-1, 2, nan}), (Vector3{0, 2, 0}));
    EXPECT_EQ(interpolate(curve, {0.25, 0.5, 0.75}), (Vector3{0.25, 0.5, 1.25}));
}

TEST(Interpolate, CurvesMayDifferByChannel) {
    Lut lut;
    lut.dimension = 1;
    lut.size = 2;
    lut.channels = 3;
    lut.values = {0, 1, 2, 10, 11, 12};
    EXPECT_EQ(interpolate(lut, {0.5, 0.5, 0.5}), (Vector3{5, 6, 7}));
}

// ---------------------------------------------------------------------------------------------
// Sampling

TEST(SampleLut, NodesAreValuesOfTheView) {
    // A Rec.709 view of `clamp` on a log2 encoding, by hand: light 0.18 * 2^(16.5 n - 10), limited
    // to 1, then IEC 61966-2-1.
    const Lut lut = sample_lut(request_for("clamp", "log2", LutFormat::spi3d, 17));
    ASSERT_EQ(lut.dimension, 3);
    ASSERT_EQ(lut.size, 17);
    ASSERT_EQ(lut.values.size(), 3U * 17 * 17 * 17);
    const auto code = [](std::size_t node) {
        const double light =
            std::min(1.0, 0.18 * std::exp2(16.5 * static_cast<double>(node) / 16 - 10));
        return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
    };
    for (std::size_t b = 0; b < 17; ++b) {
        for (std::size_t g = 0; g < 17; ++g) {
            for (std::size_t r = 0; r < 17; ++r) {
                const float* v = &lut.values[3 * ((b * 17 + g) * 17 + r)];
                ASSERT_NEAR(static_cast<double>(v[0]), code(r), 0x1p-24) << "float rounding";
                ASSERT_NEAR(static_cast<double>(v[1]), code(g), 0x1p-24);
                ASSERT_NEAR(static_cast<double>(v[2]), code(b), 0x1p-24);
            }
        }
    }
}

TEST(SampleLut, DimensionFollowsTheView) {
    EXPECT_EQ(sample_lut(request_for("hable", "log2")).dimension, 1);
    EXPECT_EQ(sample_lut(request_for("hable", "log2")).size, 4096);
    EXPECT_EQ(sample_lut(request_for("agx_sobotka", "log2")).dimension, 3);
    EXPECT_EQ(sample_lut(request_for("agx_sobotka", "log2")).size, 33);
    EXPECT_EQ(sample_lut(request_for("hable", "acescct")).dimension, 3)
        << "AP1 to Rec.709 mixes channels";
    LutRequest three = request_for("hable", "log2");
    three.dimension = LutDimension::three;
    EXPECT_EQ(sample_lut(three).dimension, 3);
    const Lut half = sample_lut(request_for("hable", "linear", LutFormat::clf));
    EXPECT_TRUE(half.is_half_domain);
    EXPECT_EQ(half.values.size(), 65536U);
}

TEST(SampleLut, TakesSizesOf17To129) {
    for (const int size : {17, 18, 33, 65, 129}) {
        const Lut lut = sample_lut(request_for("agx_sobotka", "acescct", LutFormat::cube, size));
        EXPECT_EQ(lut.size, size);
        EXPECT_EQ(lut.values.size(), 3 * static_cast<std::size_t>(size) *
                                         static_cast<std::size_t>(size) *
                                         static_cast<std::size_t>(size));
    }
    for (const int size : {2, 4096, 65536})
        EXPECT_EQ(sample_lut(request_for("hable", "log2", LutFormat::spi1d, size)).size, size);
}

TEST(SampleLut, RefusesLutsThatApplicationsShowWrong) {
    const auto error = [](const LutRequest& r) { return error_of([&] { (void)sample_lut(r); }); };
    LutRequest r = request_for("agx_sobotka", "linear");
    EXPECT_EQ(error(r).rfind("input encoding is linear:0:1; expected another for a 3D "
                             "table",
                             0),
              0U)
        << error(r);
    r = request_for("agx_sobotka", "log2");
    r.dimension = LutDimension::one;
    EXPECT_EQ(error(r).rfind("agx_sobotka mixes channels", 0), 0U) << error(r);
    EXPECT_EQ(error(request_for("agx_sobotka", "log2", LutFormat::spi1d))
                  .rfind("agx_sobotka mixes channels", 0),
              0U);
    r = request_for("hable", "log2", LutFormat::spi1d);
    r.dimension = LutDimension::three;
    EXPECT_EQ(error(r),
              "format is spi1d; expected a 3D format (cube, clf, ctf, spi3d, csp, "
              "resolve_cube, 3dl, lut, icc, hald, strip, strip_up, raw) with dimension=3d");
    r = request_for("hable", "log2", LutFormat::spi3d);
    r.dimension = LutDimension::one;
    EXPECT_EQ(error(r),
              "format is spi3d; expected a 1D format (cube, clf, ctf, spi1d) with dimension=1d");
    for (const int size : {-1, 0, 16, 130}) {
        EXPECT_EQ(error(request_for("agx_sobotka", "log2", LutFormat::cube, size)),
                  "size is " + std::to_string(size) + "; expected [17, 129]");
    }
    for (const int size : {-1, 0, 1, 65537}) {
        EXPECT_EQ(error(request_for("hable", "log2", LutFormat::cube, size)),
                  "size is " + std::to_string(size) + "; expected [2, 65536]");
    }
    EXPECT_EQ(error(request_for("hable", "linear", LutFormat::clf, 4096)),
              "size is 4096; expected none, a half-domain clf has 65536 entries");
}

// ---------------------------------------------------------------------------------------------
// Measured errors

TEST(MeasureLut, IsNeverBelowTheErrorOfTheSamples) {
    for (const LutRequest& r : {request_for("agx_sobotka", "acescct", LutFormat::cube, 17),
                                request_for("hable", "log2", LutFormat::spi1d, 256),
                                request_for("hable", "linear", LutFormat::clf)}) {
        const Lut lut = sample_lut(r);
        const LutError measured = measure_lut(lut, r);
        const SampleSet samples = make_sample_set(find_input_space(r.view.input), {17, 2000});
        std::vector<double> truth(samples.rgb.size());
        ReferenceEngine(build_view(r.view))
            .run_rgb(samples.rgb.data(), truth.data(), samples.size());
        std::vector<double> code(samples.rgb.begin(), samples.rgb.end());
        if (!lut.is_half_domain) {
            ReferenceEngine({curve_stage(r.encoding.encode)})
                .run_rgb(samples.rgb.data(), code.data(), samples.size());
        }
        double worst = 0;
        int inside = 0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            // The lattices and grays are the same whatever the number of random colors.
            if (samples.kind[i] != SampleKind::lattice && samples.kind[i] != SampleKind::gray)
                continue;
            const float* v = &samples.rgb[3 * i];
            const bool is_inside =
                lut.is_half_domain || std::all_of(v, v + 3, [&](float x) {
                    const auto scene = static_cast<double>(x);
                    return scene >= r.encoding.scene_lo && scene <= r.encoding.scene_hi;
                });
            if (!is_inside) continue;
            ++inside;
            const Vector3 out = interpolate(lut, {code[3 * i], code[3 * i + 1], code[3 * i + 2]});
            for (std::size_t c = 0; c < 3; ++c)
                worst = std::max(worst, std::fabs(out[c] - truth[3 * i + c]));
        }
        EXPECT_GT(inside, 1000) << r.encoding.id;
        EXPECT_GE(measured.max, worst) << r.encoding.id;
        EXPECT_GE(measured.max, measured.p999);
        EXPECT_GE(measured.p999, measured.mean);
        EXPECT_GT(measured.delta_e_max, 0);
    }
}

TEST(MeasureLut, FindsAWrongTable) {
    const LutRequest r = request_for("hable", "log2", LutFormat::spi1d, 4096);
    Lut lut = sample_lut(r);
    const LutError clean = measure_lut(lut, r);
    for (float& y : lut.values)
        y += 0.01F;
    const LutError shifted = measure_lut(lut, r);
    EXPECT_NEAR(shifted.mean, 0.01, clean.max + 1e-8);
    EXPECT_NEAR(shifted.max, 0.01, clean.max + 1e-8);
    EXPECT_EQ(shifted.interpolation, "linear");
}

TEST(MeasureLut, FindsSwappedAxes) {
    const LutRequest r = request_for("agx_sobotka", "acescct", LutFormat::cube, 17);
    const Lut lut = sample_lut(r);
    Lut swapped = lut;
    for (std::size_t b = 0; b < 17; ++b) {
        for (std::size_t g = 0; g < 17; ++g) {
            for (std::size_t red = 0; red < 17; ++red) {
                for (std::size_t c = 0; c < 3; ++c) {
                    swapped.values[3 * ((b * 17 + g) * 17 + red) + c] =
                        lut.values[3 * ((red * 17 + g) * 17 + b) + c];
                }
            }
        }
    }
    EXPECT_LT(measure_lut(lut, r).mean, 0.01);
    EXPECT_GT(measure_lut(swapped, r).mean, 0.1) << "blue fastest instead of red";
}

TEST(MeasureLut, NamesTheInterpolation) {
    const LutRequest r = request_for("agx_sobotka", "acescct", LutFormat::cube, 17);
    const Lut lut = sample_lut(r);
    EXPECT_EQ(measure_lut(lut, r).interpolation, "tetrahedral");
    EXPECT_EQ(measure_lut(lut, r, true).interpolation, "trilinear");
}

TEST(MeasureLut, LargerLutsAreBetter) {
    // Chords of a smooth function: a quarter of the error for twice the nodes. The operator's
    // clamps keep the worst color from it, the mean shows it.
    const LutRequest small = request_for("agx_sobotka", "acescct", LutFormat::cube, 17);
    const LutRequest large = request_for("agx_sobotka", "acescct", LutFormat::cube, 65);
    EXPECT_LT(measure_lut(sample_lut(large), large).mean,
              measure_lut(sample_lut(small), small).mean / 4);
}

// ---------------------------------------------------------------------------------------------
// Texts

/// Floats that are hard to print: of every size, next to powers of ten, denormal.
std::vector<float> hard_floats(std::size_t count) {
    std::vector<float> values = {
        0,      1,     -1,  0.1F, 1.0F / 3, 16777217.0F, 1e-45F, 1.1754944e-38F, 3.4028235e38F,
        -65504, 1e-4F, 1e9F};
    for (int power = -44; power <= 38; ++power) {
        const auto ten = static_cast<float>(std::pow(10.0, power));
        values.push_back(std::nextafterf(ten, 0));
        values.push_back(std::nextafterf(ten, 1e30F));
    }
    SampleRandom random(23);
    while (values.size() < count) {
        const auto x = std::bit_cast<float>(static_cast<std::uint32_t>(random.bits() >> 32));
        if (std::isfinite(x)) values.push_back(x);
    }
    values.resize(count);
    return values;
}

TEST(Numbers, RoundTripInNineDigitsWithoutExponents) {
    for (const float x : hard_floats(200000)) {
        std::string text;
        append_number(text, x);
        ASSERT_EQ(text.find_first_not_of("-0123456789."), std::string::npos) << text;
        ASSERT_TRUE(text.find('.') == std::string::npos || text.back() != '0') << text;
        const float back = std::strtof(text.c_str(), nullptr);
        ASSERT_EQ(std::bit_cast<std::uint32_t>(back), std::bit_cast<std::uint32_t>(x)) << text;
    }
}

TEST(Numbers, AreShortAndHaveNoMinusZero) {
    const auto text_of = [](float x) {
        std::string text = "x ";
        append_number(text, x);
        return text;
    };
    EXPECT_EQ(text_of(0), "x 0");
    EXPECT_EQ(text_of(-0.0F), "x 0");
    EXPECT_EQ(text_of(1), "x 1");
    EXPECT_EQ(text_of(100), "x 100") << "zeros before the point stay";
    EXPECT_EQ(text_of(0.5F), "x 0.5");
    EXPECT_EQ(text_of(0.1F), "x 0.100000001");
    std::string text;
    append_decimals(text, -0.000001F, 5);
    text += ' ';
    append_decimals(text, 0.123456F, 5);
    EXPECT_EQ(text, "0 0.12346");
}

TEST(Numbers, NearOnesAreTheShortestWithinTheTolerance) {
    const auto text_of = [](double value, double tolerance) {
        std::string text;
        append_near(text, value, tolerance);
        return text;
    };
    EXPECT_EQ(text_of(0.123456, 1e-7), ".123456");
    EXPECT_EQ(text_of(0.123456, 1e-3), ".123");
    EXPECT_EQ(text_of(0.1996, 1e-3), ".2");
    EXPECT_EQ(text_of(-0.25, 1e-9), "-.25");
    EXPECT_EQ(text_of(4096, 1e-3), "4096");
    EXPECT_EQ(text_of(1234.5, 0.01), "1234.5");
    EXPECT_EQ(text_of(65504, 100), "65500") << "as long as 655e2";
    EXPECT_EQ(text_of(65504, 1000), "66e3");
    EXPECT_EQ(text_of(1.2e-12, 1e-14), "12e-13");
    EXPECT_EQ(text_of(-1e-9, 1e-8), "0");
    EXPECT_EQ(text_of(0, 1e-8), "0");
    for (const float x : hard_floats(200000)) {
        const auto value = static_cast<double>(x);
        const double tolerance = precision_of(value);
        const double read = std::strtod(text_of(value, tolerance).c_str(), nullptr);
        EXPECT_NEAR(read, value, tolerance * (1 + 1e-9)) << text_of(value, tolerance);
    }
}

TEST(Numbers, OneDigitRoundsInTheGivenDirection) {
    const auto text_of = [](double value, bool is_up) {
        std::string text;
        append_one_digit(text, value, is_up);
        return text;
    };
    EXPECT_EQ(text_of(8192, true), "9e3");
    EXPECT_EQ(text_of(8192, false), "0");
    EXPECT_EQ(text_of(-8192, true), "0");
    EXPECT_EQ(text_of(-8192, false), "-9e3");
    EXPECT_EQ(text_of(0.95, true), "1");
    EXPECT_EQ(text_of(0.5, true), ".5");
    EXPECT_EQ(text_of(0.5, false), "0");
    EXPECT_EQ(text_of(0, true), "0");
}

TEST(HalfDomain, UnusedEntriesMayDiffer) {
    const std::vector<float> table = sample_half_domain(kX * 2, 0, 1);
    const std::vector<signed char> slack = unused_entries(table, 0, 1);
    const unsigned one = 0x3C00;
    EXPECT_EQ(slack[0], 0);
    EXPECT_EQ(slack[0x8000], 0) << "-0";
    EXPECT_EQ(slack[0x8001], 0) << "interpolated with";
    EXPECT_EQ(slack[one + 1], 0) << "interpolated with";
    EXPECT_EQ(slack[one + 2], 1) << "larger, since the table rises";
    EXPECT_EQ(slack[0x8002], -1);
    const std::vector<signed char> all = unused_entries(table, -kHalfMax, kHalfMax);
    EXPECT_TRUE(std::all_of(all.begin(), all.end(), [](signed char s) { return s == 0; }));
}

TEST(Numbers, LoseTheZeroBeforeThePoint) {
    const auto short_of = [](std::string text) {
        text.insert(0, "1 ");
        drop_zero_before_point(text, 2);
        return text.substr(2);
    };
    EXPECT_EQ(short_of("0.25"), ".25");
    EXPECT_EQ(short_of("-0.25"), "-.25");
    EXPECT_EQ(short_of("0"), "0");
    EXPECT_EQ(short_of("10.5"), "10.5");
    EXPECT_EQ(short_of("-1e-05"), "-1e-05");
    EXPECT_EQ(short_of(""), "");
}

TEST(Numbers, HashIsFnv1a) {
    // The published test values of FNV-1a, 32 bits.
    EXPECT_EQ(content_hash(""), "811c9dc5");
    EXPECT_EQ(content_hash("a"), "e40c292c");
    EXPECT_EQ(content_hash("foobar"), "bf9cf968");
}

TEST(Numbers, XmlIsEscaped) {
    EXPECT_EQ(xml_escape("a < b & c > \"d\""), "a &lt; b &amp; c &gt; &quot;d&quot;");
}

/// A .cube file by the specification (Adobe, Cube LUT 1.0): keywords, then lines of three numbers.
struct CubeFile {
    int dimension = 0;
    int size = 0;
    std::string title;
    Vector3 domain_min{0, 0, 0};
    Vector3 domain_max{1, 1, 1};
    std::vector<std::string> comments;
    std::vector<float> values;
};

CubeFile parse_cube(const std::string& text) {
    CubeFile cube;
    std::istringstream lines(text);
    std::string line;
    while (std::getline(lines, line)) {
        std::istringstream words(line);
        std::string first;
        words >> first;
        if (first.empty()) continue;
        if (first[0] == '#') {
            cube.comments.push_back(line);
        } else if (first == "TITLE") {
            cube.title = line.substr(6);
        } else if (first == "LUT_1D_SIZE" || first == "LUT_3D_SIZE") {
            cube.dimension = first[4] - '0';
            words >> cube.size;
        } else if (first == "DOMAIN_MIN" || first == "DOMAIN_MAX") {
            Vector3& end = first == "DOMAIN_MIN" ? cube.domain_min : cube.domain_max;
            words >> end[0] >> end[1] >> end[2];
        } else {
            EXPECT_EQ(line.find_first_not_of("-0123456789. "), std::string::npos) << line;
            std::istringstream numbers(line);
            int count = 0;
            for (std::string number; numbers >> number; ++count)
                cube.values.push_back(std::strtof(number.c_str(), nullptr));
            EXPECT_EQ(count, 3) << line;
        }
    }
    return cube;
}

TEST(WriteLut, CubeReadsBackBitForBit) {
    LutRequest r = request_for("agx_sobotka", "acescct", LutFormat::cube, 17);
    Lut lut;
    lut.size = 17;
    lut.values = hard_floats(3 * 17 * 17 * 17);
    LutError error;
    error.max = 0.0123;
    error.p999 = 0.00456;
    error.mean = 0.000789;
    error.delta_e_max = 3.21;
    error.interpolation = "tetrahedral";
    LutError trilinear = error;
    trilinear.max = 0.0234;
    trilinear.interpolation = "trilinear";
    const CubeFile cube = parse_cube(write_lut(lut, r, error, trilinear));
    EXPECT_EQ(cube.dimension, 3);
    EXPECT_EQ(cube.size, 17);
    EXPECT_EQ(cube.title.front(), '"');
    EXPECT_EQ(cube.title.back(), '"');
    EXPECT_EQ(std::count(cube.title.begin(), cube.title.end(), '"'), 2);
    EXPECT_EQ(cube.values, lut.values) << "red fastest, no float changed";
    std::string header;
    for (const std::string& comment : cube.comments)
        header += comment + "\n";
    for (const char* what :
         {"AgX (Sobotka)", "Source: ", "ACEScct", "ACEScg", "sRGB", "max 1.23e-02",
          "99.9 % 4.56e-03", "mean 7.89e-04", "dE_ITP (ITU-R BT.2124), tetrahedral", "max 3.21e+00",
          "222.861", "trilinear interpolation, inside the input range: max 2.34e-02",
          "Clips nothing", "3D LUT, size 17, numbers "}) {
        EXPECT_NE(header.find(what), std::string::npos) << what << " is not in\n" << header;
    }
}

TEST(WriteLut, HeaderDescribesItsNumbers) {
    const auto header_of = [](const char* op, const char* display) {
        const LutRequest r = request_for(op, "log2", LutFormat::cube, 17, display);
        return write_lut(sample_lut(r), r, {});
    };
    // Unreal Engine 3's curve has a power of 2.2 baked in, Hable's gives light.
    for (const auto& [op, display, what] :
         {std::array{"ue3", "native", "Output: the operator's own code values, power 2.2"},
          {"hable", "native", "Output: the operator's own display-linear values"},
          {"ue3", "linear", "Output: display-linear Rec.709, unclamped"},
          {"hable", "rec1886", "BT.1886"}}) {
        const std::string header = header_of(op, display);
        EXPECT_NE(header.find(what), std::string::npos)
            << op << " " << display << header.substr(0, 900);
    }
}

TEST(WriteLut, CurveCubeRepeatsItsChannel) {
    const LutRequest r = request_for("hable", "log2", LutFormat::cube, 64);
    const Lut lut = sample_lut(r);
    const CubeFile cube = parse_cube(write_lut(lut, r, measure_lut(lut, r)));
    EXPECT_EQ(cube.dimension, 1);
    EXPECT_EQ(cube.size, 64);
    EXPECT_EQ(cube.domain_min, (Vector3{0, 0, 0}));
    EXPECT_EQ(cube.domain_max, (Vector3{1, 1, 1}));
    ASSERT_EQ(cube.values.size(), 192U);
    for (std::size_t i = 0; i < 64; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_EQ(cube.values[3 * i + c], lut.values[i]);
    }
    const LutRequest linear = request_for("hable", "linear:0:16", LutFormat::cube, 64);
    const CubeFile ends = parse_cube(write_lut(sample_lut(linear), linear, {}));
    EXPECT_EQ(ends.domain_max, (Vector3{16, 16, 16}));
}

TEST(WriteLut, Spi1dIsLaidOutAsItsReadersWant) {
    const LutRequest r = request_for("hable", "linear:0:16", LutFormat::spi1d, 33);
    const Lut lut = sample_lut(r);
    std::istringstream text(write_lut(lut, r, {}));
    std::string line;
    for (const char* expected : {"Version 1", "From 0 16", "Length 33", "Components 1", "{"}) {
        std::getline(text, line);
        EXPECT_EQ(line, expected);
    }
    for (const float expected : lut.values) {
        std::getline(text, line);
        EXPECT_EQ(std::strtof(line.c_str(), nullptr), expected);
    }
    std::getline(text, line);
    EXPECT_EQ(line, "}");
    EXPECT_FALSE(std::getline(text, line)) << "nothing behind";
}

TEST(WriteLut, Spi3dNamesItsNodes) {
    const LutRequest r = request_for("agx_sobotka", "log2", LutFormat::spi3d, 17);
    const Lut lut = sample_lut(r);
    std::istringstream text(write_lut(lut, r, {}));
    std::string line;
    for (const char* expected : {"SPILUT 1.0", "3 3", "17 17 17"}) {
        std::getline(text, line);
        EXPECT_EQ(line, expected);
    }
    std::set<std::size_t> nodes;
    while (std::getline(text, line)) {
        std::istringstream words(line);
        std::size_t red = 0;
        std::size_t g = 0;
        std::size_t b = 0;
        words >> red >> g >> b;
        const std::size_t node = (b * 17 + g) * 17 + red;
        ASSERT_TRUE(nodes.insert(node).second) << line;
        for (std::size_t c = 0; c < 3; ++c) {
            std::string number;
            words >> number;
            ASSERT_EQ(std::strtof(number.c_str(), nullptr), lut.values[3 * node + c]) << line;
        }
    }
    EXPECT_EQ(nodes.size(), 17U * 17 * 17);
}

/// Of 0.72, as IEC 61966-2-1 has it.
const double kCodeAtTwoStops = 1.055 * std::pow(0.72, 1 / 2.4) - 0.055;

TEST(Clipping, SaysWhichStops) {
    // Shows light up to 1, that is 2.474 stops above 0.18.
    const auto clipping = [](const char* op, const char* encoding) {
        const LutRequest r = request_for(op, encoding);
        return measure_clipping(r, sample_lut(r));
    };
    const LutClipping two = clipping("clamp", "log2:-16:2");
    ASSERT_TRUE(two.above);
    EXPECT_NEAR(two.above->end, 2, 1e-12);
    EXPECT_NEAR(two.above->error, 1 - kCodeAtTwoStops, 1e-12);
    EXPECT_FALSE(two.below);
    EXPECT_FALSE(clipping("clamp", "log2:-16:3").above);
    EXPECT_EQ(to_string(clipping("clamp", "log2:-16:3")), "");
    // 12.92 * 0.18 * 2^-8 is 9.08e-3: so much black is off.
    const LutClipping eight = clipping("clamp", "log2:-8:3");
    ASSERT_TRUE(eight.below);
    EXPECT_NEAR(eight.below->end, -8, 1e-12);
    EXPECT_NEAR(eight.below->error, 12.92 * 0.18 / 256, 1e-4);
    EXPECT_EQ(to_string(eight), "below -8.00 stops from 0.18, down to black, by up to 9.1e-03");
    // ACEScct goes to 0.
    EXPECT_FALSE(clipping("clamp", "acescct").below);
    // Never reaches its white: at 10.27 stops it has some hundredths to go.
    const LutClipping reinhard = clipping("reinhard", "acescct");
    ASSERT_TRUE(reinhard.above);
    EXPECT_GT(reinhard.above->last, 12);
}

TEST(WriteClf, HasTheVersionOfOneFormat) {
    // OCIO refuses a file with both.
    std::string extension;
    const std::string clf = half_table(kX, false, &extension);
    EXPECT_EQ(extension, ".clf");
    EXPECT_NE(clf.find(" compCLFversion=\"3\">"), std::string::npos);
    EXPECT_EQ(clf.find(" version=\"1.4\""), std::string::npos);
    EXPECT_EQ(clf.find("hueAdjust"), std::string::npos) << "CLF has no such attribute";

    const std::string ctf = half_table(kX, true, &extension);
    EXPECT_EQ(extension, ".ctf");
    EXPECT_NE(ctf.find(" name=\"a &lt; b\" version=\"1.4\">"), std::string::npos);
    EXPECT_EQ(ctf.find("compCLFversion"), std::string::npos);
    EXPECT_NE(ctf.find("halfDomain=\"true\" hueAdjust=\"dw3\""), std::string::npos);
    EXPECT_NE(ctf.find("<Description>one &amp; two</Description>"), std::string::npos);
}

// ---------------------------------------------------------------------------------------------
// Files

TEST(WriteText, WritesAndReplaces) {
    const Folder folder;
    const std::string path = folder / "a.cube";
    const std::string binary("one\0\n\r\ntwo", 10);
    write_text_atomically(path, binary);
    EXPECT_EQ(read(path), binary);
    write_text_atomically(path, "shorter");
    EXPECT_EQ(read(path), "shorter");
    write_text_atomically(path, "");
    EXPECT_EQ(read(path), "");
    const std::string large(3 << 20, 'x');
    write_text_atomically(path, large);
    EXPECT_EQ(read(path), large);
    EXPECT_EQ(folder.files(), (std::vector<std::string>{"a.cube"})) << "no temporary file is left";
}

TEST(WriteText, WorksWithARelativeName) {
    const Folder folder;
    const fs::path before = fs::current_path();
    fs::current_path(folder.path());
    write_text_atomically("plain.txt", "here");
    fs::current_path(before);
    EXPECT_EQ(read(folder / "plain.txt"), "here");
}

TEST(WriteText, FailureLeavesTheOldFile) {
    const Folder folder;
    write(folder / "old", "precious");
    fs::create_directories(folder / "full/of");
    const auto error = [&](const std::string& path) {
        try {
            write_text_atomically(path, "new");
        } catch (const FileError& e) {  // the command exits with 3, not 2
            return std::string(e.what());
        }
        return std::string("no error");
    };
    const std::string missing = folder / "missing/file";
    EXPECT_EQ(error(missing), "write: " + missing + ": No such file or directory");
    const std::string below_a_file = folder / "old/file";
    EXPECT_EQ(error(below_a_file), "write: " + below_a_file + ": Not a directory");
    const std::string is_a_folder = folder / "full";
    EXPECT_NE(error(is_a_folder), "no error");
    EXPECT_EQ(read(folder / "old"), "precious");
    EXPECT_TRUE(fs::is_directory(folder / "full/of"));
    EXPECT_EQ(folder.files(), (std::vector<std::string>{"old"})) << "no temporary file is left";
}

TEST(WriteText, AFullDiskLeavesTheOldFile) {
    const Folder folder;
    const std::string path = folder / "old";
    write(path, "precious");
    // A limit on the size of files stops the write half way, as a full disk does.
    struct rlimit before {};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    struct rlimit small = before;
    small.rlim_cur = 4096;
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const std::string message =
        error_of([&] { write_text_atomically(path, std::string(1 << 20, 'x')); });
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(message, "write: " + path + ": File too large");
    EXPECT_EQ(read(path), "precious");
    EXPECT_EQ(folder.files(), (std::vector<std::string>{"old"})) << "no temporary file is left";
}

std::string manifest_of(const std::vector<std::string>& paths) {
    std::string text = "path,operator\n";
    for (const std::string& path : paths)
        text += path + ",x\n";
    return text;
}

TEST(WriteFiles, WritesTheSetAndRemovesStaleFiles) {
    const Folder folder;
    const std::string root = folder / "set";
    write_generated_files(root,
                          {{"a/one.cube", "1"},
                           {"two.cube", "2"},
                           {"MANIFEST.csv", manifest_of({"a/one.cube", "two.cube"})}},
                          "MANIFEST.csv");
    EXPECT_EQ(read(root + "/a/one.cube"), "1");
    write(root + "/a/mine.cube", "not of the set");
    write_generated_files(root, {{"two.cube", "22"}, {"MANIFEST.csv", manifest_of({"two.cube"})}},
                          "MANIFEST.csv");
    EXPECT_EQ(folder.files(),
              (std::vector<std::string>{"set/MANIFEST.csv", "set/a/mine.cube", "set/two.cube"}))
        << "one.cube was of the old set alone; mine.cube never of any";
    EXPECT_EQ(read(root + "/two.cube"), "22");
}

TEST(WriteFiles, NeverChangesFilesOutside) {
    const Folder folder;
    const std::string root = folder / "set";
    fs::create_directories(root + "/sub");
    fs::create_directories(folder / "other");
    write(folder / "outside", "keep");
    write(folder / "other/file", "keep");
    write(root + "/MANIFEST.csv",
          manifest_of({"../outside", "sub/../../outside", folder / "outside", "..", ".", "",
                       "./../outside", "sub/../../other/file", folder / "other/file"}));
    write_generated_files(root, {{"new", "n"}}, "new");
    EXPECT_EQ(read(folder / "outside"), "keep");
    EXPECT_EQ(read(folder / "other/file"), "keep");
    EXPECT_EQ(read(root + "/new"), "n");
}

TEST(WriteFiles, NeverFollowsALinkOutside) {
    const Folder folder;
    const std::string root = folder / "set";
    fs::create_directories(root);
    fs::create_directories(folder / "other");
    write(folder / "other/file", "keep");
    fs::create_directory_symlink(folder / "other", root + "/link");
    write(root + "/MANIFEST.csv", manifest_of({"link/file"}));
    write_generated_files(root, {{"new", "n"}}, "new");
    EXPECT_EQ(read(folder / "other/file"), "keep");
}

TEST(WriteFiles, ADifferentSpellingIsNotStale) {
    const Folder folder;
    const std::string root = folder / "set";
    fs::create_directories(root + "/a");
    write(root + "/MANIFEST.csv", manifest_of({"./one", "a/../two"}));
    write_generated_files(root, {{"one", "1"}, {"two", "2"}}, "two");
    EXPECT_EQ(read(root + "/one"), "1");
    EXPECT_EQ(read(root + "/two"), "2");
}

TEST(WriteFiles, TheLastFileComesLast) {
    // An entry that cannot be written, named after the last one: the last one must not be there.
    const Folder folder;
    const std::string root = folder / "set";
    fs::create_directories(root);
    write(root + "/blocked", "a file, not a folder");
    EXPECT_THROW(
        write_generated_files(root, {{"config.ocio", "c"}, {"blocked/lut", "x"}}, "config.ocio"),
        FileError);
    EXPECT_FALSE(fs::exists(root + "/config.ocio"));
    EXPECT_EQ(read(root + "/blocked"), "a file, not a folder");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
