// SPDX-License-Identifier: Apache-2.0
#include "image/spec_conversion.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageSpec;
using OIIO::ParamValue;
using OIIO::TypeDesc;

/// A spec that uses every field, with attributes of all kinds.
ImageSpec full_spec() {
    ImageSpec spec(7, 5, 5, TypeDesc::HALF);
    spec.x = 1;
    spec.y = -2;
    spec.z = 3;
    spec.depth = 2;
    spec.full_x = 4;
    spec.full_y = -5;
    spec.full_z = 6;
    spec.full_width = 8;
    spec.full_height = 9;
    spec.full_depth = 10;
    spec.tile_width = 16;
    spec.tile_height = 32;
    spec.tile_depth = 1;
    spec.channelnames = {"R", "G", "B", "A", "Z"};
    spec.channelformats = {TypeDesc::HALF, TypeDesc::HALF, TypeDesc::HALF, TypeDesc::HALF,
                           TypeDesc::FLOAT};
    spec.alpha_channel = 3;
    spec.z_channel = 4;
    spec.deep = true;
    spec.attribute("text", std::string("a\0b", 3));
    spec.attribute("empty", "");
    const char* texts[] = {"left", "", "right"};
    spec.attribute("texts", TypeDesc(TypeDesc::STRING, 3), texts);
    spec.attribute("int", -5);
    const unsigned code[] = {0x01020304, 7};
    spec.attribute("timecode", OIIO::TypeTimeCode, code);
    const std::array<float, 16> matrix = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
    spec.attribute("matrix", OIIO::TypeMatrix, matrix.data());
    const std::array<float, 3> vector = {1, 2, 3};
    spec.attribute("vector", TypeDesc(TypeDesc::FLOAT, TypeDesc::VEC3, TypeDesc::COLOR),
                   vector.data());
    const int third[] = {1, 3};
    spec.attribute("rational", OIIO::TypeRational, third);
    const std::vector<unsigned char> profile(1000, 0xAB);
    spec.attribute("ICCProfile", TypeDesc(TypeDesc::UINT8, 1000), profile.data());
    const void* pointer = &matrix;
    spec.attribute("pointer", TypeDesc(TypeDesc::PTR), &pointer);
    // Two values of a type, as geometry has them.
    spec.extra_attribs.push_back(
        ParamValue("two", TypeDesc(TypeDesc::FLOAT, TypeDesc::VEC2), 2, matrix.data()));
    return spec;
}

TEST(SpecConversion, LosesNothing) {
    const ImageSpec spec = full_spec();
    const ImageSpec back = image_spec(picture_spec(spec));
    EXPECT_EQ(back.roi(), spec.roi());
    EXPECT_EQ(back.roi_full(), spec.roi_full());
    EXPECT_EQ(back.tile_width, 16);
    EXPECT_EQ(back.tile_height, 32);
    EXPECT_EQ(back.tile_depth, 1);
    EXPECT_EQ(back.format, spec.format);
    EXPECT_EQ(back.channelformats, spec.channelformats);
    EXPECT_EQ(back.channelnames, spec.channelnames);
    EXPECT_EQ(back.alpha_channel, 3);
    EXPECT_EQ(back.z_channel, 4);
    EXPECT_TRUE(back.deep);
    ASSERT_EQ(back.extra_attribs.size(), spec.extra_attribs.size());
    auto other = back.extra_attribs.begin();
    for (const ParamValue& a : spec.extra_attribs) {
        const ParamValue& b = *other++;
        EXPECT_EQ(b.name(), a.name());
        EXPECT_EQ(b.type(), a.type()) << a.name();
        EXPECT_EQ(b.nvalues(), a.nvalues()) << a.name();
        ASSERT_EQ(b.datasize(), a.datasize()) << a.name();
        // Texts are pointers to the one copy that OpenImageIO keeps of each.
        EXPECT_EQ(std::memcmp(b.data(), a.data(), static_cast<std::size_t>(a.datasize())), 0)
            << a.name();
    }
}

TEST(SpecConversion, SpecsAreChangedInPlace) {
    ImageSpec spec = full_spec();
    change_spec(spec, [](PictureSpec& of) {
        of.width = 3;
        of.erase_attribute("text");
        of.attribute("int", 6);
    });
    EXPECT_EQ(spec.width, 3);
    EXPECT_EQ(spec.find_attribute("text"), nullptr);
    EXPECT_EQ(spec.get_int_attribute("int"), 6);
    EXPECT_NE(spec.find_attribute("texts"), nullptr);
    erase_attribute(spec, "TEXTS");
    EXPECT_EQ(spec.find_attribute("texts"), nullptr);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
