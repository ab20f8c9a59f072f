// SPDX-License-Identifier: Apache-2.0
#include "ocio/yaml_text.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(YamlText, AppendsToListsAsTheyAreWritten) {
    const struct {
        const char* text;
        const char* result;
    } cases[] = {
        {"views:\n  - a   # first\n  - b\nlast: 1\n",
         "views:\n  - a   # first\n  - b\n  - new\nlast: 1\n"},
        {"views: [a, b]  # both\nlast: 1\n", "views: [a, b, new]  # both\nlast: 1\n"},
        {"views:\r\n- a\r\nlast: 1\r\n", "views:\r\n- a\r\n- new\r\nlast: 1\r\n"},
    };
    for (const auto& c : cases) {
        YamlText text(c.text);
        text.append(text.root()["views"], {YAML::Node("new")});
        EXPECT_EQ(text.result(), c.result);
        EXPECT_EQ(YAML::Load(text.result())["views"].size(),
                  YAML::Load(c.text)["views"].size() + 1);
    }
}

TEST(YamlText, InsertionsAreTheDifference) {
    const std::string original = "a: [1]\nb: text\n";
    YamlText text(original);
    text.append_text(text.root()["b"], " more");
    text.append(text.root()["a"], {YAML::Node("2")});
    text.add("c", {YAML::Node("3")});
    std::string result = text.result();
    const YAML::Node read = YAML::Load(result);
    EXPECT_EQ(read["b"].as<std::string>(), "text more");
    EXPECT_EQ(read["a"].size(), 2U);
    EXPECT_EQ(read["c"][0].as<int>(), 3);
    // Taken out again from the end, they leave the original.
    const std::vector<YamlText::Insertion> all = text.insertions();
    std::size_t inserted = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (i > 0) {
            EXPECT_GE(all[i].at, all[i - 1].at) << "in the order of the text";
        }
        EXPECT_EQ(result.substr(all[i].at, all[i].text.size()), all[i].text);
        result.erase(all[i].at, all[i].text.size());
        inserted += all[i].text.size();
    }
    EXPECT_EQ(result, original);
    EXPECT_GT(inserted, 0U);
}

TEST(YamlText, WithoutChangesItIsTheText) {
    for (const char* text :
         {"a: 1", "a: 1\n", "# only\na: {b: [c]}\n", "a: |\n  lines\n  and more\n"})
        EXPECT_EQ(YamlText(text).result(), text);
    EXPECT_THROW(YamlText("a: [1"), YAML::Exception);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
