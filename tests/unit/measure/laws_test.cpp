// SPDX-License-Identifier: Apache-2.0
#include "measure/laws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tonewright/definition.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Verdict = LawResult::Verdict;

ResolvedOperator operator_of(const std::string& formula) {
    static std::vector<std::shared_ptr<const Operator>> kept;
    kept.push_back(formula_operator(formula));
    return resolve(*kept.back(), nullptr, {}, "");
}

LawResult law(const ResolvedOperator& op, const std::string& name) {
    const std::vector<LawResult> all = check_laws(op);
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const LawResult& l) { return l.law == name; });
    EXPECT_NE(found, all.end()) << name;
    return found == all.end() ? LawResult{} : *found;
}

TEST(Laws, HoldForReinhard) {
    for (const char* name : {"finite", "monotone", "bounded", "black", "gray", "continuous"})
        EXPECT_EQ(law(resolve_operator("reinhard"), name).verdict, Verdict::holds) << name;
}

TEST(Laws, ABrokenOneSaysWhere) {
    // 4x/(1 + x)^2 has its maximum at 1, and falls behind it.
    const LawResult falls = law(operator_of("4*x/((1 + x)*(1 + x))"), "monotone");
    EXPECT_EQ(falls.verdict, Verdict::breaks);
    ASSERT_TRUE(falls.x);
    EXPECT_GE(*falls.x, 0.9);
    EXPECT_FALSE(falls.text.empty());
    // A jump of a quarter at 0.5.
    const LawResult jumps = law(operator_of("x < 0.5 ? x : min(x + 0.25, 1)"), "continuous");
    EXPECT_EQ(jumps.verdict, Verdict::breaks);
    ASSERT_TRUE(jumps.x);
    EXPECT_NEAR(*jumps.x, 0.5, 0.02) << "a step of the gray ramp is 1/64 stop, 1.1 %";
    EXPECT_EQ(law(operator_of("x/(1 + x) + 0.1"), "black").verdict, Verdict::breaks) << "lifted";
    EXPECT_EQ(law(operator_of("r/(1 + r), g/(1 + g), 0.9*b/(1 + b)"), "gray").verdict,
              Verdict::breaks)
        << "tinted";
}

TEST(Laws, MeasuredDifferencesAreTheNumbers) {
    using Kind = DocumentedDifference::Kind;
    const Differences lifted = measured_differences(operator_of("0.9*x/(1 + x) + 0.05"));
    ASSERT_EQ(lifted.count(Kind::black), 1U);
    EXPECT_NEAR(lifted.at(Kind::black), 0.05, 1e-12);
    EXPECT_TRUE(declared_differences(operator_of("x")).empty());
    EXPECT_EQ(to_string(Verdict::holds), "holds");
    EXPECT_EQ(to_string(Verdict::does_not_apply), "does not apply");
}

TEST(Laws, TheGrayRampHas64StepsAStop) {
    const std::vector<double> ramp = gray_ramp();
    ASSERT_EQ(ramp.size(), 32U * 64 + 1);
    EXPECT_NEAR(ramp[1024], 0.18, 1e-15);
    EXPECT_NEAR(ramp.back() / ramp.front(), std::exp2(32), 1e-3);
    EXPECT_NEAR(ramp[64] / ramp[0], 2, 1e-14);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
