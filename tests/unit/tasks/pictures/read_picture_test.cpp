// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/read_picture.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "image/spec_conversion.h"
#include "picture/picture_description.h"
#include "tasks/pictures/report_picture.h"
#include "tonewright/registry.h"
#include "unit/errors.h"
#include "unit/image/picture_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using PicturesAsLight = PictureFiles;

TEST_F(PicturesAsLight, TellsWhatTheHeaderSays) {
    write_image_atomically(noise_picture(4, OIIO::TypeDesc::UINT8), file("a.png"));
    const OIIO::ImageBuf picture = read_picture(file("a.png"), {});
    EXPECT_EQ(picture.spec().get_int_attribute("oiio:UnassociatedAlpha"), 0);
    const PictureInfo info = read_picture_info(file("a.png"), {}, "auto");
    EXPECT_EQ(info.spec.width, 160);
    EXPECT_EQ(info.said.alpha, "straight");
    EXPECT_THROW((void)read_picture_info(file("none.png"), {}, "auto"), FileError);
}

TEST_F(PicturesAsLight, LightIsSceneLinearRec709) {
    write_image_atomically(shown_on("srgb"), file("a.png"));
    const OIIO::ImageBuf picture = read_picture(file("a.png"), {});
    const OIIO::ImageBuf light =
        to_rec709_light(picture, source_color(picture_spec(picture.spec()), kAutoInput),
                        kUnitLuminance, file("a.png"));
    EXPECT_EQ(light.spec().format, OIIO::TypeFloat);
    std::vector<float> rgb(24 * 17 * 3);
    light.get_pixels(light.roi(), OIIO::TypeFloat, rgb.data());
    EXPECT_EQ(light_pixels(picture, file("a.png")), rgb);
    EXPECT_NE(error_of([] {
                  (void)light_pixels(OIIO::ImageBuf(OIIO::ImageSpec(4, 4, 1, OIIO::TypeFloat)),
                                     "a");
              }).find("has 1 channels"),
              std::string::npos);
}

TEST(ReportPicture, IsMadeSmaller) {
    ReportPictureRequest request = {.path = "a.exr", .picture = make_rgb(64, 48), .width = 32};
    request.local_operators = {resolve_picture_operator("local_laplacian")};
    const ReportPicture picture = make_report_picture(request);
    EXPECT_EQ(picture.name, "a.exr");
    EXPECT_EQ(picture.width, 32);
    EXPECT_EQ(picture.rgb.size(), 3U * 32 * 24);
    EXPECT_TRUE(picture.exr.starts_with("\x76\x2F\x31\x01"));
    ASSERT_EQ(picture.shown.size(), 1U);
    EXPECT_TRUE(picture.shown[0].starts_with("\x89PNG"));
    EXPECT_EQ(make_report_picture({.width = 320}).name, "chart");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
