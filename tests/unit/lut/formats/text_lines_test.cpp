// SPDX-License-Identifier: Apache-2.0
#include "lut/formats/text_lines.h"

#include <gtest/gtest.h>

#include <string>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const std::string kPath = "a.cube";

template <class Run>
std::string error_of(const std::string& text, const Run& run) {
    TextLines lines(kPath, text);
    try {
        while (lines.next_filled())
            run(lines);
    } catch (const FileError& e) {
        return e.what();
    }
    return "";
}

TEST(TextLines, NumbersAreWholeWords) {
    EXPECT_EQ(parse_number("+1.5e1").value_or(0), 15);
    EXPECT_EQ(parse_number("1e-400").value_or(1), 0) << "underflow";
    EXPECT_FALSE(is_float(parse_number("1e400").value_or(0))) << "overflow";
    for (const char* text : {"", "+", "+-1", "1x", "0x10", " 1"})
        EXPECT_FALSE(parse_number(text)) << text;
}

TEST(TextLines, CommentsAndEmptyLinesAreSkipped) {
    const std::string text = "# x\n\n \t\r\n  a b\r\nc";
    TextLines lines(kPath, text);
    ASSERT_TRUE(lines.next_filled());
    EXPECT_EQ(lines.line_number(), 4);
    EXPECT_EQ(lines.word(), "a");
    EXPECT_EQ(lines.word(), "b");
    EXPECT_EQ(lines.word(), "");
    lines.rewind();
    EXPECT_EQ(lines.word(), "a");
    ASSERT_TRUE(lines.next_filled());
    EXPECT_EQ(lines.line(), "c");
    EXPECT_FALSE(lines.next_filled());
}

TEST(TextLines, ErrorsHavePathLineAndReason) {
    const auto row = [](TextLines& lines) { (void)lines.numbers(3); };
    EXPECT_EQ(error_of("0 1 2\n\n0 1 x\n", row),
              "read: a.cube: line 3: number is x; expected a number");
    EXPECT_EQ(error_of("0 1\n", row), "read: a.cube: line 1: 0 1; expected three numbers");
    EXPECT_EQ(error_of("0 1 1e39\n", row),
              "read: a.cube: line 1: number is 1e39; expected a finite number");
    EXPECT_EQ(error_of(std::string("0 \0 1", 5), row),
              "read: a.cube: line 1: the line holds bytes that are not text; expected a text file");
    const auto edge = [](TextLines& lines) { (void)lines.edge(); };
    EXPECT_EQ(error_of("2 2 3", edge), "read: a.cube: line 1: 2 2 3; expected three equal sizes");
    EXPECT_EQ(error_of("2 2 1000", edge),
              "read: a.cube: line 1: size is 1000; expected a whole number in [2, 129]");
}

TEST(TextLines, TablesHaveTheirDeclaredRows) {
    const auto error_of_rows = [](const std::string& text) {
        TableRows rows;
        rows.expect(2);
        TextLines lines(kPath, text);
        try {
            while (lines.next_filled())
                (void)rows.add(lines);
            rows.finish(lines);
        } catch (const FileError& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    EXPECT_EQ(error_of_rows("0 0 0\n1 1 1\n"), "");
    EXPECT_EQ(error_of_rows("0 0 0\n"),
              "read: a.cube: line 1: the table ends after 1 rows; expected 2");
    EXPECT_EQ(error_of_rows("0 0 0\n1 1 1\n2 2 2\n"),
              "read: a.cube: line 3: the table has more than 2 rows; expected 2");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
