// SPDX-License-Identifier: Apache-2.0
#include "tonewright/definition.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <string>
#include <utility>

#include "tonewright/registry.h"
#include "tonewright/view.h"
#include "unit/definition/definitions.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

void expect_error(const std::function<void()>& call, const std::string& words) {
    try {
        call();
        ADD_FAILURE() << "no error; expected " << words;
    } catch (const Error& e) {
        const std::string message = e.what();
        EXPECT_NE(message.find(words), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

/// In linear light of Rec.709.
std::array<double, 3> of_formula(const char* text, double r, double g, double b) {
    const OperatorSet set({}, OperatorSet::Formulas::yes);
    return shown_by(
        build_view(make_view(resolve_operator(text, {}, {}, set), "lin_rec709", 0, "linear")), r, g,
        b);
}

TEST(InlineFormula, IsAnOperator) {
    using Color = std::array<double, 3>;
    EXPECT_EQ(of_formula("x/(1+x)", 1, 3, -2), (Color{0.5, 0.75, 0}));
    EXPECT_EQ(of_formula(" x ", 0.25, 2, 0), (Color{0.25, 2, 0}));
    EXPECT_EQ(of_formula("x < 0.5 ? x : 1 - 0.25/x", 0.25, 1, 2), (Color{0.25, 0.75, 0.875}));
    EXPECT_EQ(of_formula("a = x*2; a/(1 + a)", 0.5, 1.5, 0), (Color{0.5, 0.75, 0}));
    EXPECT_EQ(of_formula("0.25*r + 0.5*g + 0.25*b", 1, 2, 4), (Color{2.25, 2.25, 2.25}));
    EXPECT_EQ(of_formula("b, min(r, g), r/2", 1, 2, 4), (Color{4, 1, 0.5}));
    EXPECT_EQ(of_formula("x, x*2, x*4", 1, 1, 1), (Color{1, 2, 4}));
    const auto op = formula_operator("x/(1+x)");
    EXPECT_EQ(op->name(), "x/(1+x)");
    EXPECT_EQ(operator_text(resolve(*op, nullptr, {}, "")), "x/(1+x)");
    EXPECT_EQ(resolve(*op, nullptr, {}, "").caution(), "");
}

TEST(InlineFormula, ThatEncodesHasACaution) {
    const auto op = formula_operator("pow(x/(1 + x), 1/2.2)");
    // (0.18/1.18)^(1/2.2) = 0.4254
    EXPECT_EQ(resolve(*op, nullptr, {}, "").caution(),
              "pow(x/(1 + x), 1/2.2): mid gray 0.18 becomes 0.425, as code values would; expected "
              "linear light, which --display encodes");
}

TEST(InlineFormula, ComesAfterNamesAndFiles) {
    for (const char* text : {"x", "x/(1+x)", "r, g, b", "max(x, 0)", "1 - exp(-x)", "x^2", "x==1",
                             "x != 1", "a=x; a", "y = x", "return x;"})
        EXPECT_TRUE(may_be_formula(text)) << text;
    for (const char* text : {"", "hable", "AgX (Blender)", "AgX (Blendr)", "r", "2+3", "xyz(1)",
                             "reinhard:white=4", "1.x", "hable white=4", "my_curve:x=1"})
        EXPECT_FALSE(may_be_formula(text)) << text;
    const OperatorSet set({}, OperatorSet::Formulas::yes);
    EXPECT_EQ(resolve_operator("AgX (Blender)", {}, {}, set).op->id, "agx_blender");
    EXPECT_EQ(resolve_operator("hable:white=4", {}, {}, set).op->id, "hable");
    expect_error([] { (void)resolve_operator("x/(1+x)"); }, "expected an id from");
}

TEST(InlineFormula, HasSteps) {
    using Color = std::array<double, 3>;
    EXPECT_EQ(of_formula("x == 1", 1, 2, 0.5), (Color{1, 0, 0}));
    EXPECT_EQ(of_formula("x >= 1 ? 1 : x", 1, 2, 0.5), (Color{1, 1, 0.5}));
    EXPECT_EQ(of_formula("x != 1", 1, 2, 0.5), (Color{0, 1, 1}));
    EXPECT_EQ(of_formula("a=x; a", 1, 2, 0.5), (Color{1, 2, 0.5}));
    const char* const what =
        "; a formula is an expression of x, or of r, g and b, with steps before it: a = x*2; a/(1 "
        "+ "
        "a)";
    for (const char* text : {"y = x/(1+x)", "return x;", "x=1", "x &&", "f(x) = x"})
        expect_error([&] { (void)formula_operator(text); }, what);
}

TEST(InlineFormula, ThatIsWrongSaysWhere) {
    const std::pair<const char*, const char*> wrong[] = {
        {"x^2", "operator is x^2: column 2: ^ is no power here; expected pow(a, b)"},
        {"x/(1+y)", "operator is x/(1+y): column 6: name is y; expected x"},
        {"r + x", "column 1: name is r"},
        {"r, g", "it has 2 formulas; expected one or three"},
        {"r, g, b*", "column 9: found the end"},
        {"1/x", "infinity for the color 0 0 0"},
        {"x/(x + pow(x, 0.55))", "no number for the color 0 0 0"},
    };
    for (const auto& [text, words] : wrong)
        expect_error([t = text] { (void)formula_operator(t); }, words);
    expect_error([] { (void)formula_operator("x" + std::string(5000, '+')); }, "at most 4096");
    for (const char* text : {"x +\n0*x", "x # c", "x // \\", "x/(1+x) */ b", "x\t\\"})
        expect_error([text] { (void)formula_operator(text); }, "expected a .tone file");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
