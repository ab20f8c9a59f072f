// SPDX-License-Identifier: Apache-2.0
#include "shader/language.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(Language, EveryLanguageHasFacts) {
    std::set<std::string> ids;
    for (const ShaderLanguageInfo& info : shader_languages()) {
        const LanguageFacts& facts = facts_of(info.language);
        EXPECT_EQ(facts.language, info.language) << "the row of another";
        EXPECT_TRUE(ids.insert(info.id).second) << info.id;
        EXPECT_EQ(&find_shader_language(info.id), &info);
        EXPECT_EQ(facts.is_double, info.language == ShaderLanguage::javascript) << info.id;
        for (const char* pattern : {facts.function, facts.let, facts.variable}) {
            EXPECT_NE(std::string(pattern).find("{name}"), std::string::npos)
                << info.id << ": " << pattern;
        }
        for (const char* part : {"{condition}", "{yes}", "{no}"})
            EXPECT_NE(std::string(facts.choose).find(part), std::string::npos) << info.id;
        // A 3D LUT needs a texture, or an array of 37^3 colors and more.
        if (info.holds_grids) {
            EXPECT_TRUE(*facts.fetch != '\0' || facts.largest_array > 3U * 37 * 37 * 37) << info.id;
        }
    }
    EXPECT_THROW((void)find_shader_language("glsll"), Error);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
