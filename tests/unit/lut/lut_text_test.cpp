// SPDX-License-Identifier: Apache-2.0
#include "lut/lut_text.h"

#include <gtest/gtest.h>

#include <string>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string error_of(const std::string& path, std::string bytes) {
    try {
        (void)check_lut_text(path, bytes);
    } catch (const FileError& e) {
        return e.what();
    }
    return "no error";
}

const std::string kRows = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n";

TEST(LutText, CubesAreReadAsTheyAreFound) {
    for (const std::string& text :
         {"LUT_3D_SIZE 2\n" + kRows,
          "TITLE \"a\"\n# comment\n\nLUT_3D_SIZE 2\nDOMAIN_MIN 0 0 0\nDOMAIN_MAX 2 2 2\n" + kRows,
          "LUT_3D_SIZE 2\nLUT_3D_INPUT_RANGE 0 1\n" + kRows}) {
        const CubeText cube = parse_cube("a.cube", text);
        EXPECT_EQ(cube.cube.size, 2);
        EXPECT_EQ(cube.table.size, 0);
        ASSERT_EQ(cube.cube.rows.size(), 24U);
        EXPECT_EQ(cube.cube.rows[3], 1) << "red fastest";
        EXPECT_EQ(cube.cube.rows[4], 0);
        EXPECT_EQ(error_of("a.cube", text), "no error");
    }
    EXPECT_EQ(parse_cube("a.cube", "DOMAIN_MAX 2 3 4\nLUT_1D_SIZE 2\n0 0 0\n1 1 1\n").table.hi,
              (std::array<double, 3>{2, 3, 4}));
    std::string with_mark = "\xef\xbb\xbfLUT_3D_SIZE 2\n" + kRows;
    EXPECT_EQ(check_lut_text("a.cube", with_mark), "");
    EXPECT_EQ(with_mark.rfind("LUT_3D_SIZE", 0), 0U) << "the byte order mark is taken out";
}

TEST(LutText, WrongFilesHavePathLineAndReason) {
    EXPECT_NE(error_of("a.cube", "LUT_3D_SIZE 2\n" + kRows + "0 0 0\n").find("a.cube"),
              std::string::npos);
    EXPECT_NE(error_of("a.cube", "LUT_3D_SIZE 2\n0 0 0\n").find("a.cube"), std::string::npos)
        << "rows are missing";
    const std::string nan = error_of("a.cube", "LUT_1D_SIZE 2\n0 0 0\nnan 1 1\n");
    EXPECT_NE(nan.find("line 3"), std::string::npos) << nan;
    for (const char* text : {"", "LUT_3D_SIZE 1000000\n", "LUT_3D_SIZE -2\n",
                             "LUT_3D_SIZE 2\n1 1\n", "LUT_1D_SIZE 2\n0 0 0\n1 1 inf\n", "\x00\x01"})
        EXPECT_NE(error_of("a.cube", text), "no error") << text;
    EXPECT_NE(error_of("a.spi1d", "LUT_3D_SIZE 2\n" + kRows), "no error")
        << "of another format than its extension";
}

TEST(LutText, WordsThatOverflowOpenColorIOAreRefused) {
    EXPECT_NO_THROW(check_lut_words("a.lut", "LUT: 1 2 10\n0\n255\n"));
    EXPECT_THROW(check_lut_words("a.lut", "LUT: 1 2 " + std::string(16, '1') + "\n0\n255\n"),
                 FileError);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
