// SPDX-License-Identifier: Apache-2.0
#include "formula/glsl.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "unit/formula/glsl_color.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// Values by hand: GLSL 4.60, sections 5 and 8, and the reference of HLSL.
TEST(Glsl, ComputesItsOperations) {
    const Color in = {0.5, 2, -1};
    const struct {
        const char* body;
        Color value;
    } cases[] = {
        {"return c;", {0.5, 2, -1}},
        // Swizzles and parts.
        {"return c.bgr;", {-1, 2, 0.5}},
        {"return c.yyx;", {2, 2, 0.5}},
        {"return vec3(c.st, c.p);", {0.5, 2, -1}},
        {"return c.bgr.xxy;", {-1, -1, 2}},
        {"return c.r.xxx;", {0.5, 0.5, 0.5}},
        {"return vec3(c[2], c[1], 0);", {-1, 2, 0}},
        {"c.r = 7.0; return c;", {7, 2, -1}},
        {"c.rb = c.br; return c;", {-1, 2, 0.5}},
        {"c.gr *= vec2(10.0, 100.0); return c;", {50, 20, -1}},
        {"c.bgr.x = 3.0; return c;", {0.5, 2, 3}},
        {"c[1] = c[0]; return c;", {0.5, 0.5, -1}},
        {"c.rg += 1.0; c.rg -= 0.5; c /= 2.0; return c;", {0.5, 1.25, -0.5}},
        {"vec3 d; d.r = c.b; d.gb = c.rg; return d;", {-1, 0.5, 2}},
        // Constructors and casts.
        {"return vec3(1);", {1, 1, 1}},
        {"return vec3(c.rg, 9);", {0.5, 2, 9}},
        {"return vec3(vec4(c, 4.0).wzyx);", {4, -1, 2}},
        {"return vec3(ivec3(c*1.9));", {0, 3, -1}},
        {"return vec3(bvec3(c.r, 0.0, true));", {1, 0, 1}},
        {"return (float3)c.g + (float)1;", {3, 3, 3}},
        {"return float3(half2(1, 2), 3.5h);", {1, 2, 3.5}},
        {"return vec3(float(true), float(3), int(-2.7));", {1, 3, -2}},
        // Matrices: GLSL's columns, HLSL's rows.
        {"return mat3(1, 2, 3, 4, 5, 6, 7, 8, 9)*c;", {1.5, 3, 4.5}},
        {"return c*mat3(1, 2, 3, 4, 5, 6, 7, 8, 9);", {1.5, 6, 10.5}},
        {"return mul(float3x3(1, 2, 3, 4, 5, 6, 7, 8, 9), c);", {1.5, 6, 10.5}},
        {"return mul(c, float3x3(1, 2, 3, 4, 5, 6, 7, 8, 9));", {1.5, 3, 4.5}},
        {"float3x3 m = {1, 2, 3, {4, 5, 6}, 7, 8, 9}; return mul(m, c);", {1.5, 6, 10.5}},
        {"return mat3(c, c.bgr, vec3(0))*vec3(1, 10, 0);", {-9.5, 22, 4}},
        {"return transpose(mat3(1, 2, 3, 4, 5, 6, 7, 8, 9))*c;", {1.5, 6, 10.5}},
        {"return mat3(2)*c;", {1, 4, -2}},
        {"return (mat3(2)*mat3(0, 1, 0, 1, 0, 0, 0, 0, 1))*c;", {4, 1, -2}},
        {"return (mat3(2) + mat3(1)*3.0)*c;", {2.5, 10, -5}},
        {"return mat3(1, 2, 3, 4, 5, 6, 7, 8, 9)[1];", {4, 5, 6}},
        {"return float3x3(1, 2, 3, 4, 5, 6, 7, 8, 9)[1];", {4, 5, 6}},
        {"return vec3(mat3(1, 2, 3, 4, 5, 6, 7, 8, 9)[2][0]);", {7, 7, 7}},
        {"c *= mat3(1, 2, 3, 4, 5, 6, 7, 8, 9); return c;", {1.5, 6, 10.5}},
        {"vec2 a = mat2(1, 2, 3, 4)*c.rg; return vec3(a, 0);", {6.5, 9, 0}},
        {"c = mat3(2)*c; c = mat3(0, 0, 1, 0, 1, 0, 1, 0, 0)*(c + 1.0); return c + 1.0;",
         {0, 6, 3}},
        {"return mat3(2)*c - c;", {0.5, 2, -1}},
        // Choices.
        {"if (c.r > 1.0) return vec3(1); return vec3(2);", {2, 2, 2}},
        {"if (c.g > 1.0) { return vec3(1); } else { return vec3(2); }", {1, 1, 1}},
        {"if (c.r < 1.0) c = c*2.0; else c = vec3(0); return c;", {1, 4, -2}},
        {"if (c.r < 1.0) c.r = 5.0; return c;", {5, 2, -1}},
        {"if (c.r > 1.0) c.r = 5.0; else if (c.g > 1.0) c.g = 5.0; return c;", {0.5, 5, -1}},
        {"float a; if (c.r > 1.0) { a = 1.0; } else { a = 2.0; } return vec3(a);", {2, 2, 2}},
        {"if (c.b < 0.0) { if (c.r > 1.0) return c; c *= 2.0; } return c;", {1, 4, -2}},
        {"if (c.b < 0.0) { if (c.r < 1.0) return c; c *= 2.0; } return c;", {0.5, 2, -1}},
        {"if (c.r > 1.0) return vec3(1); if (c.g > 1.0) return vec3(2); return vec3(3);",
         {2, 2, 2}},
        {"if (c.r < 1.0) return vec3(1); if (c.g > 1.0) return vec3(2); return vec3(3);",
         {1, 1, 1}},
        {"if (c.r > 1.0) { c = vec3(0); return c; } return c;", {0.5, 2, -1}},
        {"return c.r < 1.0 ? c.g < 1.0 ? vec3(1) : vec3(2) : vec3(3);", {2, 2, 2}},
        {"return c.r < 1.0 && c.g < 1.0 || !(c.b > 0.0) ? vec3(1) : vec3(2);", {1, 1, 1}},
        {"return (c > 0.0) ? c : vec3(7);", {0.5, 2, 7}},
        {"return mix(c, vec3(7), lessThan(c, vec3(1)));", {7, 2, 7}},
        {"return any(greaterThanEqual(c, vec3(2))) ? vec3(1) : vec3(0);", {1, 1, 1}},
        {"return all(greaterThan(c, vec3(-1))) ? vec3(1) : vec3(0);", {0, 0, 0}},
        {"return vec3(not(lessThanEqual(c, vec3(0.5))));", {0, 1, 0}},
        {"return vec3(equal(c, vec3(2))) + vec3(notEqual(c, vec3(2)))*10.0;", {10, 1, 10}},
        {"bool a = c.r != 0.5; return a ? vec3(1) : vec3(c.g == 2.0 ? 3 : 4);", {3, 3, 3}},
        // Functions.
        {"return abs(c) + sign(c);", {1.5, 3, 0}},
        {"return floor(c*1.5) + 10.0*ceil(c*1.5);", {10, 33, -12}},
        {"return fract(c*0.6) + frac(c*0.6);", {0.6, 0.4, 0.8}},
        {"return round(c*1.6) + 10.0*trunc(c*1.6);", {1, 33, -12}},
        {"return mod(c, 0.75) + fmod(c, 0.75);", {1, 1, 0.25}},
        {"return min(c, 1.0) + 10.0*max(c, vec3(0, 3, 0));", {5.5, 31, -1}},
        {"return clamp(c, 0.0, 1.0) + saturate(c);", {1, 2, 0}},
        {"return mix(c, vec3(1), 0.5) + lerp(c, 1.0, vec3(0.5));", {1.5, 3, 0}},
        {"return step(0.5, c) + 10.0*smoothstep(0.0, 1.0, c);", {6, 11, 0}},
        {"return pow(abs(c), vec3(2)) + exp2(c);", {0.25 + std::exp2(0.5), 8, 1.5}},
        {"return exp(c) + log(abs(c));",
         {std::exp(0.5) + std::log(0.5), std::exp(2) + std::log(2), std::exp(-1)}},
        {"return log2(abs(c)) + log10(vec3(10));", {0, 2, 1}},
        {"return sqrt(abs(c)) - inversesqrt(abs(c)) + rsqrt(vec3(4));",
         {std::sqrt(0.5) - 1 / std::sqrt(0.5) + 0.5, std::sqrt(2) - 1 / std::sqrt(2) + 0.5, 0.5}},
        {"return sin(c) + cos(c) + tan(c);",
         {std::sin(0.5) + std::cos(0.5) + std::tan(0.5), std::sin(2) + std::cos(2) + std::tan(2),
          std::sin(-1) + std::cos(-1) + std::tan(-1)}},
        {"return tanh(c) + sinh(c) + cosh(c);",
         {std::tanh(0.5) + std::exp(0.5), std::tanh(2) + std::exp(2),
          std::tanh(-1) + std::exp(-1)}},
        {"return asin(c*0.5) + acos(c*0.5);", {std::acos(0.0), std::acos(0.0), std::acos(0.0)}},
        {"return atan(c) + atan(c, vec3(-1)) + atan2(c, c);",
         {std::atan(0.5) + std::atan2(0.5, -1) + std::atan2(1, 1),
          std::atan(2) + std::atan2(2, -1) + std::atan2(1, 1),
          std::atan(-1) + std::atan2(-1, -1) + std::atan2(-1, -1)}},
        {"return radians(vec3(180)) - degrees(c)*0.0 + mad(c, c, c);",
         {std::acos(-1) + 0.75, std::acos(-1) + 6, std::acos(-1)}},
        {"return vec3(dot(c, vec3(1, 10, 100)), length(vec2(3, 4)), distance(c.rg, c.rg + 1.0));",
         {-79.5, 5, std::sqrt(2)}},
        {"return normalize(vec3(0, 3, 4)) + cross(vec3(1, 0, 0), vec3(0, 1, 0));", {0, 0.6, 1.8}},
        // Scopes and numbers.
        {"vec3 a = c, b = a*2.0; { vec3 a = vec3(0); b += a; } return a + b;", {1.5, 6, -3}},
        {"const int n = 3; return c*float(n - 1) + vec3(n);", {4, 7, 1}},
        {"return c*1. + .5 + 1e1f - 1.0e-1 + 2u;", {12.9, 14.4, 11.4}},
        {"return -c*-2.0 - -c;", {1.5, 6, -3}},
        {"return 8.0/4.0/2.0*c - 1.0 - 1.0;", {-1.5, 0, -3}},
        {"float x = c.r; x = x + x; x = x*x; return vec3(x);", {1, 1, 1}},
    };
    for (const auto& test : cases) {
        SCOPED_TRACE(test.body);
        Color value{};
        ASSERT_NO_THROW(value = value_at(std::string("vec3 f(vec3 c) { ") + test.body + " }", in));
        // Rounding of a few operations.
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_NEAR(value.at(i), test.value.at(i),
                        4e-15 * std::max(1.0, std::abs(test.value.at(i))));
    }
}

TEST(Glsl, CountsNegativeBasesOfPowersAsZero) {
    GlslSettings settings;
    settings.limits_powers = true;
    const auto value = [&](const std::string& expression) {
        const GlslFunction f =
            parse_glsl("float f(float x) { return " + expression + "; }", settings);
        return evaluate(f.values[0], -3);
    };
    EXPECT_EQ(value("pow(x, 1.5)"), 0);
    EXPECT_EQ(value("sqrt(x)"), 0);
    EXPECT_EQ(value("pow(x, 2.0)"), 9);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
