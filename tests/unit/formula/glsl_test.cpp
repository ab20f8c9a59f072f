// SPDX-License-Identifier: Apache-2.0
#include "formula/glsl.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(Glsl, ReportsTheImportedFunction) {
    const char* const shader =
        "float curve(float x) { return x; }\n"
        "vec3 first(vec3 c) { return c*curve(c.r); }\n"
        "vec3 second(vec3 c, float gain) { return c*gain; }\n"
        "float luminance(vec3 c) { return c.r; }\n";
    GlslSettings settings;
    settings.parameters["gain"] = 2.5;
    const GlslFunction f = parse_glsl(shader, settings);
    EXPECT_EQ(f.name, "second");
    EXPECT_EQ(f.at.line, 3U);
    EXPECT_EQ(f.at.column, 6U);
    EXPECT_EQ(f.others, (std::vector<std::string>{"curve", "first"}));
    ASSERT_EQ(f.parameters.size(), 1U);
    EXPECT_EQ(f.parameters[0].name, "gain");
    EXPECT_EQ(f.parameters[0].value, 2.5);
    EXPECT_TRUE(same(f.values[0], Expr::input(0) * Expr::uniform("gain")));
    settings.function = "first";
    EXPECT_EQ(parse_glsl(shader, settings).name, "first");
}

// The shapes of expressions, which decide what stages come of them.
TEST(Glsl, BuildsTheExpressionOfTheFormula) {
    const Expr r = Expr::input(0);
    const auto red = [](const std::string& body) {
        return parse_glsl("vec3 f(vec3 c) { " + body + " }", {}).values[0];
    };
    EXPECT_TRUE(same(red("return c/(c + 1.0);"), r / (r + 1)));
    EXPECT_TRUE(same(red("if (c.r < 1.0) return c*2.0; return c;"), select(less(r, 1), r * 2, r)));
    EXPECT_TRUE(same(red("if (c.r < 1.0) c *= 2.0; return c;"), select(less(r, 1), r * 2, r)));
    EXPECT_TRUE(same(red("if (1 < 2) return c*2.0; return c;"), r * 2));
    // The saturation 1 of a look leaves no cross-talk.
    EXPECT_TRUE(same(red("float l = dot(c, vec3(0.2, 0.7, 0.1)); return l + 1.0*(c - l);"), r));
    EXPECT_TRUE(same(red("return mix(vec3(dot(c, vec3(1))), c, 1.0);"), r));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
