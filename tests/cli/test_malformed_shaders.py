# SPDX-License-Identifier: Apache-2.0
"""Shaders that are no operator: `tonewright import` gives one line with its place, and exit 3, in a second and 200 MB."""

from malformed import judge
from pictures import PROJECT

SHADERS = PROJECT / "tests" / "data" / "glsl"
GOOD = "vec3 f(vec3 c) {\n    return c/(c + 1.0);\n}\n"


def malformed():
    """(what, bytes, words of the message) of shaders that are no operator."""
    cases = []

    def add(what, text, message):
        cases.append((what, text if isinstance(text, bytes) else text.encode(), message))

    def body(statements, message, before=""):
        add(statements[:60], f"{before}vec3 f(vec3 c) {{\n    {statements}\n}}\n", message)

    # Files that are no text of a shader.
    for encoding in ("utf-16", "utf-16-le", "utf-16-be", "utf-32"):
        add(encoding, GOOD.encode(encoding), "expected")
    add("empty", b"", "shader has no function of a color; expected float f(float) or vec3 f(vec3)")
    add("a comment", b"// nothing\n", "shader has no function of a color")
    add("NUL", GOOD.encode() + b"\0", "found U+0000; expected names, numbers and operators in ASCII")
    add("NUL in a function", GOOD.replace("1.0", "1.0\0").encode(), "found U+0000")
    add("a superscript", GOOD.replace("c/", "c\u00b2/"), "found U+00B2")
    add("a minus of typography", GOOD.replace("+", "\u2212"), "found U+2212")
    for byte in (0x80, 0xC0, 0xFE, 0xFF):
        add(f"byte {byte:#x}", GOOD.encode() + bytes([byte]), "expected names, numbers and operators in ASCII")
    add("10 MB in a line", b"vec3 f(vec3 c) { return c" + b" + c" * 2_500_000 + b"; }", "it has 10000028 bytes; expected at most 262144")
    add("10 MB of lines", GOOD.encode() + b"// comment\n" * 1_000_000, "bytes; expected at most")
    add("a comment without end", GOOD + "/* ", "found a comment that does not end; expected */")
    # Cut at every place of a shader. What ends behind its first function is good.
    whole = (SHADERS / "aces_hill.glsl").read_bytes()
    for end in range(100, len(whole) - 2, 31):
        add(f"cut at {end}", whole[:end], "expected")

    # What a .tone file has no room for.
    add("a long name", f"float f(float x, float {'y' * 64} = 5.0) {{ return x; }}",
        "bad.glsl:1:24: parameter is yyy")
    add("two names of one", "float f(float x, float White = 2.0, float white = 2.0) { return x*White/white; }",
        "bad.glsl:1:43: parameter is white; expected at most 63 letters, digits and _, and no function, input or other parameter")
    add("65 parameters", f"float f(float x{''.join(f', float p{i} = 1.0' for i in range(65))}) {{ return x; }}",
        "function has 65 parameters; expected at most 64")
    add("81 stages", "vec3 f(vec3 c) {" + "c = mat3(0.9, 0.1, 0, 0, 0.9, 0.1, 0.1, 0, 0.9)*c; c = c/(c + 1.0);" * 40 + "return c; }",
        "function becomes 81 stages; expected at most 64")

    # Code that is not straight-line.
    for loop in ("for (int i = 0; i < 3; i++) c *= c;", "while (true) c *= c;", "do { c *= c; } while (true);"):
        body(f"{loop} return c;", f"found {loop.split()[0]}; expected straight-line code, without loops")
    body("switch (1) { default: return c; }", "found switch; expected if, return")
    body("discard; return c;", "found discard; expected if, return")
    body("return texture(s, c.xy).rgb;", "function is texture; expected no texture", "uniform sampler2D s;\n")
    body("return t.Sample(s, c.xy).rgb;", "type is Texture2D; expected float", "Texture2D<float4> t;\n")
    body("return tex2D(s, c.xy).rgb;", "function is tex2D; expected no texture", "uniform sampler2D s;\n")
    body("return c*dFdx(c);", "function is dFdx; expected no derivative")
    body("return isnan(c.r) ? vec3(0) : c;", "function is isnan; expected none")
    body("float a[3]; return c;", "found [; expected no array")
    body("float[3] a; return c;", "found [; expected no array")
    body("return c*a[0];", "found [; expected no array", "const float a[2] = float[2](1.0, 2.0);\n")
    body("return f(c);", "function f calls itself; expected no recursion")
    add("recursion by way of another", "vec3 g(vec3 c) { return f(c); }\nvec3 f(vec3 c) { return g(c); }\n",
        "calls itself; expected no recursion")
    body("struct A { float b; }; return c;", "found struct; expected no struct")
    add("a struct as type", "struct A { vec3 b; };\nA g(vec3 c) { A a; return a; }\nvec3 f(vec3 c) { return g(c).b; }\n",
        "function g is A; expected float")
    add("inout", "void g(inout vec3 c) { c *= 2.0; }\nvec3 f(vec3 c) { g(c); return c; }\n", "found a call whose value nothing takes")
    add("out", "float g(out float a) { a = 1.0; return a; }\nvec3 f(vec3 c) { return c*g(c.r); }\n",
        "argument is out; expected arguments that only go in")
    body("c++; return c;", "found ++; expected += 1.0 or -= 1.0")
    body("return c % 2.0;", "found %; expected +, -, *, /")
    body("return c ^ 2.0;", "found ^; expected +, -, *, / or a function such as pow(a, b)")
    body("return c & 1;", "found &; expected")
    body("c = c, c = c; return c;", "expected an operator or ;")
    add("#elif", "#if 0\n#elif 1\n#endif\n" + GOOD, "found #elif; expected #if")
    add("#if with an expression", "#if A > 1\n#endif\n" + GOOD, "condition is no number")
    add("#else alone", "#else\n" + GOOD, "found #else; expected #if before it")
    add("#if without end", "#if 1\n" + GOOD, "expected #endif")
    add("# in a macro", "#define A(x) #x\n" + GOOD, "found # in a macro")
    add("a macro without its bracket", "#define A(x x\n" + GOOD, "expected")
    body("return c*A(1.0);", "macro A has 1 arguments; expected 2", "#define A(x, y) x*y\n")
    body("return c*A(1.0, ;", "macro A has no ); expected it", "#define A(x, y) x*y\n")
    bomb = "#define A0 c+c\n" + "".join(f"#define A{i} A{i - 1}+A{i - 1}+A{i - 1}+A{i - 1}\n" for i in range(1, 40))
    body("return A39;", "macros make more than 1048576 words", bomb)
    body("return A7;", "more than 1000 operations depend on each other", bomb)

    # Depth, size and time.
    deep = "more than 200 brackets, signs, blocks or calls"
    for nest in ("(", "- ", "!", "sqrt(", "c.r > 0.0 ? c : ", "max(c, ", "vec3(", "(float3)"):
        body("return " + nest * 10_000, deep)
    body("if (true) " * 20_000, deep)
    body("{" * 20_000 + "}" * 20_000, deep)
    body("vec3 a = " + "{" * 20_000 + "}" * 20_000, deep)
    body("return c" + " + c*c" * 20_000 + ";", "operations")
    body("c = sqrt(c + c.r);" * 700 + "return c;", "more than 1000 operations depend on each other")
    body("".join(f"vec3 a{i} = c*{i}.0 + c;" for i in range(4000)) + "return c;", "function has more than 10000 operations")
    chain = "vec3 g0(vec3 c) { return c*1.1; }\n" + "".join(f"vec3 g{i}(vec3 c) {{ return g{i - 1}(c); }}\n" for i in range(1, 400))
    add("a chain of calls", chain, "calls are inside each other")
    tree = "vec3 g0(vec3 c) { return c*1.1; }\n" + "".join(
        f"vec3 g{i}(vec3 c) {{ return g{i - 1}(c) + g{i - 1}(c*0.5); }}\n" for i in range(1, 40))
    add("a tree of calls", tree, "function has more than 10000 operations")
    add("10,000 functions", "".join(f"float g{i}(float x) {{ return x; }}\n" for i in range(6000)), "more than 500 functions")
    swizzles = "vec3 g0(vec3 c) { return c" + ".bgr" * 20_000 + "; }\n"
    add("swizzles in a tree", swizzles + tree[tree.index("\n") + 1:], "function has more than 200000 operations")

    # Types.
    body("return c.r;x", "name is x; expected a variable")
    body("return c.rg;", "value is vec2; expected vec3")
    body("return vec4(c, 1.0);", "value is vec4; expected vec3")
    body("return mix(c, vec4(1.0), 0.5);", "function mix has vec3 and vec4; expected two of one size")
    body("return c + vec2(1.0);", "operator + has vec3 and vec2; expected two of one size")
    body("return c*mat4(1.0);", "operator * has vec3 and mat4; expected two of one size")
    body("return float3x3(1,0,0, 0,1,0, 0,0,1)*c;", "operator * has float3x3 and vec3; expected mul(a, b)")
    body("return vec3(1.0, 2.0);", "vec3() has 2 numbers; expected 3")
    body("return vec3(c, 1.0);", "vec3() has more than 3 numbers; expected 3")
    body("return vec3();", "vec3() has no operands")
    body("return mat3(1.0, 2.0)*c;", "mat3() has 2 numbers; expected 9")
    body("return c*(1/2);", "operator / has two integers, whose quotient is an integer; expected 1.0/2.0")
    body("if (c.r) return c; return c;", "condition is float; expected bool, such as x < 1.0")
    body("return c.r ? c : c;", "condition is float; expected bool")
    body("return c == c ? c : c;", "operator == has vec3 and vec3; expected two numbers")
    body("return -true ? c : c;", "operator - has bool; expected a number")
    body("return pow(c);", "function pow has 1 operand; expected 2")
    body("return clamp(c, 0.0);", "function clamp has 2 operands; expected 3")
    body("return cross(c.xy, c.xy);", "function cross has vec2; expected vec3")
    body("return inverse(mat3(1.0))*c;", "function is inverse; expected one of the shader, or one of GLSL")
    body("return g(c);", "function g has (vec3); expected (float)", "float g(float x) { return x; }\n")
    body("return c.rx;", "components are rx; expected x, y and z, or r, g and b")
    body("return c.aaa;", "components are aaa; expected x, y and z")
    body("return vec3(c[3]);", "index is no constant below 3")
    body("return vec3(c[int(c.r)]);", "index is no constant below 3")
    body("double2x3 d; return c;", "type is double2x3; expected float")
    body("mat3 m = mat3(1.0); m[0][0] = 2.0; return m*c;", "found part of a matrix; expected the whole of it to be set")
    # Names and values.
    body("return d;", "name is d; expected a variable, an argument or a constant of the shader")
    body("vec3 shade = c; return shad;", "did you mean shade?")
    body("d = c; return c;", "name is d; expected")
    body("vec3 d; return d;", "name d is read before it has a value on every path")
    body("vec3 d; d.rg = c.rg; return d;", "name d is read before it has a value on every path")
    body("vec3 d; if (c.r > 1.0) d = c; return d;", "name d is read before it has a value on every path")
    body("{ vec3 d = c; } return d;", "name is d; expected")
    body("const float a = 1.0; a = 2.0; return c;", "name a is const; expected a variable")
    body("A = 2.0; return c;", "name A is not of this function; expected a variable in it", "float A = 1.0;\n")
    body("c.rr = c.rg; return c;", "component is set twice; expected each once")
    body("if (c.r > 1.0) return c;", "function f may end without a value; expected return on every path")
    body("c *= 2.0;", "function f may end without a value")
    body("return;", "expected a value behind return")
    body("return c", "found }; expected an operator or ;")
    body("return c*(1.0;", "found ;; expected )")
    body("return c*;", "found ;; expected an expression")
    body("f c; return c;", "type is f; expected float")
    body("return c*1.0.0;", "expected")
    body("return c*1e999;", "number is 1e999; expected one that double precision can hold")
    body("return c*0x10;", "number is 0x10; expected digits")
    body("return vec3(1.0/0.0);", "result is infinite for every input; expected a finite number")
    body("return vec3(sqrt(-1.0));", "result is not a number for every input")
    body("return c/c;", "function gives no number for the color 0 0 0; expected a finite number")
    body("return log(c);", "function gives infinity for the color 0 0 0")
    body("return exp(c);", "function gives infinity for the color 65504 65504 65504")
    body("return c*exposure;", "uniform exposure has no value; expected one, as with --parameter exposure=1",
         "uniform float exposure;\n")
    # Brackets and declarations of the file.
    add("{ that is open", GOOD[:-2], "found { that nothing closes; expected }")
    add("( that is open", "vec3 f(vec3 c { return c; }", "expected")
    add("} too many", GOOD + "}", "found }; expected a function, a constant or a uniform")
    add("no type", "f(vec3 c) { return c; }", "found (; expected a function, a constant or a uniform")
    add("an expression", "x/(x + 1.0)", "found /; expected a function, a constant or a uniform")
    add("a statement", "color = color/(color + 1.0);", "found =; expected a function, a constant or a uniform")
    add("void", "void main() { }", "function main is void; expected float")
    add("vec4", "vec4 f(vec4 c) { return c; }", "shader has no function of a color; expected float f(float) or vec3 f(vec3)")
    add("a constant array", "const vec3[2] a = vec3[2](vec3(1), vec3(2));\n" + GOOD, "found [; expected no array")
    add("the name of a function for a parameter", "float f(float x, float pow) { return x*pow; }", "argument pow has no value")
    return cases


def test_files(report, command, scratch):
    judge(report, lambda path, target: [command, "import", path, "-o", target], scratch, malformed(), "bad.glsl", 60)
