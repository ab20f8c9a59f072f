// SPDX-License-Identifier: Apache-2.0
#include "picture/picture_spec.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "image/spec_conversion.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::TypeDesc;

TEST(PictureSpec, TypesHaveTheSizesAndNamesOfOpenImageIO) {
    for (int base = 0; base < TypeDesc::LASTBASE; ++base) {
        const auto basetype = static_cast<TypeDesc::BASETYPE>(base);
        const TypeDesc type(basetype);
        EXPECT_STREQ(name_of(type), type.c_str());
        EXPECT_EQ(is_floating_point(type), type.is_floating_point()) << type.c_str();
        // Texts and pointers are no numbers of a picture.
        if (base == TypeDesc::STRING || base == TypeDesc::PTR) continue;
        for (const int length : {0, 1, 3}) {
            for (const auto aggregate : {TypeDesc::SCALAR, TypeDesc::VEC3, TypeDesc::MATRIX44}) {
                const TypeDesc array(basetype, aggregate, TypeDesc::NOXFORM, length);
                EXPECT_EQ(size_of(array), array.size()) << array.c_str();
            }
        }
    }
}

TEST(PictureSpec, NamesDifferByMoreThanCase) {
    PictureSpec spec;
    spec.attribute("Exif:Gamma", 2.2F);
    spec.attribute("exif:gamma", 1.8F);
    ASSERT_EQ(spec.attributes.size(), 1U);
    EXPECT_EQ(spec.get_float_attribute("EXIF:GAMMA"), 1.8F);
    spec.attribute("a_b", 1);
    spec.attribute("a b", 2);
    spec.attribute("a-b", 3);
    EXPECT_EQ(spec.attributes.size(), 4U);
    spec.erase_attribute("A_B");
    EXPECT_EQ(spec.find_attribute("a_b"), nullptr);
    EXPECT_EQ(spec.get_int_attribute("a b"), 2);
    EXPECT_TRUE(starts_with_but_for_case("Exif:Gamma", "eXIF:"));
    EXPECT_FALSE(starts_with_but_for_case("Exif", "Exif:"));
    EXPECT_FALSE(is_equal_but_for_case("Exif", "Exif:"));
}

TEST(PictureSpec, NumbersAndTextsAreThoseOfOpenImageIO) {
    OIIO::ImageSpec other;
    const std::string ends[] = {"7", "-5", "7x", "1.25", "1.25x", "", "text"};
    for (std::size_t i = 0; i < std::size(ends); ++i)
        other.attribute("text" + std::to_string(i), ends[i]);
    const auto number = [&](const char* name, TypeDesc::BASETYPE type, auto value) {
        other.attribute(name, TypeDesc(type), &value);
    };
    number("uint8", TypeDesc::UINT8, static_cast<unsigned char>(200));
    number("int8", TypeDesc::INT8, static_cast<signed char>(-100));
    number("uint16", TypeDesc::UINT16, static_cast<unsigned short>(60000));
    number("int16", TypeDesc::INT16, static_cast<short>(-7));
    number("int", TypeDesc::INT, -123456);
    number("uint", TypeDesc::UINT, 123456U);
    number("float", TypeDesc::FLOAT, 1.5F);
    number("double", TypeDesc::DOUBLE, 2.75);
    const PictureSpec spec = picture_spec(other);
    ASSERT_EQ(spec.attributes.size(), other.extra_attribs.size());
    for (const PictureAttribute& attribute : spec.attributes) {
        const std::string& name = attribute.name;
        EXPECT_EQ(spec.get_int_attribute(name, -99), other.get_int_attribute(name, -99)) << name;
        EXPECT_EQ(spec.get_string_attribute(name, "none"),
                  std::string(other.get_string_attribute(name, "none")))
            << name;
        // OpenImageIO 2.4 makes floats of all whole numbers but those of 32 bits.
        if (name == "int" || name == "uint") continue;
        EXPECT_EQ(spec.get_float_attribute(name, -99), other.get_float_attribute(name, -99))
            << name;
    }
    EXPECT_EQ(spec.get_float_attribute("int"), -123456.0F);
    EXPECT_EQ(spec.get_int_attribute("none", 3), 3);
    EXPECT_EQ(spec.get_float_attribute("none", 3), 3);
}

TEST(PictureSpec, AttributesAreFoundByTheirType) {
    PictureSpec spec;
    const std::array<float, 8> xy = {1, 2, 3, 4, 5, 6, 7, 8};
    const TypeDesc eight(TypeDesc::FLOAT, 8);
    spec.attribute("chromaticities", eight, xy.data());
    const PictureAttribute* const found = spec.find_attribute("Chromaticities", eight);
    ASSERT_NE(found, nullptr);
    EXPECT_EQ(found->numbers<float>()[7], 8);
    EXPECT_EQ(spec.find_attribute("chromaticities", TypeDesc(TypeDesc::FLOAT, 7)), nullptr);
    EXPECT_EQ(spec.find_attribute("chromaticities", TypeDesc(TypeDesc::INT, 8)), nullptr);
    const std::string texts[] = {"a", "b"};
    spec.attribute("views", TypeDesc(TypeDesc::STRING, 2), texts);
    EXPECT_EQ(spec.find_attribute("views")->texts, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(spec.get_string_attribute("views", "none"), "none") << "two texts are not one";
}

TEST(PictureSpec, BytesOfRows) {
    PictureSpec spec;
    spec.width = 5;
    spec.nchannels = 4;
    spec.format = TypeDesc::HALF;
    spec.channelnames = {"R", "G", "B"};
    EXPECT_EQ(spec.pixel_bytes(), 8U);
    EXPECT_EQ(spec.scanline_bytes(), 40U);
    EXPECT_EQ(spec.channel_name(2), "B");
    EXPECT_EQ(spec.channel_name(3), "");
    EXPECT_EQ(spec.channelformat(3), TypeDesc(TypeDesc::HALF));
    spec.channelformats = {TypeDesc::HALF, TypeDesc::FLOAT};
    EXPECT_EQ(spec.channelformat(1), TypeDesc(TypeDesc::FLOAT));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
