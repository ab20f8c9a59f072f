// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>

#include "tonewright/registry.h"
#include "tonewright/tonemap.h"
#include "tonewright/view.h"
#include "unit/image/pictures.h"
#include "unit/image/tonemapped.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

TEST(Tonemap, ColorSpaceOfTheResult) {
    struct Case {
        const char* op;
        const char* display;
        const char* color_space;
    };
    constexpr std::array<Case, 9> kCases = {{{"hable", "srgb", "sRGB"},
                                             {"hable", "rec1886", "Gamma2.4"},
                                             {"hable", "g22", "Gamma2.2"},
                                             {"hable", "display_p3", "Display P3"},
                                             {"hable", "rec2020", "Rec.2020"},
                                             {"hable", "linear", "Linear"},
                                             {"agx_sobotka", "linear", "Linear"},
                                             {"hable", "native", "Linear"},
                                             {"agx_sobotka", "native", "Gamma2.2"}}};
    for (const Case& c : kCases) {
        const ImageBuf result =
            tonemap(make_rgb(1, 1), {.op = resolve_picture_operator(c.op), .display = c.display});
        ASSERT_FALSE(result.has_error()) << result.geterror();
        EXPECT_EQ(result.spec().get_string_attribute("oiio:ColorSpace"), c.color_space)
            << c.display;
        EXPECT_EQ(result.spec().find_attribute("oiio:Gamma"), nullptr);
    }
}

TEST(Tonemap, ContradictingMetadataGoes) {
    ImageBuf src = make_rgb(2, 2);
    ImageSpec& spec = src.specmod();
    const std::array<unsigned char, 4> profile = {1, 2, 3, 4};
    spec.attribute("ICCProfile", TypeDesc(TypeDesc::UINT8, 4), profile.data());
    spec.attribute("ICCProfile:device_class", "Display device profile");
    spec.attribute("Exif:Gamma", 2.2F);
    spec.attribute("Exif:ColorSpace", 1);
    spec.attribute("oiio:Gamma", 1.8F);
    spec.attribute("oiio:ColorSpace", "Linear");
    spec.attribute("colorInteropID", "lin_ap1_scene");
    spec.attribute("dpx:Transfer", "Printing density");
    const std::array<float, 8> xyz = {1, 0, 0, 1, 0, 0, 1 / 3.0F, 1 / 3.0F};
    spec.attribute("chromaticities", TypeDesc(TypeDesc::FLOAT, 8), xyz.data());
    spec.attribute("Copyright", "somebody");

    for (const bool existing : {false, true}) {
        ImageBuf dst;
        if (existing) dst = src;
        ASSERT_TRUE(tonemap(dst, src, hable()));
        const ImageSpec& out = dst.spec();
        for (const char* gone :
             {"ICCProfile", "ICCProfile:device_class", "Exif:Gamma", "Exif:ColorSpace",
              "oiio:Gamma", "dpx:Transfer", "chromaticities"}) {
            EXPECT_EQ(out.find_attribute(gone), nullptr) << gone;
        }
        EXPECT_EQ(out.get_string_attribute("oiio:ColorSpace"), "sRGB");
        EXPECT_EQ(out.get_string_attribute("colorInteropID"), "srgb_rec709_display");
        EXPECT_EQ(out.get_string_attribute("Copyright"), "somebody");
    }
    EXPECT_NE(src.spec().find_attribute("ICCProfile"), nullptr);

    const ImageBuf p3 =
        tonemap(src, {.op = resolve_picture_operator("hable"), .display = "display_p3"});
    const auto* attribute = p3.spec().find_attribute("chromaticities");
    ASSERT_NE(attribute, nullptr);
    EXPECT_FLOAT_EQ(attribute->get_float_indexed(0), 0.680F);
    EXPECT_FLOAT_EQ(attribute->get_float_indexed(7), 0.3290F);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
