// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "lut/lut_text.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string error_of(std::string text) {
    try {
        (void)check_lut_text("a.lut", text);
    } catch (const FileError& e) {
        return std::string(e.what()).substr(std::string("read: a.lut: ").size());
    }
    return "";
}

std::string head_of(const std::string& type, const std::string& length) {
    return "Version 3\nFormat any\nType " + type + "\nFrom 0 1\nTo 0 1\nBlack 0\nWhite 1\nLength " +
           length + "\nLUT:\n";
}

TEST(HoudiniLut, BlocksGoWithTheType) {
    EXPECT_EQ(error_of(head_of("C", "2") + "RGB {\n0\n1\n}\n"), "");
    EXPECT_EQ(error_of(head_of("C", "2") + "{\n0\n1\n}\n"), "line 10: block is 3d; expected RGB");
    const std::string cube = "3D {\n0 0 0 0 0 1 0 1 0 0 1 1\n1 0 0 1 0 1 1 1 0 1 1 1 }\n";
    EXPECT_EQ(error_of(head_of("3D", "2") + cube), "");
    EXPECT_EQ(error_of(head_of("3D+1D", "2 2") + "Pre { 0 1 }\n" + cube), "");
    EXPECT_EQ(error_of(head_of("3D+1D", "2 2") + cube),
              "line 12: the file ends; expected a block Pre");
    EXPECT_EQ(error_of(head_of("3D", "2 2") + cube),
              "line 9: number of sizes in Length is 2; expected 1 with this Type");
    EXPECT_EQ(error_of(head_of("3D", "2") + "{ 0 }\n"),
              "line 10: block 3D has 1 numbers; expected 24");
    EXPECT_EQ(error_of(head_of("C", "2") + "RGB { 0 1 2 }\n"),
              "line 10: block RGB has more than 2 numbers; expected 2");
    EXPECT_EQ(error_of(head_of("C", "2") + "RGB { 0 1\n"), "line 10: the file ends; expected }");
}

TEST(HoudiniLut, TheHeadIsComplete) {
    EXPECT_EQ(error_of("Version 3\nLUT:\n"), "line 2: Format is missing; expected it before LUT:");
    EXPECT_EQ(error_of("Versio 3\n"),
              "line 1: keyword is Versio; expected Version, Format, Type, From, To, Black, White, "
              "Length or LUT:");
    EXPECT_EQ(error_of(head_of("3D", "130")), "line 9: Length is 130; expected [2, 129]");
}

TEST(DiscreetLut, OneNumberStandsOnEachLine) {
    EXPECT_EQ(error_of("LUT: 1 2\n0\n255\n"), "");
    EXPECT_EQ(error_of("LUT: 1 2\n0\n"), "line 2: the table ends after 1 rows; expected 2");
    EXPECT_EQ(error_of("LUT:\n"), "line 1: LUT:; expected Version, Format, Type ... before it");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
