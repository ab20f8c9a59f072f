// SPDX-License-Identifier: Apache-2.0
//
// Facts in headers. Files of every format are in tests/tags; here are pictures in memory, and
// fields of other programs.
#include "picture/picture_description.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "picture/header_tags.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::TypeDesc;

PictureSpec rgb_of(const TypeDesc& type) {
    PictureSpec spec;
    spec.width = 4;
    spec.height = 3;
    spec.nchannels = 3;
    spec.format = type;
    spec.channelnames = {"R", "G", "B"};
    return spec;
}

TEST(PictureDescription, ConvertedPixelsAreNotDecodedAgain) {
    PictureSpec spec = rgb_of(OIIO::TypeUInt8);
    spec.attribute(file_tag::kFormat, "png");
    spec.attribute(file_tag::kColorSpace, "sRGB");
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute(file_tag::kSrgb, 0);
    EXPECT_EQ(source_color(spec, "auto").name, "sRGB");
    // A program has converted them since they were read, and OpenImageIO renames the space.
    spec.attribute("oiio:ColorSpace", "lin_rec709");
    EXPECT_EQ(source_color(spec, "auto").name, "lin_rec709");
}

TEST(PictureDescription, CodePointsComeBeforeAProfileInPngAndAfterItInHeif) {
    for (const auto& [format, rule] : {std::pair("png", "cICP"), std::pair("heif", "nclx")}) {
        PictureSpec spec = rgb_of(OIIO::TypeUInt16);
        spec.attribute(file_tag::kFormat, format);
        spec.attribute(file_tag::kColorSpace, "");
        const int points[4] = {9, 16, 0, 1};
        spec.attribute(kCicpTag, TypeDesc(TypeDesc::INT, 4), points);
        const PictureDescription said = describe_picture(spec, "auto");
        EXPECT_EQ(said.color.name, "Rec.2100-PQ");
        EXPECT_EQ(said.rule, rule);
        EXPECT_EQ(said.transfer, "PQ");
        EXPECT_EQ(said.units, "cd/m2");
    }
}

TEST(PictureDescription, OwnTagsEndWithTheNextProgram) {
    PictureSpec spec = rgb_of(OIIO::TypeHalf);
    spec.attribute(file_tag::kFormat, "openexr");
    spec.attribute(file_tag::kColorSpace, "Linear");
    spec.attribute("oiio:ColorSpace", "Linear");
    spec.attribute("tonewright:display", "rec2020, reference white 203");
    EXPECT_EQ(source_color(spec, "auto").name, "Rec.2020");
    spec.attribute("Software", "OpenImageIO 2.4.7.1 : oiiotool a.exr --colorconvert a b -o b.exr");
    EXPECT_EQ(source_color(spec, "auto").name, "lin_rec709");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
