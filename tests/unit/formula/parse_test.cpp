// SPDX-License-Identifier: Apache-2.0
#include "formula/formula.h"

#include <gtest/gtest.h>

#include <string>

#include "unit/formula/curve_formula.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input(0);

double value_at(const std::string& formula, double x) {
    FormulaScope scope;
    scope.inputs = {"x"};
    return evaluate(parse_formula(formula, scope), x);
}

/// "2:5: message" of a formula that is wrong.
std::string error_of(const std::string& formula) {
    try {
        (void)parsed_formula(formula);
    } catch (const FormulaError& e) {
        return std::to_string(e.at.line) + ":" + std::to_string(e.at.column) + ": " + e.what();
    }
    return "no error";
}

std::string repeated(std::string_view text, int count) {
    std::string all;
    for (int i = 0; i < count; ++i)
        all += text;
    return all;
}

// Values by hand: C's rules, and the definitions of OpenGL's GLSL 4.60, section 8.
TEST(Formula, ComputesItsOperations) {
    const struct {
        const char* formula;
        double x;
        double value;
    } cases[] = {
        {"x", 3, 3},
        {"1 + 2*3", 0, 7},
        {"(1 + 2)*3", 0, 9},
        {"8 - 4 - 2", 0, 2},
        {"8/4/2", 0, 1},
        {"-x*x", 3, -9},
        {"2 - -x", 3, 5},
        {"2--x", 3, 5},
        {"- - x", 3, 3},
        {"+x", 3, 3},
        {"x < 2 ? 10 : 20", 1, 10},
        {"x < 2 ? 10 : 20", 2, 20},
        {"x <= 2 ? 10 : 20", 2, 10},
        {"x > 2", 3, 1},
        {"x > 2", 2, 0},
        {"x >= 2", 2, 1},
        {"x == 2", 2, 1},
        {"x != 2", 2, 0},
        {"x != 2", 3, 1},
        {"x < 1 ? 1 : x < 2 ? 2 : 3", 1.5, 2},
        {"x < 1 ? 1 : x < 2 ? 2 : 3", 9, 3},
        {"x > 1 && x < 3", 2, 1},
        {"x > 1 && x < 3", 3, 0},
        {"x < 1 || x > 3", 4, 1},
        {"x < 1 || x > 3", 2, 0},
        {"x && 5", 2, 1},
        {"x || 0", 7, 1},
        {"!x", 0, 1},
        {"!x", 5, 0},
        {"!(x > 1) + 1", 0, 2},
        {"1 < 2 == 1", 0, 1},
        {"0 || 1 && 0", 0, 0},
        {"pow(x, 3)", 2, 8},
        {"exp(x)", 1, 2.718281828459045},
        {"exp2(x)", 3, 8},
        {"log(x)", 10, 2.302585092994046},
        {"log2(x)", 8, 3},
        {"log10(x)", 1000, 3},
        {"sqrt(x)", 16, 4},
        {"abs(x)", -2, 2},
        {"min(x, 1)", 2, 1},
        {"max(x, 1)", 2, 2},
        {"clamp(x, 0, 1)", 2, 1},
        {"clamp(x, 0, 1)", -2, 0},
        {"mix(10, 20, x)", 0.25, 12.5},
        {"smoothstep(0, 1, x)", 0.25, 0.15625},  // 3/16 - 2/64
        {"sin(x)", 1, 0.8414709848078965},
        {"cos(x)", 1, 0.5403023058681398},
        {"atan2(x, 1)", 1, 0.7853981633974483},
        {"floor(x)", -1.5, -2},
        {"1e-3 + .5 + 2. + 1.5f + 1E+2", 0, 104.001},
        {"a = x*x\nb = a + 1; a*b", 2, 20},
        {"a = max(x, 0)  // comment\n# another\n\na/(a + 1)\n", 3, 0.75},
        {"\r\na = x\r\na + 1\r\n", 1, 2},
        {"x <\n 2\n ? 1\n : 0", 1, 1},
        {"max(x,\n\n  # inside brackets\n  2)", 1, 2},
        {"(x\n + 1)", 1, 2},
        {"x *\n\n 3", 2, 6},
    };
    for (const auto& c : cases)
        EXPECT_DOUBLE_EQ(value_at(c.formula, c.x), c.value) << c.formula << " at " << c.x;
}

// Issue 2320 of OpenColorIO; the values from Python 3.11: n/(n + n**0.55).
TEST(Formula, ReadsReinhardOfIssue2320) {
    const std::string formula = "a = max(x, 1e-10)\na/(a + pow(a, 0.55))";
    EXPECT_DOUBLE_EQ(value_at(formula, 0.18), 0.31612027729525327);
    EXPECT_DOUBLE_EQ(value_at(formula, 1), 0.5);
    EXPECT_DOUBLE_EQ(value_at(formula, 16), 0.7768953867957378);
}

TEST(Formula, IsTheExpressionThatCodeWrites) {
    EXPECT_TRUE(same(parsed_formula("x/(x + k)"), kX / (kX + Expr::uniform("k"))));
    EXPECT_TRUE(same(parsed_formula("k == mode.soft ? x : x*x"),
                     select(equal(Expr::uniform("k"), 1), kX, kX * kX)));
    EXPECT_TRUE(same(parsed_formula("-0.5*x - 2"), Expr(-0.5) * kX - 2));
    EXPECT_TRUE(same(parsed_formula("x > 1 && k < x"),
                     select(less(1, kX), less(Expr::uniform("k"), kX), 0)));
}

TEST(Formula, ErrorsHaveThePosition) {
    const struct {
        const char* formula;
        const char* error;
    } cases[] = {
        {"", "1:1: formula is empty; expected an expression"},
        {" # nothing", "1:11: formula is empty; expected an expression"},
        {"x^2", "1:2: found ^; write pow(a, b)"},
        {"(x ^ 2)", "1:4: found ^; write pow(a, b)"},
        {"max(x ** 2, 1)", "1:7: found **; write pow(a, b)"},
        {"x % 2", "1:3: found %; write a - b*floor(a/b)"},
        {"x & k", "1:3: found &; write &&"},
        {"x < 1 ? x = 2 : 3", "1:11: found =; expected a : after the ?"},
        {"(x = 2)", "1:4: found =; write == to compare"},
        {"a = x\na += 1\na", "2:3: found +=; expected name = expression, with a new name"},
        {"k2 + 1", "1:1: name is k2; expected x, k or mode.soft"},
        {"a = x\nb = a + c\nb", "2:9: name is c; expected x, k, mode.soft or a"},
        {"a = b\nb = a\nb",
         "1:5: name b is used before it has a value; expected the line that sets it above, without "
         "a cycle"},
        {"a = a + 1\na",
         "1:5: name a is used before it has a value; expected the line that sets it above, without "
         "a cycle"},
        {"a = x\na = x\na", "2:1: name a is set a second time; expected a new name"},
        {"x = 1\nx", "1:1: name x is set a second time; expected a new name"},
        {"k = 1\nx", "1:1: name k is set a second time; expected a new name"},
        {"min = x\nmin", "1:1: name min is a function; expected another name"},
        {"a = x", "1:6: formula ends without a value; expected an expression in its last line"},
        {"x\nx",
         "1:1: line has no name, and more lines follow it; expected name = expression, and one "
         "value "
         "in the last line"},
        {"x +", "1:4: found the end; expected an expression"},
        {"x\n+ 1",
         "2:1: line begins with +; expected the operator at the end of the line before, or "
         "brackets "
         "around the sign"},
        {"(x", "1:3: found the end; expected )"},
        {"x)", "1:2: found ); expected an operator or the end of the line"},
        {"x x", "1:3: found x; expected an operator or the end of the line"},
        {"2x", "1:1: number is 2x; expected digits, as in 0.18 or 1e-3"},
        {"0x1F", "1:1: number is 0x1F; expected digits, as in 0.18 or 1e-3"},
        {"1e999", "1:1: number is 1e999; expected one that double precision can hold"},
        {"1/0", "1:2: result is infinite for every input; expected a finite number"},
        {"0/0 + x", "1:2: result is not a number for every input; expected a finite number"},
        {"sqrt(-1)*x", "1:1: result is not a number for every input; expected a finite number"},
        {"pow(x)", "1:1: function pow has 1 operand; expected 2"},
        {"pow()", "1:1: function pow has 0 operands; expected 2"},
        {"sqrt(x, 2)", "1:1: function sqrt has more than 1 operand; expected 1"},
        {"clamp(x, 0, 1, -2)", "1:1: function clamp has more than 3 operands; expected 3"},
        {"pow", "1:1: function pow has no operands; expected ("},
        {"lerp(x, 1, 2)", "1:1: function is lerp; write mix(a, b, t)"},
        {"saturate(x)", "1:1: function is saturate; write clamp(a, 0, 1)"},
        {"1 < x < 2", "1:7: comparisons follow each other; write a < b && b < c, or brackets"},
        {"x \xE2\x88\x92 1", "1:3: found U+2212; expected names, numbers and operators in ASCII"},
        {"\xC3\xA4 + \xE2\x88\x92",
         "1:1: found U+00E4; expected names, numbers and operators in ASCII"},
        {"# \xC3\xA4\xC3\xA4\n y", "2:2: name is y; expected x, k or mode.soft"},
        {"x.rgb", "1:1: name is x.rgb; expected x, k or mode.soft"},
        {"x @ 2", "1:3: found @; expected names, numbers and operators in ASCII"},
        {"x ? 1", "1:6: found the end; expected a : after the ?"},
        {"f(x)",
         "1:1: function is f; expected abs, atan2, clamp, cos, exp, exp2, floor, log, log10, log2, "
         "max, min, mix, pow, sin, smoothstep or sqrt"},
    };
    for (const auto& c : cases)
        EXPECT_EQ(error_of(c.formula), c.error) << c.formula;
    EXPECT_EQ(error_of("powr(x, 1)").find("1:1: function is powr; expected abs"), 0U);
    EXPECT_NE(error_of("powr(x, 1)").find("did you mean pow?"), std::string::npos);
}

TEST(Formula, HasLimits) {
    EXPECT_NE(error_of(repeated("(", 201) + "x").find("are inside each other"), std::string::npos);
    EXPECT_EQ(error_of(repeated("(", 150) + "x" + repeated(")", 150)), "no error");
    for (const char* nest : {"(", "-", "!", "x ? ", "x ? 1 : ", "sqrt(", "x + (", "max(x, "}) {
        const std::string error = error_of(repeated(nest, 30000 / static_cast<int>(strlen(nest))));
        EXPECT_NE(error.find("are inside each other"), std::string::npos) << nest << ": " << error;
    }
    EXPECT_EQ(error_of("x" + repeated(" + x", 900)), "no error");
    EXPECT_NE(error_of("x" + repeated(" + x", 1000)).find("operations depend on each other"),
              std::string::npos);
    // Each line doubles what a tree of it has; as a graph it is small.
    std::string doubling = "a0 = x + 1\n";
    for (int i = 1; i <= 100; ++i) {
        const std::string before = "a" + std::to_string(i - 1);
        doubling += "a" + std::to_string(i) + " = " + before + "*" + before + "\n";
    }
    EXPECT_EQ(node_count(std::array{parsed_formula(doubling + "a100")}), 103U);
    std::string many;
    for (int i = 0; i < 2500; ++i) {
        const std::string n = std::to_string(i);
        many += "a" + n + " = x*" + n + " + x*x + x/" + n + ".5\n";
    }
    EXPECT_NE(error_of(many + "x").find("more than 10000"), std::string::npos);
    EXPECT_EQ(error_of(std::string(kLongestFormula + 1, ' ')),
              "1:1: formula has 262145 bytes; expected at most 262144");
}

TEST(Formula, TemporariesServeSeveralFormulas) {
    FormulaScope scope;
    scope.inputs = {"r", "g", "b"};
    parse_temporaries("peak = max(max(r, g), b)\nlow = min(min(r, g), b)\n", scope);
    const Expr r = Expr::input(0);
    const Expr g = Expr::input(1);
    const Expr b = Expr::input(2);
    EXPECT_TRUE(same(parse_formula("peak - low", scope), max(max(r, g), b) - min(min(r, g), b)));
    EXPECT_THROW(parse_temporaries("peak - low", scope), FormulaError);
}

TEST(Formula, CaretIsBelowTheError) {
    EXPECT_EQ(caret_lines("a = x\n  b + \xC3\xA4\t1", {2, 7}), "    b + ? 1\n        ^");
    EXPECT_EQ(caret_lines("abc", {1, 4}), "  abc\n     ^");
    const std::string long_line(1000, 'x');
    EXPECT_EQ(caret_lines(long_line, {1, 500}),
              "  " + std::string(76, 'x') + "\n  " + std::string(49, ' ') + "^");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
