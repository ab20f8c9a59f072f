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
    const auto steps = [](const MessageStyle& style) {
        return to_json(find_lut_application("unity"), style).at("steps").dump();
    };
    EXPECT_NE(steps({}).find("32 unless changed: size"), std::string::npos) << steps({});
    const MessageStyle style = {.setting = [](std::string_view parameter, std::string_view) {
        return "--" + std::string(parameter);
    }};
    EXPECT_NE(steps(style).find("32 unless changed: --size"), std::string::npos) << steps(style);
}

TEST(JsonForms, ResultsOfVerify) {
    EXPECT_EQ(to_json(LintFinding{LintFinding::Level::note, "config", "text"}).dump(),
              R"({"level":"note","where":"config","what":"text"})");
    EXPECT_STREQ(level_name(LintFinding::Level::error), "error");
    ParityRow row;
    row.op = "hable";
    row.display = "srgb";
    row.backend = "ocio gpu";
    row.lowering = "chain: matrix";
    row.max = 1;
    row.p999 = 2;
    row.mean = 3;
    row.max_all = 4;
    row.max_beyond_rounding = 5;
    row.bound = 6;
    row.is_mixed_metric = true;
    row.is_ok = false;
    row.note = "why";
    const std::string text =
        R"({"operator":"hable","display":"srgb","backend":"ocio gpu","lowering":"chain: matrix",)"
        R"("max":1.0,"p999":2.0,"mean":3.0,"max_all":4.0,"max_beyond_rounding":5.0,"bound":6.0,)"
        R"("mixed_metric":true,"ok":false,"note":"why"})";
    EXPECT_EQ(all_to_json(std::vector<ParityRow>{row, row}).dump(), "[" + text + "," + text + "]");
    LutMatch match;
    match.op = "hable";
    match.definition = &find_operator("hable");
    EXPECT_EQ(to_json(match).at("defect").dump(), R"("")");
    EXPECT_EQ(to_json(find_display("srgb")).at("id").dump(), R"("srgb")");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
