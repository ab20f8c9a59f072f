// SPDX-License-Identifier: Apache-2.0

#include "formula/glsl.h"

#include <gtest/gtest.h>

#include "unit/formula/glsl_color.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// Text around a function: macros, globals, other functions.
TEST(Glsl, ReadsTheRestOfTheFile) {
    const struct {
        const char* shader;
        double value;
    } cases[] = {
        {"float f(float x) { return x*2.0; }", 6},
        {"#define K 5.0\n#define add(a, b) ((a) + (b))\nfloat f(float x) { return add(x, K)*2.0; }",
         16},
        {"#define twice(a) \\\n  (2.0*(a))\nfloat f(float x) { return twice(twice(\n  x)); }", 12},
        {"#define x x\nfloat f(float x) { return x; }", 3},
        {"#define A 1\n#ifdef A\n#define B 2.0\n#else\n#define B 3.0\n#endif\nfloat f(float x) { "
         "return x*B; }",
         6},
        {"#ifndef A\n#define A 4.0\n#endif\n#if 0\nbroken {\n#endif\nfloat f(float x) { return "
         "x*A; }",
         12},
        {"#version 300 es\n#extension all : enable\nprecision highp float;\nfloat f(highp float x) "
         "{ return x; }",
         3},
        {"const float a = 2.0, b = a*2.0;\nfloat f(const in float x) { return x*b; }", 12},
        {"static const float a = 2.0f;\ninline float f(float x) { return x*a; }", 6},
        {"float g(float x);\nfloat f(float x) { return g(x) + 1.0; }\nfloat g(float x) { return "
         "x*x; }",
         10},
        {"float g(float x) { return 1.0; } vec3 g(vec3 x) { return vec3(2.0); }\nfloat f(float x) "
         "{ return g(vec3(x)).r + g(x); }",
         3},
        {"float g(float x, float y = 10.0) { return x*y; }\nfloat f(float x) { return g(x) + g(x, "
         "1.0); }",
         33},
        {"float g(vec3 c) { c *= 2.0; return c.r; }\nfloat f(float x) { vec3 c = vec3(x); return "
         "g(c) + c.r; }",
         9},
        {"float f(float x) { return x; }\nvoid main() { for (;;) discard; }", 3},
        {"uniform sampler2D s; struct A { int b[3]; }; cbuffer C { float d; }\nfloat f(float x) { "
         "return x; }",
         3},
        {"uniform Block { float a; } block;\nlayout(location = 0) out vec4 o;\n[numthreads(8, 8, "
         "1)]\nfloat f(float x) { return x; }",
         3},
        {"Texture2D<float4> t : register(t0); SamplerState s;\nfloat f(float x : TEXCOORD0) : "
         "SV_Target { return x; }",
         3},
        {"float g(float x) { return x; } float h(float x) { return g(x)*2.0; } void main() { "
         "h(1.0); }",
         6},
        {"vec3 f(vec3 c) { return c*5.0; } float f(float x) { return x*4.0; }", 15},
    };
    for (const auto& test : cases) {
        SCOPED_TRACE(test.shader);
        double value = 0;
        ASSERT_NO_THROW(value = value_at(test.shader, {3, 3, 3})[0]);
        EXPECT_DOUBLE_EQ(value, test.value);
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
