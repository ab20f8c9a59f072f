// SPDX-License-Identifier: Apache-2.0
#include "lut/icc.h"

#include <gtest/gtest.h>

#include <lcms2.h>

#include <array>
#include <cmath>
#include <memory>

#include "unit/lut/lut_cases.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(DeviceLink, EqualsTheBakedLut) {
    for (const int version : {2, 4}) {
        LutRequest r = request_for("agx_sobotka", "log2", LutFormat::icc, 17);
        r.icc_version = version;
        Lut lut = sample_lut(r);
        quantize(lut, r);
        const std::string bytes = write_lut(lut, r, {});
        EXPECT_EQ(bytes, write_lut(lut, r, {})) << "the same on every run";
        EXPECT_EQ(bytes[8], version);
        EXPECT_EQ(bytes.substr(12, 12), "linkRGB RGB ");
        EXPECT_EQ(bytes.substr(36, 4), "acsp");
        const DeviceLink link("x.icc", bytes);
        for (const Vector3& v : table_inputs(2000)) {
            std::array<float, 3> in{};
            std::array<float, 3> out{};
            for (std::size_t c = 0; c < 3; ++c)
                in[c] = static_cast<float>(v[c]);
            link.run_rgb(in.data(), out.data(), 1);
            const Vector3 expected =
                interpolate(lut, {static_cast<double>(in[0]), static_cast<double>(in[1]),
                                  static_cast<double>(in[2])});
            // LittleCMS works in 16 bits: half a step of the input, twice as steep here, and half
            // of the output.
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(static_cast<double>(out[c]), expected[c], 2.5e-5);
        }
    }
}

std::array<double, 3> tag_of(cmsHPROFILE profile, cmsTagSignature name) {
    const auto* xyz = static_cast<const cmsCIEXYZ*>(cmsReadTag(profile, name));
    EXPECT_NE(xyz, nullptr);
    return {xyz->X, xyz->Y, xyz->Z};
}

// Little CMS reads what ICC.1:2010-12 says: colorants adapted to D50 by the matrix in `chad`.
// Undone, they are the display's primaries.
TEST(DisplayProfile, HasThePrimariesWhiteAndCurveOfTheDisplay) {
    const IccCurve srgb = {2.4, true};
    for (const auto& [primaries, curve] :
         {std::pair(kRec709, srgb), std::pair(kP3D65, srgb), std::pair(kRec2020, IccCurve{2.4}),
          std::pair(kRec709, IccCurve{2.2}), std::pair(kAP1, IccCurve{1})}) {
        const std::string bytes = write_display_icc(primaries, curve, "a display", false);
        EXPECT_EQ(bytes, write_display_icc(primaries, curve, "a display", false));
        EXPECT_LT(bytes.size(), 1000U);
        EXPECT_EQ(bytes[8], 4);
        EXPECT_EQ(bytes.substr(12, 12), "mntrRGB XYZ ");
        const std::unique_ptr<void, decltype(&cmsCloseProfile)> profile(
            cmsOpenProfileFromMem(bytes.data(), static_cast<cmsUInt32Number>(bytes.size())),
            &cmsCloseProfile);
        ASSERT_TRUE(profile);
        const auto* chad =
            static_cast<const double*>(cmsReadTag(profile.get(), cmsSigChromaticAdaptationTag));
        ASSERT_NE(chad, nullptr);
        Matrix3 adapt{};
        for (std::size_t i = 0; i < 9; ++i)
            adapt[i / 3][i % 3] = chad[i];
        const Matrix3 back = inverse(adapt);
        const std::string_view name = primaries.name;
        const auto expect_xy = [&](const std::array<double, 3>& v, const Chromaticity& xy) {
            std::array<double, 3> xyz{};
            for (std::size_t i = 0; i < 3; ++i)
                xyz[i] = back[i][0] * v[0] + back[i][1] * v[1] + back[i][2] * v[2];
            const double sum = xyz[0] + xyz[1] + xyz[2];
            // Numbers of profiles have 16 binary places.
            EXPECT_NEAR(xyz[0] / sum, xy.x, 1e-4) << name;
            EXPECT_NEAR(xyz[1] / sum, xy.y, 1e-4) << name;
        };
        const auto red = tag_of(profile.get(), cmsSigRedColorantTag);
        const auto green = tag_of(profile.get(), cmsSigGreenColorantTag);
        const auto blue = tag_of(profile.get(), cmsSigBlueColorantTag);
        expect_xy(red, primaries.red);
        expect_xy(green, primaries.green);
        expect_xy(blue, primaries.blue);
        expect_xy(
            {red[0] + green[0] + blue[0], red[1] + green[1] + blue[1], red[2] + green[2] + blue[2]},
            primaries.whitepoint);
        for (const auto tag : {cmsSigRedTRCTag, cmsSigGreenTRCTag, cmsSigBlueTRCTag}) {
            const auto* decode = static_cast<const cmsToneCurve*>(cmsReadTag(profile.get(), tag));
            ASSERT_NE(decode, nullptr);
            for (int i = 0; i <= 32; ++i) {
                const float code = static_cast<float>(i) / 32;
                const double x = static_cast<double>(code);
                const double light =
                    curve.is_srgb ? (x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4))
                                  : std::pow(x, curve.exponent);
                EXPECT_NEAR(static_cast<double>(cmsEvalToneCurveFloat(decode, code)), light, 3e-5)
                    << primaries.name << " " << code;
            }
        }
    }
}

TEST(DisplayProfile, OfGrayHasTheCurveAlone) {
    const std::string bytes = write_display_icc(kRec709, {2.2}, "gray", true);
    EXPECT_EQ(bytes.substr(12, 12), "mntrGRAYXYZ ");
    const std::unique_ptr<void, decltype(&cmsCloseProfile)> profile(
        cmsOpenProfileFromMem(bytes.data(), static_cast<cmsUInt32Number>(bytes.size())),
        &cmsCloseProfile);
    ASSERT_TRUE(profile);
    const auto* decode =
        static_cast<const cmsToneCurve*>(cmsReadTag(profile.get(), cmsSigGrayTRCTag));
    ASSERT_NE(decode, nullptr);
    EXPECT_NEAR(static_cast<double>(cmsEvalToneCurveFloat(decode, 0.5F)), std::pow(0.5, 2.2), 3e-5);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
