// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "tonewright/registry.h"
#include "tonewright/tonemap.h"
#include "tonewright/view.h"
#include "unit/image/pictures.h"
#include "unit/image/tonemapped.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;
using OIIO::TypeDesc;

TEST(Tonemap, AlphaMayBeAnyLaterChannel) {
    ImageBuf src(make_spec(1, 1, {"R", "G", "B", "Z", "A"}, TypeDesc::HALF));
    set(src, 0, 0, {0.09F, 0.09F, 0.09F, 7, 0.5F});
    const std::vector<float> out = pixel(tonemap(src, hable()), 0, 0);
    const double want =
        reference(hable())(Vector3{static_cast<double>(pixel(src, 0, 0)[0]) * 2, 0, 0})[0];
    EXPECT_NEAR(out[0], 0.5 * want, kTolerance);
    EXPECT_EQ(out[3], 7);
    EXPECT_EQ(out[4], 0.5F);

    ImageBuf first = make_picture(make_spec(1, 1, {"A", "R", "G", "B"}, TypeDesc::FLOAT));
    ImageBuf dst;
    expect_error(dst, tonemap(dst, first, hable()),
                 "alpha channel is 0; expected none, or 3 and above");
}

TEST(Tonemap, PositionDecidesNotTheName) {
    const ImageBuf named = make_picture(make_spec(3, 3, {"B", "G", "R"}, TypeDesc::FLOAT));
    const ImageBuf plain = make_rgb(3, 3);
    EXPECT_EQ(pixel(tonemap(named, hable()), 1, 1), pixel(tonemap(plain, hable()), 1, 1));
}

// Its look raises red above blue: grays do not stay gray.
TonemapOptions golden() { return {.op = resolve_picture_operator("agx_sobotka", {}, "golden")}; }

TEST(Tonemap, GrayStaysGray) {
    const ImageBuf src = make_picture(make_spec(5, 5, {"Y"}, TypeDesc::HALF), 4);
    const ImageBuf result = tonemap(src, hable());
    ASSERT_FALSE(result.has_error()) << result.geterror();
    ASSERT_EQ(result.nchannels(), 1);
    const double in = pixel(src, 2, 3)[0];
    EXPECT_NEAR(pixel(result, 2, 3)[0], reference(hable())(Vector3{in, in, in})[0], kTolerance);
    // A region as callers pass it: that of the source.
    EXPECT_TRUE(same_bits(tonemap(src, hable(), src.roi()), result));
}

TEST(Tonemap, GrayBecomesColorWhereTheViewTintsIt) {
    const ImageBuf src = make_picture(make_spec(5, 5, {"Y"}, TypeDesc::FLOAT));
    ASSERT_FALSE(keeps_grays(build_view(
        make_view(resolve_operator("agx_sobotka", {}, "golden"), "lin_rec709", 0, "srgb"))));
    for (const ROI& roi : {ROI(), src.roi()}) {
        const ImageBuf result = tonemap(src, golden(), roi);
        ASSERT_FALSE(result.has_error()) << result.geterror();
        ASSERT_EQ(result.spec().channelnames, (std::vector<std::string>{"R", "G", "B"}));
        const double in = pixel(src, 2, 3)[0];
        const Vector3 want = reference(golden())(Vector3{in, in, in});
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(pixel(result, 2, 3)[c], want[c], kTolerance);
    }
    ImageBuf in_place = src;
    expect_error(in_place, tonemap(in_place, in_place, golden()),
                 "destination has 1 channel; expected 3 or more");
}

TEST(Tonemap, GrayAndAlpha) {
    ImageBuf src(make_spec(1, 1, {"Y", "A"}, TypeDesc::FLOAT));
    set(src, 0, 0, {0.09F, 0.5F});
    const Vector3 gray = reference(hable())(Vector3{0.18, 0.18, 0.18});
    const ImageBuf result = tonemap(src, hable());
    ASSERT_EQ(result.nchannels(), 2);
    EXPECT_NEAR(pixel(result, 0, 0)[0], 0.5 * gray[0], kTolerance);
    EXPECT_EQ(pixel(result, 0, 0)[1], 0.5F);

    const ImageBuf tinted = tonemap(src, golden());
    ASSERT_EQ(tinted.spec().channelnames, (std::vector<std::string>{"R", "G", "B", "A"}));
    EXPECT_EQ(tinted.spec().alpha_channel, 3);
    const Vector3 want = reference(golden())(Vector3{0.18, 0.18, 0.18});
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(pixel(tinted, 0, 0)[c], 0.5 * want[c], kTolerance);
    EXPECT_EQ(pixel(tinted, 0, 0)[3], 0.5F);

    // The name alone says it, too.
    src.specmod().alpha_channel = -1;
    EXPECT_EQ(pixel(tonemap(src, hable()), 0, 0), pixel(result, 0, 0));
}

TEST(Tonemap, GrayFillsADestinationOfThreeChannels) {
    ImageBuf src(make_spec(1, 1, {"Y", "A"}, TypeDesc::FLOAT));
    set(src, 0, 0, {0.18F, 1});
    ImageBuf dst(make_spec(1, 1, {"R", "G", "B", "A"}, TypeDesc::UINT8));
    ASSERT_TRUE(tonemap(dst, src, hable())) << dst.geterror();
    const std::vector<float> out = pixel(dst, 0, 0);
    EXPECT_EQ(out[0], out[1]);
    EXPECT_EQ(out[1], out[2]);
    EXPECT_GT(out[0], 0.3F);
    EXPECT_EQ(out[3], 1);
}

TEST(Tonemap, TwoChannelsWithoutAlphaAreRefused) {
    const ImageBuf src = make_picture(make_spec(2, 2, {"R", "G"}, TypeDesc::FLOAT));
    ImageBuf dst;
    expect_error(dst, tonemap(dst, src, hable()),
                 "picture has 2 channels (R, G); expected 1, 3 or more");
}

/// Light of one pixel, with an operator that changes nothing: light of Rec.709 in [0, 1].
std::vector<float> light_of(const ImageSpec& spec, const std::vector<float>& color,
                            const std::string& input = std::string(kAutoInput)) {
    ImageBuf src(spec);
    set(src, 0, 0, color);
    const ImageBuf result = tonemap(
        src, {.op = resolve_picture_operator("clamp"), .input = input, .display = "linear"});
    EXPECT_FALSE(result.has_error()) << result.geterror();
    return pixel(result, 0, 0);
}

ImageSpec one_pixel() { return make_spec(1, 1, {"R", "G", "B"}, TypeDesc::FLOAT); }

void set_chromaticities(ImageSpec& spec, const std::array<float, 8>& xy) {
    spec.attribute("chromaticities", TypeDesc(TypeDesc::FLOAT, 8), xy.data());
}

constexpr std::array<float, 8> kXyz = {1, 0, 0, 1, 0, 0, 1 / 3.0F, 1 / 3.0F};
constexpr std::array<float, 8> kAp1Floats = {0.713F, 0.293F, 0.165F,   0.830F,
                                             0.128F, 0.044F, 0.32168F, 0.33767F};

void expect_light(const std::vector<float>& light, const Vector3& expected, double tolerance) {
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(light[c], expected[c], tolerance) << "channel " << c;
}

TEST(TonemapInput, CodeValuesAreDecoded) {
    struct Case {
        const char* color_space;
        double of_half;      // light of code value 0.5
        double of_fiftieth;  // of 0.02
    };
    // Closed forms: IEC 61966-2-1, ITU-R BT.709-6, ITU-R BT.1886, powers.
    const std::array<Case, 7> cases = {
        {{"sRGB", std::pow(0.555 / 1.055, 2.4), 0.02 / 12.92},
         {"srgb_rec709_scene", std::pow(0.555 / 1.055, 2.4), 0.02 / 12.92},
         {"Rec709", std::pow(0.599 / 1.099, 1 / 0.45), 0.02 / 4.5},
         {"Gamma2.2", std::pow(0.5, 2.2), std::pow(0.02, 2.2)},
         {"gamma1.8", std::pow(0.5, 1.8), std::pow(0.02, 1.8)},
         {"g22_rec709_scene", std::pow(0.5, 2.2), std::pow(0.02, 2.2)},
         {"Rec.1886", std::pow(0.5, 2.4), std::pow(0.02, 2.4)}}};
    for (const Case& c : cases) {
        SCOPED_TRACE(c.color_space);
        ImageSpec spec = one_pixel();
        spec.attribute("oiio:ColorSpace", c.color_space);
        // The clamp leaves black, white and what is between them.
        expect_light(light_of(spec, {0.5F, 0.02F, 1}), {c.of_half, c.of_fiftieth, 1}, kTolerance);
        expect_light(light_of(spec, {-1, 2, 0}), {0, 1, 0}, kTolerance);
        // Told otherwise, the numbers are light.
        expect_light(light_of(spec, {0.5F, 0.02F, 1}, "lin_rec709"), {0.5, 0.02, 1}, kTolerance);
        // The same told by the caller, of a picture that says nothing.
        expect_light(light_of(one_pixel(), {0.5F, 0.02F, 1}, c.color_space),
                     {c.of_half, c.of_fiftieth, 1}, kTolerance);
    }
}

TEST(TonemapInput, PrimariesOfThePicture) {
    // ACES2065-1 to linear Rec.709, Bradford, to five digits: as OpenColorIO-Config-ACES 1.2 has
    // it.
    const Matrix3 ap0 = {{{2.52169, -1.13413, -0.38756},
                          {-0.27648, 1.37272, -0.09624},
                          {-0.01538, -0.15298, 1.16835}}};
    // ACEScg, the same.
    const Matrix3 ap1 = {{{1.70505, -0.62179, -0.08326},
                          {-0.13026, 1.14080, -0.01055},
                          {-0.02400, -0.12897, 1.15297}}};
    const std::vector<float> color = {0.3F, 0.2F, 0.25F};
    const Vector3 rgb = {0.3, 0.2, 0.25};
    constexpr double kFiveDigits = 2e-5;
    {
        ImageSpec spec = one_pixel();
        spec.attribute("acesImageContainerFlag", 1);
        set_chromaticities(spec, kAp1Floats);  // the flag is stricter
        expect_light(light_of(spec, color), multiply(ap0, rgb), kFiveDigits);
    }
    {
        ImageSpec spec = one_pixel();
        set_chromaticities(spec, kAp1Floats);
        expect_light(light_of(spec, color), multiply(ap1, rgb), kFiveDigits);
        EXPECT_EQ(light_of(spec, color), light_of(one_pixel(), color, "lin_ap1"))
            << "a known space as floats is that space";
        // Names that readers presume for every EXR say nothing.
        for (const char* presumed : {"Linear", "lin_rec709", "lin_rec709_scene", "scene_linear"}) {
            spec.attribute("oiio:ColorSpace", presumed);
            expect_light(light_of(spec, color), multiply(ap1, rgb), kFiveDigits);
        }
        // A conversion that somebody made does; the primaries stay in the metadata.
        spec.attribute("oiio:ColorSpace", "lin_ap0");
        expect_light(light_of(spec, color), multiply(ap0, rgb), kFiveDigits);
        expect_light(light_of(spec, color, "lin_rec709"), rgb, kTolerance);
    }
    for (const char* name : {"ACEScg", "lin_ap1", "lin_ap1_scene"}) {
        for (const char* attribute : {"oiio:ColorSpace", "colorInteropID"}) {
            ImageSpec spec = one_pixel();
            spec.attribute(attribute, name);
            expect_light(light_of(spec, color), multiply(ap1, rgb), kFiveDigits);
        }
    }
    expect_light(light_of(one_pixel(), color), rgb, kTolerance);
}

TEST(TonemapInput, CieXyz) {
    // Lindbloom's matrices, seven digits: Bradford from E to D65, and XYZ to sRGB. His D65 is that
    // of ASTM E308, 2e-4 from the one of BT.709.
    const Matrix3 to_d65 = {{{0.9531874, -0.0265906, 0.0238731},
                             {-0.0382467, 1.0288406, 0.0094060},
                             {0.0026068, -0.0030332, 1.0892565}}};
    const Matrix3 to_srgb = {{{3.2404542, -1.5371385, -0.4985314},
                              {-0.9692660, 1.8760108, 0.0415560},
                              {0.0556434, -0.2040259, 1.0572252}}};
    ImageSpec spec = one_pixel();
    set_chromaticities(spec, kXyz);
    expect_light(light_of(spec, {0.5F, 0.5F, 0.5F}), {0.5, 0.5, 0.5}, kTolerance);
    const Vector3 expected = multiply(to_srgb, multiply(to_d65, Vector3{0.30, 0.28, 0.20}));
    expect_light(light_of(spec, {0.30F, 0.28F, 0.20F}), expected, 5e-4);
}

TEST(TonemapInput, UnknownColorsAreErrors) {
    const auto refused = [](const ImageSpec& spec, const std::string& part) {
        ImageBuf dst;
        const bool ok = tonemap(dst, make_picture(spec), hable());
        expect_error(dst, ok, part);
    };
    ImageSpec spec = one_pixel();
    spec.attribute("oiio:ColorSpace", "PanaLog");
    refused(spec, "oiio:ColorSpace of the picture: input is PanaLog; expected a name of");
    EXPECT_FALSE(tonemap(make_picture(spec),
                         {.op = resolve_picture_operator("hable"), .input = "lin_rec709"})
                     .has_error());
    spec.attribute("oiio:ColorSpace", "Linear");
    set_chromaticities(spec, {});
    refused(spec, "chromaticities of the picture are 0,0,0,0,0,0,0,0; expected");
    set_chromaticities(spec, {0.64F, 0.33F, 0.3F, 0.6F, 0.15F, std::nanf(""), 0.3127F, 0.329F});
    refused(spec, "chromaticities of the picture are");
    for (const char* nothing : {"", "scene_linear", "unknown", "raw", "data"}) {
        ImageSpec silent = one_pixel();
        silent.attribute("oiio:ColorSpace", nothing);
        expect_light(light_of(silent, {0.1F, 0.2F, 0.3F}), {0.1, 0.2, 0.3}, kTolerance);
    }
}

TEST(TonemapInput, IsThatOfEachPicture) {
    ImageBuf linear = make_rgb(4, 4);
    ImageBuf coded = linear;
    coded.specmod().attribute("oiio:ColorSpace", "sRGB");
    ImageBuf wide = linear;
    set_chromaticities(wide.specmod(), kXyz);
    const Tonemapper one(hable());
    std::vector<ImageBuf> results(3);
    for (int round = 0; round < 2; ++round) {
        ASSERT_TRUE(one(results[0], linear));
        ASSERT_TRUE(one(results[1], coded));
        ASSERT_TRUE(one(results[2], wide));
        EXPECT_TRUE(same_bits(results[0], tonemap(linear, hable())));
        EXPECT_TRUE(same_bits(results[1], tonemap(coded, {.op = resolve_picture_operator("hable"),
                                                          .input = "sRGB"})));
        EXPECT_FALSE(same_bits(results[0], results[1]));
        EXPECT_FALSE(same_bits(results[0], results[2]));
    }
}

TEST(TonemapInput, StatisticsAreOfTheDecodedLight) {
    ImageSpec spec = one_pixel();
    spec.attribute("oiio:ColorSpace", "sRGB");
    ImageBuf src(spec);
    set(src, 0, 0, {0.5F, 0.5F, 0.5F});
    EXPECT_NEAR(measure_scene(src).maximum_luminance, std::pow(0.555 / 1.055, 2.4), 1e-12);
    EXPECT_NEAR(measure_scene(src, "lin_rec709").maximum_luminance, 0.5, 1e-12);
    ImageSpec ap1 = one_pixel();
    set_chromaticities(ap1, kAp1Floats);
    ImageBuf wide(ap1);
    set(wide, 0, 0, {0.3F, 0.2F, 0.25F});
    EXPECT_EQ(measure_scene(wide).mean_rgb, measure_scene(wide, "lin_ap1").mean_rgb);
    EXPECT_NE(measure_scene(wide).mean_rgb, measure_scene(wide, "lin_rec709").mean_rgb);
}

TEST(TonemapInput, LuminanceAndChromaAreRefused) {
    // In the order that OpenImageIO gives them, and in the alphabetical one of OpenEXR files.
    for (const std::vector<std::string>& names :
         {std::vector<std::string>{"Y", "RY", "BY"}, {"BY", "RY", "Y"}, {"RY", "BY", "Y"}}) {
        ImageBuf dst;
        const ImageBuf src = make_picture(make_spec(2, 2, names, TypeDesc::HALF));
        expect_error(dst, tonemap(dst, src, hable()),
                     "channels are Y, RY, BY: luminance and chroma");
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
