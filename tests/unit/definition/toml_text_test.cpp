// SPDX-License-Identifier: Apache-2.0
#include "definition/toml_text.h"

#include <gtest/gtest.h>

#include <string>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(TomlText, HasValuesAndTheirPlaces) {
    const TomlValue file = parse_toml("a = 1.5\n[t]\nb = \"x\"\n  c = [true, 2]\n");
    ASSERT_EQ(file.members.size(), 2U);
    EXPECT_EQ(file.members[0].key, "a");
    EXPECT_EQ(file.members[0].number, 1.5);
    EXPECT_EQ(file.members[0].at.line, 1U);
    EXPECT_EQ(file.members[0].at.column, 5U);
    const TomlValue& table = file.members[1];
    EXPECT_EQ(table.kind, TomlValue::Kind::table);
    ASSERT_EQ(table.members.size(), 2U);
    EXPECT_EQ(table.members[0].text, "x");
    EXPECT_EQ(table.members[1].key, "c") << "in the order of the file";
    EXPECT_EQ(table.members[1].key_at.line, 4U);
    EXPECT_EQ(table.members[1].key_at.column, 3U);
    ASSERT_EQ(table.members[1].items.size(), 2U);
    EXPECT_TRUE(table.members[1].items[0].boolean);
    EXPECT_EQ(table.members[1].items[1].number, 2);
}

TEST(TomlText, OrderIsThatOfTheFileAndNotOfNames) {
    std::string names;
    for (const TomlValue& member : parse_toml("z = 1\na = 1\nm = 1\n").members)
        names += member.key;
    EXPECT_EQ(names, "zam");
}

TEST(TomlText, ErrorsHaveThePlace) {
    const auto place = [](const char* text) {
        try {
            (void)parse_toml(text);
        } catch (const TomlError& e) {
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
            return e.at.line;
        }
        return decltype(TextPosition::line){};
    };
    EXPECT_EQ(place("a = 1\na = 2\n"), 2U) << "twice";
    EXPECT_EQ(place("a = 1\n\nb = \"x\n"), 3U) << "an open text";
    EXPECT_GT(place("a = [1"), 0U);
    EXPECT_GT(place("\xff"), 0U) << "no UTF-8";
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
