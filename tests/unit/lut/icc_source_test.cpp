// SPDX-License-Identifier: Apache-2.0
//
// Profiles that the test writes, byte by byte (ICC.1:2001-04, ICC.1:2022). Expected values: closed
// formulas, and LittleCMS.
#include "lut/icc_source.h"

#include <gtest/gtest.h>
#include <lcms2.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "lut/icc.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string big(std::uint64_t value, int bytes) {
    std::string text;
    for (int i = bytes - 1; i >= 0; --i)
        text += static_cast<char>(value >> (8 * i) & 255);
    return text;
}

std::string fixed(double v) {
    return big(static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(v * 65536))), 4);
}

using Tags = std::vector<std::pair<std::string, std::string>>;

std::string profile_of(const Tags& tags, const std::string& space = "RGB ",
                       const std::string& connection = "XYZ ", int version = 2,
                       const std::string& kind = "mntr") {
    std::string table = big(static_cast<std::uint32_t>(tags.size()), 4);
    std::string contents;
    for (const auto& [name, tag] : tags) {
        const std::size_t at = 132 + 12 * tags.size() + contents.size();
        table += name + big(static_cast<std::uint32_t>(at), 4) +
                 big(static_cast<std::uint32_t>(tag.size()), 4);
        contents += tag;
        contents.resize((contents.size() + 3) / 4 * 4);
    }
    std::string header = big(0, 4) + std::string(4, '\0') +
                         big(version == 2 ? 0x02400000 : 0x04300000, 4) + kind + space +
                         connection + std::string(12, '\0') + "acsp" + std::string(28, '\0') +
                         fixed(0.9642) + fixed(1) + fixed(0.8249);
    header.resize(128);
    std::string bytes = header + table + contents;
    bytes.replace(0, 4, big(static_cast<std::uint32_t>(bytes.size()), 4));
    return bytes;
}

std::string xyz_tag(const Vector3& v) {
    return "XYZ " + big(0, 4) + fixed(v[0]) + fixed(v[1]) + fixed(v[2]);
}
std::string gamma_tag(std::uint32_t u8_fixed_8) {
    return "curv" + big(0, 4) + big(1, 4) + big(u8_fixed_8, 2);
}
std::string table_tag(int count, const std::function<double(double)>& f) {
    std::string tag = "curv" + big(0, 4) + big(static_cast<std::uint32_t>(count), 4);
    for (int i = 0; i < count; ++i)
        tag += big(static_cast<std::uint32_t>(std::lround(65535 * f(i / (count - 1.0)))), 2);
    return tag;
}
std::string parametric_tag(std::uint32_t type, const std::vector<double>& parameters) {
    std::string tag = "para" + big(0, 4) + big(type, 2) + big(0, 2);
    for (const double p : parameters)
        tag += fixed(p);
    return tag;
}
std::string text_tag(const std::string& text) {
    return "desc" + big(0, 4) + big(static_cast<std::uint32_t>(text.size() + 1), 4) + text +
           std::string(80, '\0');
}

struct Colorants {
    Vector3 red, green, blue;
};
// The colorants of the makers' own profiles.
const Colorants kHp = {
    {0.43607, 0.22249, 0.01392}, {0.38515, 0.71687, 0.09708}, {0.14307, 0.06061, 0.71410}};
const Colorants kAdobe = {
    {0.60974, 0.31111, 0.01947}, {0.20528, 0.62567, 0.06087}, {0.14919, 0.06322, 0.74457}};
const Colorants kKodak = {
    {0.79767, 0.28804, 0.00000}, {0.13519, 0.71188, 0.00000}, {0.03134, 0.00009, 0.82491}};
const Colorants kApple = {
    {0.51512, 0.24120, -0.00105}, {0.29198, 0.69225, 0.04189}, {0.15710, 0.06657, 0.78407}};

std::string matrix_profile(const Colorants& c, const std::string& curve, int version = 2,
                           const Tags& more = {}) {
    Tags tags = {{"desc", text_tag("A camera")},
                 {"rXYZ", xyz_tag(c.red)},
                 {"gXYZ", xyz_tag(c.green)},
                 {"bXYZ", xyz_tag(c.blue)},
                 {"rTRC", curve},
                 {"gTRC", curve},
                 {"bTRC", curve}};
    tags.insert(tags.end(), more.begin(), more.end());
    return profile_of(tags, "RGB ", "XYZ ", version);
}

double srgb(double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); }

/// Stored numbers -> linear Rec.709.
Vector3 to_rec709(const SourceColor& color, const Vector3& rgb) {
    std::array<float, 3> numbers{};
    for (std::size_t c = 0; c < 3; ++c)
        numbers[c] = static_cast<float>(rgb[c]);
    Vector3 v = rgb;
    if (color.convert) {
        color.convert(numbers.data(), numbers.data(), 1);
        for (std::size_t c = 0; c < 3; ++c)
            v[c] = static_cast<double>(numbers[c]);
    }
    Pipeline stages = color.decode;
    stages.push_back(MatrixStage{rgb_to_rgb(color.primaries, kRec709)});
    const std::array<Expr, 3> f = compose(stages);
    return {evaluate(f[0], v), evaluate(f[1], v), evaluate(f[2], v)};
}

/// The same by LittleCMS in float: relative colorimetric, to a linear profile of Rec.709.
Vector3 by_lcms(const std::string& bytes, const Vector3& rgb, bool is_gray = false) {
    using Profile = std::unique_ptr<void, decltype(&cmsCloseProfile)>;
    const Profile from(
        cmsOpenProfileFromMem(bytes.data(), static_cast<cmsUInt32Number>(bytes.size())),
        &cmsCloseProfile);
    const cmsCIExyY white = {0.3127, 0.3290, 1};
    const cmsCIExyYTRIPLE primaries = {{0.64, 0.33, 1}, {0.30, 0.60, 1}, {0.15, 0.06, 1}};
    cmsToneCurve* linear = cmsBuildGamma(nullptr, 1);
    const std::array<cmsToneCurve*, 3> curves = {linear, linear, linear};
    const Profile to(cmsCreateRGBProfile(&white, &primaries, curves.data()), &cmsCloseProfile);
    cmsFreeToneCurve(linear);
    const std::unique_ptr<void, decltype(&cmsDeleteTransform)> transform(
        cmsCreateTransform(from.get(), is_gray ? TYPE_GRAY_DBL : TYPE_RGB_DBL, to.get(),
                           TYPE_RGB_DBL, INTENT_RELATIVE_COLORIMETRIC,
                           cmsFLAGS_NOOPTIMIZE | cmsFLAGS_NOCACHE),
        &cmsDeleteTransform);
    Vector3 out{};
    EXPECT_NE(transform, nullptr);
    if (transform) cmsDoTransform(transform.get(), rgb.data(), out.data(), 1);
    return out;
}

const std::vector<Vector3> kColors = {
    {0, 0, 0},       {1, 1, 1},       {0.5, 0.5, 0.5},  {1, 0, 0},         {0, 1, 0},
    {0, 0, 1},       {0.2, 0.4, 0.8}, {0.02, 0.01, 0},  {0.004, 0.7, 0.3}, {0.9, 0.1, 0.6},
    {0.99, 0.98, 1}, {0.3, 0.3, 0.1}, {0.05, 0.5, 0.95}};

/// @param more  colors outside [0, 1]
void expect_as_lcms(const std::string& bytes, double tolerance,
                    const std::vector<Vector3>& more = {}) {
    const IccSource source = color_of_icc(bytes, 3, "x.png");
    std::vector<Vector3> colors = kColors;
    colors.insert(colors.end(), more.begin(), more.end());
    for (const Vector3& rgb : colors) {
        const Vector3 ours = to_rec709(source.color, rgb);
        const Vector3 theirs = by_lcms(bytes, rgb);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(ours[c], theirs[c], tolerance)
                << source.color.name << " of " << rgb[0] << " " << rgb[1] << " " << rgb[2];
    }
}

void expect_error(const std::string& bytes, int channels, const std::string& text) {
    try {
        (void)color_of_icc(bytes, channels, "x.png");
        ADD_FAILURE() << "no error; expected " << text;
    } catch (const Error& e) {
        const std::string message = e.what();
        EXPECT_EQ(message.rfind("x.png: ICC profile", 0), 0U) << message;
        EXPECT_NE(message.find(text), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

TEST(IccSource, NamesWhatItKnows) {
    const std::string gamma22 = gamma_tag(563);
    const auto name = [](const std::string& bytes) {
        return color_of_icc(bytes, 3, "x").color.name;
    };
    EXPECT_EQ(name(matrix_profile(kHp, table_tag(1024, srgb))), "sRGB");
    EXPECT_EQ(name(matrix_profile(
                  kHp, parametric_tag(3, {2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045}))),
              "sRGB");
    EXPECT_EQ(name(matrix_profile(
                  kApple, parametric_tag(3, {2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045}))),
              "Display P3");
    EXPECT_EQ(name(matrix_profile(kAdobe, gamma22)), "Adobe RGB (1998)");
    EXPECT_EQ(name(matrix_profile(kKodak, gamma_tag(461))), "ProPhoto RGB");
    EXPECT_EQ(name(matrix_profile(kHp, parametric_tag(0, {1}))), "lin_rec709");
    // 563/256 is not 2.2.
    const std::string own = name(matrix_profile(kHp, gamma22));
    EXPECT_EQ(own.substr(0, 15), "ICC: A camera (");
    EXPECT_NE(own, name(matrix_profile(kHp, gamma_tag(564))));
    EXPECT_NE(own, name(matrix_profile(kApple, gamma22)));
}

TEST(IccSource, OfOurOwnProfilesIsTheDisplay) {
    const IccCurve srgb_curve = {2.4, true};
    for (const auto& [id, curve] :
         {std::pair("srgb", srgb_curve), std::pair("display_p3", srgb_curve),
          std::pair("rec1886", IccCurve{2.4}), std::pair("rec2020", IccCurve{2.4}),
          std::pair("g22", IccCurve{2.2}), std::pair("lin_rec709", IccCurve{1}),
          std::pair("lin_rec2020", IccCurve{1}), std::pair("lin_ap1", IccCurve{1})}) {
        const SourceColor expected = find_source_color(id);
        const IccSource source =
            color_of_icc(write_display_icc(expected.primaries, curve, id, false), 3, "x");
        EXPECT_EQ(source.color.name, expected.name);
        EXPECT_TRUE(source.color.primaries == expected.primaries) << id;
        EXPECT_EQ(to_string(source.color.decode), to_string(expected.decode));
        EXPECT_EQ(source.description, id);
        EXPECT_FALSE(source.code_points);
    }
    const auto gray = [&](const IccCurve& curve) {
        return color_of_icc(write_display_icc(kP3D65, curve, "x", true), 1, "x").color.name;
    };
    EXPECT_EQ(gray(srgb_curve), "sRGB");
    EXPECT_EQ(gray({2.4}), "Rec.1886");
    EXPECT_EQ(gray({2.2}), "Gamma 2.2");
    EXPECT_EQ(gray({1}), "lin_rec709");
}

TEST(IccSource, AgreesWithClosedFormulas) {
    // Bruce Lindbloom's matrix of Adobe RGB (1998), D65, in front of that of sRGB.
    const Matrix3 adobe_to_xyz = {{{0.5767309, 0.1855540, 0.1881852},
                                   {0.2973769, 0.6273491, 0.0752741},
                                   {0.0270343, 0.0706872, 0.9911085}}};
    const Matrix3 xyz_to_srgb = {{{3.2404542, -1.5371385, -0.4985314},
                                  {-0.9692660, 1.8760108, 0.0415560},
                                  {0.0556434, -0.2040259, 1.0572252}}};
    const IccSource source = color_of_icc(matrix_profile(kAdobe, gamma_tag(563)), 3, "x");
    for (const Vector3& rgb : kColors) {
        Vector3 light{};
        for (std::size_t c = 0; c < 3; ++c)
            light[c] = std::pow(rgb[c], 563 / 256.0);
        const Vector3 expected = multiply(multiply(xyz_to_srgb, adobe_to_xyz), light);
        const Vector3 ours = to_rec709(source.color, rgb);
        // His white of D65 has other last digits than x = 0.3127, y = 0.3290.
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(ours[c], expected[c], 3e-4);
    }
}

// s15Fixed16Number and floats inside LittleCMS.
constexpr double kNumbers = 4e-5;

TEST(IccSource, ParametricCurvesAreLittleCmsOwn) {
    // In type 2, LittleCMS lets the formula begin at 0, even where -b/a is below.
    const std::vector<Vector3> above = {{1.5, 2, 4}};
    const std::vector<Vector3> outside = {{1.5, 2, 4}, {-0.2, -0.01, 0.3}};
    const std::vector<std::pair<std::uint32_t, std::vector<double>>> curves = {
        {0, {1.9}},
        {0, {1}},
        {1, {2.1, 0.9, 0.1}},
        {1, {1.8, 1.2, -0.2}},
        {2, {2.2, 0.85, 0.1, 0.05}},
        {3, {1 / 0.45, 1 / 1.099, 0.099 / 1.099, 1 / 4.5, 0.081}},
        {3, {3, 0.862, 0.138, 0.1107, 0.08}},
        {4, {2.4, 0.9, 0.1, 0.2, 0.1, 0.03, 0.01}}};
    for (const auto& [type, parameters] : curves) {
        SCOPED_TRACE(type);
        const std::string bytes = matrix_profile(kApple, parametric_tag(type, parameters), 4);
        // Values up to 50, where rounded parameters count as much more.
        expect_as_lcms(bytes, 20 * kNumbers, type == 2 ? above : outside);
        expect_as_lcms(bytes, kNumbers);
    }
}

TEST(IccSource, SampledCurvesAreInterpolatedInStraightLines) {
    for (const int count : {2, 3, 26, 256, 4096}) {
        SCOPED_TRACE(count);
        const std::string bytes =
            matrix_profile(kApple, table_tag(count, [](double x) { return x * x * x; }));
        expect_as_lcms(bytes, kNumbers);
    }
    // Between the samples 0, 0.25, 1 of x^2; the ends hold outside.
    const IccSource source = color_of_icc(
        profile_of({{"kTRC", table_tag(3, [](double x) { return x * x; })}}, "GRAY"), 1, "x");
    const double samples = 0.5 / 65535;
    for (const auto& [x, y] : {std::pair(0.25, 0.125), std::pair(0.75, 0.625), std::pair(-1.0, 0.0),
                               std::pair(3.0, 1.0)})
        EXPECT_NEAR(to_rec709(source.color, {x, x, x})[1], y, samples);
}

TEST(IccSource, EachChannelHasItsCurve) {
    const std::string bytes = profile_of({{"rXYZ", xyz_tag(kApple.red)},
                                          {"gXYZ", xyz_tag(kApple.green)},
                                          {"bXYZ", xyz_tag(kApple.blue)},
                                          {"rTRC", gamma_tag(256)},
                                          {"gTRC", gamma_tag(512)},
                                          {"bTRC", gamma_tag(768)}});
    expect_as_lcms(bytes, kNumbers);
    const SourceColor color = color_of_icc(bytes, 3, "x").color;
    const std::array<Expr, 3> f = compose(color.decode);
    const Vector3 half = {0.5, 0.5, 0.5};
    EXPECT_EQ(evaluate(f[0], half), 0.5);
    EXPECT_EQ(evaluate(f[1], half), 0.25);
    EXPECT_EQ(evaluate(f[2], half), 0.125);
}

TEST(IccSource, WhitesThatAreNotD50StayWhatTheyAre) {
    // Colorants of Rec.709 that nobody adapted to D50: ICC.1 gives a blue tint to white.
    const Colorants raw = {
        {0.4124, 0.2126, 0.0193}, {0.3576, 0.7152, 0.1192}, {0.1805, 0.0722, 0.9505}};
    expect_as_lcms(matrix_profile(raw, gamma_tag(460)), kNumbers);
    // A camera without white balance.
    const Colorants camera = {{0.70, 0.30, 0.02}, {0.30, 0.60, 0.05}, {0.10, 0.10, 0.50}};
    expect_as_lcms(matrix_profile(camera, gamma_tag(256)), kNumbers);
    const Vector3 white =
        to_rec709(color_of_icc(matrix_profile(raw, gamma_tag(460)), 3, "x").color, {1, 1, 1});
    EXPECT_GT(white[2], 1.2);
}

TEST(IccSource, GrayHasLuminanceOrLightness) {
    const std::string luminance = profile_of({{"kTRC", gamma_tag(470)}}, "GRAY");
    const std::string lightness = profile_of({{"kTRC", gamma_tag(300)}}, "GRAY", "Lab ", 4);
    for (const std::string& bytes : {luminance, lightness}) {
        const IccSource source = color_of_icc(bytes, 1, "x");
        for (const double x : {0.0, 0.01, 0.1, 0.5, 0.9, 1.0}) {
            const Vector3 ours = to_rec709(source.color, {x, x, x});
            const Vector3 theirs = by_lcms(bytes, {x, 0, 0}, true);
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(ours[c], theirs[c], kNumbers) << x;
        }
    }
    expect_error(luminance, 3, "expected \"RGB \" for 3 channels");
    // JPEGs of one channel often have the profile of their camera.
    EXPECT_EQ(color_of_icc(matrix_profile(kAdobe, gamma_tag(563)), 1, "x").color.name,
              "Adobe RGB (1998)");
}

/// A lookup table of two nodes a side holds a matrix exactly; the curve in front is a square.
std::string table_profile(const std::string& type, const Colorants& colorants) {
    std::string nodes;
    for (int node = 0; node < 8; ++node) {
        for (std::size_t i = 0; i < 3; ++i) {
            double v = 0;
            if ((node & 4) != 0) v += colorants.red[i];
            if ((node & 2) != 0) v += colorants.green[i];
            if ((node & 1) != 0) v += colorants.blue[i];
            // ICC.1:2022, table 11: 1.0 is 0x8000.
            nodes += big(static_cast<std::uint32_t>(std::lround(std::max(v, 0.0) * 32768)), 2);
        }
    }
    const auto square = [](double x) { return x * x; };
    const std::string identity = fixed(1) + fixed(0) + fixed(0) + fixed(0) + fixed(1) + fixed(0) +
                                 fixed(0) + fixed(0) + fixed(1);
    std::string tag;
    if (type == "mft2") {
        constexpr int kCount = 1024;
        const std::string curve = table_tag(kCount, square).substr(12);
        const std::string line = big(0, 2) + big(65535, 2);
        tag = "mft2" + big(0, 4) + big(0x03030200, 4) + identity + big(kCount, 2) + big(2, 2) +
              curve + curve + curve + nodes + line + line + line;
    } else {
        // B, a table, and A; ICC.1:2022, 10.12.
        const std::string line = "curv" + big(0, 4) + big(0, 4);
        const std::string curve = parametric_tag(0, {2});
        const std::string table =
            std::string(3, '\2') + std::string(13, '\0') + big(0x02000000, 4) + nodes;
        const std::size_t at = 32 + 3 * line.size();
        tag = "mAB " + big(0, 4) + big(0x03030000, 4) + big(32, 4) + big(0, 4) + big(0, 4) +
              big(static_cast<std::uint32_t>(at), 4) +
              big(static_cast<std::uint32_t>(at + table.size()), 4) + line + line + line + table +
              curve + curve + curve;
    }
    return profile_of({{"desc", text_tag("Tables")}, {"A2B0", tag}}, "RGB ", "XYZ ",
                      type == "mft2" ? 2 : 4, "scnr");
}

TEST(IccSource, TablesThroughLittleCmsAreTheMatrixThatTheyHold) {
    for (const char* type : {"mft2", "mAB "}) {
        SCOPED_TRACE(type);
        const std::string bytes = table_profile(type, kAdobe);
        const IccSource source = color_of_icc(bytes, 3, "x");
        EXPECT_TRUE(source.has_tables);
        ASSERT_TRUE(source.color.convert);
        EXPECT_EQ(source.color.name.substr(0, 13), "ICC: Tables (");
        EXPECT_TRUE(source.color.primaries == kRec709);
        const Colorants& k = kAdobe;
        const Matrix3 to_d50 = {{{k.red[0], k.green[0], k.blue[0]},
                                 {k.red[1], k.green[1], k.blue[1]},
                                 {k.red[2], k.green[2], k.blue[2]}}};
        // sRGB from XYZ of D50, as Bruce Lindbloom prints it.
        const Matrix3 to_srgb = {{{3.1338561, -1.6168667, -0.4906146},
                                  {-0.9787684, 1.9161415, 0.0334540},
                                  {0.0719453, -0.2289914, 1.4052427}}};
        for (const Vector3& rgb : kColors) {
            const Vector3 light = {rgb[0] * rgb[0], rgb[1] * rgb[1], rgb[2] * rgb[2]};
            const Vector3 expected = multiply(multiply(to_srgb, to_d50), light);
            const Vector3 ours = to_rec709(source.color, rgb);
            // His D50 has Z = 0.82521, that of ICC 0.8249; Rec.709 enlarges that by 1.4.
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(ours[c], expected[c], 6e-4);
            expect_as_lcms(bytes, 1e-5);
        }
    }
}

std::string floats(const std::vector<float>& values) {
    std::string text;
    for (const float v : values)
        text += big(std::bit_cast<std::uint32_t>(v), 4);
    return text;
}

// ICC.1:2022, 10.16: squares, then a matrix to XYZ. They win over A2B0.
TEST(IccSource, FloatElementsAreUsed) {
    const std::string curve = "curf" + big(0, 4) + big(1, 2) + big(0, 2) + "parf" + big(0, 4) +
                              big(0, 2) + big(0, 2) + floats({2, 1, 0, 0});
    std::string squares = "cvst" + big(0, 4) + big(3, 2) + big(3, 2);
    for (int c = 0; c < 3; ++c)
        squares += big(36, 4) + big(curve.size(), 4);
    squares += curve;
    const std::string matrix = "matf" + big(0, 4) + big(3, 2) + big(3, 2) +
                               floats({0.6F, 0.2F, 0.1F, 0.3F, 0.6F, 0.1F, 0, 0.1F, 0.7F}) +
                               floats({0, 0, 0});
    const std::string tag = "mpet" + big(0, 4) + big(3, 2) + big(3, 2) + big(2, 4) + big(32, 4) +
                            big(squares.size(), 4) + big(32 + squares.size(), 4) +
                            big(matrix.size(), 4) + squares + matrix;
    const std::string other = table_profile("mAB ", kHp);
    const std::string table = other.substr(other.find("mAB "));
    const IccSource source = color_of_icc(
        profile_of({{"A2B0", table}, {"D2B1", tag}}, "RGB ", "XYZ ", 4, "scnr"), 3, "x");
    EXPECT_TRUE(source.has_tables);
    // XYZ of D50 to sRGB, as Bruce Lindbloom prints it; beyond 1, too.
    const Matrix3 to_srgb = {{{3.1338561, -1.6168667, -0.4906146},
                              {-0.9787684, 1.9161415, 0.0334540},
                              {0.0719453, -0.2289914, 1.4052427}}};
    const Matrix3 to_xyz = {{{0.6, 0.2, 0.1}, {0.3, 0.6, 0.1}, {0, 0.1, 0.7}}};
    for (const Vector3& rgb : {Vector3{0.2, 0.5, 0.9}, Vector3{1, 1, 1}, Vector3{0.1, 0.3, 1.5}}) {
        const Vector3 light = {rgb[0] * rgb[0], rgb[1] * rgb[1], rgb[2] * rgb[2]};
        const Vector3 expected = multiply(multiply(to_srgb, to_xyz), light);
        const Vector3 ours = to_rec709(source.color, rgb);
        // His D50 has Z = 0.82521, that of ICC 0.8249.
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(ours[c], expected[c], 1e-3);
    }
}

TEST(IccSource, TablesTakeAnyNumber) {
    const IccSource source = color_of_icc(table_profile("mAB ", kHp), 3, "x");
    const std::vector<float> in = {NAN, -1, 5, INFINITY, -INFINITY, 0.5F};
    std::vector<float> out(6);
    source.color.convert(in.data(), out.data(), 2);
    for (const float v : out)
        EXPECT_TRUE(std::isfinite(v));
    // Limited to [0, 1]: blue is 1.
    const Vector3 blue = to_rec709(source.color, {0, 0, 1});
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(static_cast<double>(out[c]), blue[c], 1e-6);
}

TEST(IccSource, ThreadsShareTables) {
    const IccSource source = color_of_icc(table_profile("mft2", kHp), 3, "x");
    std::vector<float> in(3 * 5000);
    for (std::size_t i = 0; i < in.size(); ++i)
        in[i] = static_cast<float>(i * 7919 % 1001) / 1000;
    std::vector<float> expected(in.size());
    source.color.convert(in.data(), expected.data(), in.size() / 3);
    std::vector<std::vector<float>> results(4, in);  // in place
    std::vector<std::thread> threads;
    for (std::vector<float>& result : results) {
        threads.emplace_back(
            [&] { source.color.convert(result.data(), result.data(), result.size() / 3); });
    }
    for (std::thread& thread : threads)
        thread.join();
    for (const std::vector<float>& result : results)
        EXPECT_EQ(result, expected);
}

TEST(IccSource, GivesCodePoints) {
    const IccSource source = color_of_icc(
        matrix_profile(kHp, gamma_tag(512), 4, {{"cicp", "cicp" + big(0, 4) + big(0x09100001, 4)}}),
        3, "x");
    ASSERT_TRUE(source.code_points);
    EXPECT_EQ(source.code_points->first, 9);
    EXPECT_EQ(source.code_points->second, 16);
}

TEST(IccSource, ReadsDescriptionsOfBothVersions) {
    std::string english;
    for (const char c : std::string("Caf\1"))
        english += std::string(1, '\0') + c;
    const std::string tag = "mluc" + big(0, 4) + big(2, 4) + big(12, 4) + "deDE" + big(2, 4) +
                            big(40, 4) + "enUS" + big(8, 4) + big(42, 4) + std::string("\0x", 2) +
                            english;
    Tags tags = {{"desc", tag}, {"kTRC", gamma_tag(512)}};
    EXPECT_EQ(color_of_icc(profile_of(tags, "GRAY", "XYZ ", 4), 1, "x").description, "Caf?");
    tags[0].second = text_tag("Old\nand \xFFodd ");
    EXPECT_EQ(color_of_icc(profile_of(tags, "GRAY"), 1, "x").description, "Old?and ?odd");
}

TEST(IccSource, DamagedProfilesAreErrorsOfOneLine) {
    const std::string good = matrix_profile(kHp, gamma_tag(512));
    const auto with = [&](const std::string& name, const std::string& tag) {
        Tags tags = {{"rXYZ", xyz_tag(kHp.red)},  {"gXYZ", xyz_tag(kHp.green)},
                     {"bXYZ", xyz_tag(kHp.blue)}, {"rTRC", gamma_tag(512)},
                     {"gTRC", gamma_tag(512)},    {"bTRC", gamma_tag(512)}};
        std::erase_if(tags, [&](const auto& t) { return t.first == name; });
        if (!tag.empty()) tags.emplace_back(name, tag);
        return profile_of(tags);
    };
    expect_error("", 3, "expected an ICC profile");
    expect_error(std::string(200, 'x'), 3, "expected an ICC profile");
    expect_error(good.substr(0, good.size() - 30), 3, "declares");
    expect_error(with("gXYZ", ""), 3, "there is no tag gXYZ");
    expect_error(with("bTRC", ""), 3, "there is no tag bTRC");
    expect_error(with("gXYZ", xyz_tag(kHp.red)), 3, "the colorants lie on one line");
    expect_error(with("gXYZ", xyz_tag({0, 0, 0})), 3, "the colorants lie on one line");
    expect_error(with("gXYZ", "XYZ " + big(0, 8)), 3, "gXYZ is no XYZ number");
    expect_error(with("rTRC", "curv" + big(0, 4) + big(0x7FFFFFFF, 4)), 3,
                 "a curve is longer than its tag");
    expect_error(with("rTRC", "text" + big(0, 8)), 3, "expected curv or para");
    expect_error(with("rTRC", parametric_tag(5, {1})), 3, "expected 0 to 4");
    expect_error(with("rTRC", parametric_tag(4, {1, 1})), 3, "a curve is longer than its tag");
    expect_error(with("rTRC", parametric_tag(0, {-2})), 3, "expected a finite number");
    expect_error(with("rTRC", parametric_tag(0, {0})), 3, "rTRC is constant");
    expect_error(with("rTRC", parametric_tag(1, {2, 0, 1})), 3, "rTRC is constant");
    expect_error(with("rTRC", parametric_tag(1, {30000, 30000, 1})), 3, "expected a finite number");
    std::string far_away = good;
    far_away.replace(good.find("rXYZ") + 4, 4, big(0xFFFFFFF0, 4));
    expect_error(far_away, 3, "tag rXYZ is longer than the file");
    std::string many = good;
    many.replace(128, 4, big(0xFFFFFFFF, 4));
    expect_error(many, 3, "the table of tags is longer than the file");
    expect_error(std::string((32U << 20) + 1, '\0'), 3, "expected at most");
    // Not damaged, but of no use here.
    expect_error(profile_of({}, "CMYK", "Lab ", 2, "prtr"), 3, "color space is \"CMYK\"");
    expect_error(profile_of({}, "Lab ", "Lab ", 2, "spac"), 3, "color space is \"Lab \"");
    expect_error(profile_of({}, "RGB ", "RGB ", 4, "link"), 3, "class is \"link\"");
    expect_error(profile_of({}, "RGB ", "Luv "), 3, "connection space is \"Luv \"");
}

TEST(IccSource, DamagedTablesAreErrorsOfOneLine) {
    const std::string good = table_profile("mAB ", kHp);
    const std::size_t tag = good.find("mAB ");
    const auto with = [&](std::size_t at, const std::string& bytes) {
        std::string changed = good;
        return changed.replace(tag + at, bytes.size(), bytes);
    };
    expect_error(with(0, "abcd"), 3, "expected mft1, mft2 or mAB");
    expect_error(with(8, big(0x0203, 2)), 3, "2 channels in");
    expect_error(with(24, big(0xFFFFFF00, 4)), 3, "longer than the file");
    const std::size_t table = 32 + 36;
    expect_error(with(table, std::string(3, '\xFF')), 3, "expected 2 or more a side");
    expect_error(with(table, std::string(1, '\1')), 3, "expected 2 or more a side");
    expect_error(with(28, big(0xFFFFFF00, 4)), 3, "ICC profile is damaged: ");
}

// Every profile cut off, and every byte changed, is read or refused.
TEST(IccSource, TakesAnyBytes) {
    for (const std::string& good :
         {matrix_profile(kHp, parametric_tag(3, {2.4, 0.9, 0.1, 0.08, 0.04}), 4),
          table_profile("mAB ", kHp), table_profile("mft2", kHp).substr(0, 1200)}) {
        const auto feed = [](std::string bytes) {
            bytes.replace(0, 4, big(static_cast<std::uint32_t>(bytes.size()), 4));
            try {
                const IccSource source = color_of_icc(bytes, 3, "x.png");
                for (const double v : to_rec709(source.color, {0.2, 0.5, 0.9}))
                    EXPECT_TRUE(std::isfinite(v));
            } catch (const Error& e) {
                EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
            }
        };
        for (std::size_t size = 4; size < good.size(); ++size)
            feed(good.substr(0, size));
        for (std::size_t at = 4; at < good.size(); ++at) {
            for (const char change : {'\1', '\x80', '\xFF'}) {
                std::string bytes = good;
                bytes[at] = static_cast<char>(bytes[at] ^ change);
                feed(bytes);
            }
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
