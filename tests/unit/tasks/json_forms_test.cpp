// SPDX-License-Identifier: Apache-2.0
#include "tasks/json_forms.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(JsonForms, OperatorHasItsParameters) {
    const Json op = to_json(find_operator("reinhard_extended"));
    EXPECT_EQ(op.at("id").dump(), R"("reinhard_extended")");
    EXPECT_EQ(op.at("output").dump(), R"("display-linear")");
    EXPECT_NE(op.at("parameters").dump().find(R"("name":"white")"), std::string::npos);
    EXPECT_EQ(to_json(find_picture_operator("local_laplacian")).at("is_local").dump(), "true");
}

TEST(JsonForms, OutputIsLightOrCodeValues) {
    EXPECT_EQ(output_of(find_operator("hable")), "display-linear");
    EXPECT_EQ(output_of(find_operator("agx_sobotka")), "code values, power 2.2");
}

TEST(JsonForms, DeviationsAreWarnings) {
    std::size_t with_deviations = 0;
    for (const Operator& op : all_operators()) {
        EXPECT_EQ(all_warnings(op).size(), op.warnings.size() + op.differences.size());
        with_deviations += op.differences.empty() ? 0 : 1;
    }
    EXPECT_GT(with_deviations, 0U);
}

TEST(JsonForms, StepsOfAnApplicationHaveTheStyle) {
    const std::string steps =
        to_json(find_lut_application("resolve"), MessageStyle{}).at("steps").dump();
    EXPECT_EQ(steps.find("<<"), std::string::npos);
}

TEST(JsonForms, ResultsOfVerify) {
    EXPECT_EQ(to_json(LintFinding{LintFinding::Level::note, "config", "text"}).dump(),
              R"({"level":"note","where":"config","what":"text"})");
    EXPECT_STREQ(level_name(LintFinding::Level::error), "error");
    ParityRow row;
    row.op = "hable";
    EXPECT_EQ(all_to_json(std::vector<ParityRow>{row, row}).dump(),
              "[" + to_json(row).dump() + "," + to_json(row).dump() + "]");
    EXPECT_EQ(to_json(row).at("ok").dump(), "true");
    LutMatch match;
    match.op = "hable";
    match.definition = &find_operator("hable");
    EXPECT_EQ(to_json(match).at("defect").dump(), R"("")");
    EXPECT_EQ(to_json(find_display("srgb")).at("id").dump(), R"("srgb")");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
