// SPDX-License-Identifier: Apache-2.0
#include "tasks/operator_facts.h"

#include <gtest/gtest.h>

#include <string>

#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

ParameterSpec number() {
    ParameterSpec p;
    p.name = "white";
    p.unit = "scene-linear";
    p.default_value = 11.2;
    p.min = 0.5;
    p.max = 100;
    p.help = "scene value shown as white";
    return p;
}

TEST(OperatorFacts, ParametersInWords) {
    ParameterSpec p = number();
    EXPECT_EQ(range_of(p), "[0.5, 100] scene-linear");
    EXPECT_EQ(default_of(p), "11.2");
    EXPECT_EQ(help_of(p), p.help);
    p.from_picture = [](const SceneStatistics&) { return 1.0; };
    p.statistic = "maximum luminance";
    EXPECT_EQ(help_of(p),
              "scene value shown as white; <<task=apply>> takes it from the picture: maximum "
              "luminance");
    p.kind = ParameterSpec::Kind::choice;
    p.choices = {"sdr", "hdr"};
    p.default_choice = "sdr";
    EXPECT_EQ(range_of(p), "sdr or hdr");
    EXPECT_EQ(default_of(p), "sdr");
}

TEST(OperatorFacts, ASectionHasTheFactsAndTheParameters) {
    const Operator& hable = find_operator("hable");
    const std::string section = operator_section(hable, "After it.\n");
    EXPECT_TRUE(section.starts_with("## ")) << section;
    EXPECT_TRUE(operator_section(hable, "", true).starts_with("# "));
    for (const std::string& text : {hable.title, hable.source, hable.license,
                                    std::string("After it."), std::string("shoulder_strength")})
        EXPECT_NE(section.find(text), std::string::npos) << text;
}

TEST(OperatorFacts, DialectsNameTheOthers) {
    const std::string text = dialects_of(find_operator("agx_blender"));
    EXPECT_NE(text.find("others: "), std::string::npos) << text;
    EXPECT_NE(text.find("agx_threejs"), std::string::npos) << text;
    EXPECT_EQ(text.find("agx_blender"), std::string::npos) << text;
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
