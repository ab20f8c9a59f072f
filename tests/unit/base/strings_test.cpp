// SPDX-License-Identifier: Apache-2.0
#include "base/strings.h"

#include <gtest/gtest.h>

#include <string>

#include "lut/clf.h"

namespace tonewright {
namespace {

TEST(OneLine, RemovesControlCharacters) {
    EXPECT_EQ(one_line("two\n  lines\r\n"), "two lines");
    EXPECT_EQ(one_line("\x1b[2J\x07 bell"), "?[2J? bell");
    EXPECT_EQ(one_line("\xc2\x9b"
                       "31m, C1"),
              "??31m, C1");
    EXPECT_EQ(one_line("right to left \xe2\x80\xae"), "right to left ???");
    EXPECT_EQ(one_line(std::string("a\0b", 3)), "a?b");
}

TEST(OneLine, KeepsUtf8AndReplacesOtherBytes) {
    EXPECT_EQ(one_line("Lumi\xc3\xa8re \xe6\x98\xa0 \xf0\x9f\x8e\xac"),
              "Lumi\xc3\xa8re \xe6\x98\xa0 \xf0\x9f\x8e\xac");
    EXPECT_EQ(one_line("Lumi\xe8re"), "Lumi?re");            // Latin-1
    EXPECT_EQ(one_line("\xc0\xaf \xed\xa0\x80"), "?? ???");  // overlong, surrogate
    EXPECT_EQ(one_line("cut \xe6\x98"), "cut ??");
}

TEST(OneLine, IsLimited) {
    EXPECT_EQ(one_line(std::string(5000, 'x')), std::string(2000, 'x') + "...");
    EXPECT_EQ(one_line("abc", 3), "abc");
}

TEST(Numbers, HashIsFnv1a) {
    // The published test values of FNV-1a, 32 bits.
    EXPECT_EQ(content_hash(""), "811c9dc5");
    EXPECT_EQ(content_hash("a"), "e40c292c");
    EXPECT_EQ(content_hash("foobar"), "bf9cf968");
}

TEST(Numbers, XmlIsEscaped) {
    EXPECT_EQ(xml_escape("a < b & c > \"d\""), "a &lt; b &amp; c &gt; &quot;d&quot;");
}

}  // namespace
}  // namespace tonewright
