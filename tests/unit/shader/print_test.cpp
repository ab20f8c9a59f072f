// SPDX-License-Identifier: Apache-2.0
#include "shader/print.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>

#include "tonewright/definition.h"
#include "tonewright/error.h"
#include "tonewright/shader.h"
#include "unit/shader/requests.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// Written by hand, from E. Reinhard et al. 2002, equation 3, in each language's own grammar.
TEST(Shader, ReinhardReadsLikeItsFormula) {
    const auto body = [](const std::string& text) { return text.substr(text.find("\n\n") + 2); };
    EXPECT_EQ(body(write_shader(request_of("reinhard")).text),
              "float tw_reinhard_curve(float x) {\n"
              "    return x / (1.0 + x);\n"
              "}\n"
              "\n"
              "vec3 tw_reinhard(vec3 scene) {\n"
              "    vec3 c = scene;\n"
              "    c = clamp(c, vec3(0.0), vec3(65504.0));\n"
              "    c = vec3(tw_reinhard_curve(c.r), tw_reinhard_curve(c.g), "
              "tw_reinhard_curve(c.b));\n"
              "    return c;\n"
              "}\n");
    EXPECT_EQ(body(write_shader(request_of("reinhard", "", "linear", ShaderLanguage::wgsl)).text),
              "fn tw_reinhard_curve(x: f32) -> f32 {\n"
              "    return x / (1.0 + x);\n"
              "}\n"
              "\n"
              "fn tw_reinhard(scene: vec3<f32>) -> vec3<f32> {\n"
              "    var c: vec3<f32> = scene;\n"
              "    c = clamp(c, vec3<f32>(0.0), vec3<f32>(65504.0));\n"
              "    c = vec3<f32>(tw_reinhard_curve(c.r), tw_reinhard_curve(c.g), "
              "tw_reinhard_curve(c.b));\n"
              "    return c;\n"
              "}\n");
}

std::string text_of(const ShaderRequest& request) {
    const ShaderErrors not_needed;
    return write_shader(request, &not_needed).text;
}

// Names as the sources have them: H. Uchimura, CEDEC 2017, slides 130-150; the Khronos PBR Neutral
// specification; S. Wrensch, "Minimal AgX Implementation"; ACESlib.RRT_Common and
// LMT.Academy.ReferenceGamutCompress of ACES 1.3.
TEST(Shader, PartsHaveTheNamesOfTheirSources) {
    const std::map<std::string, std::vector<std::string>> sources = {
        {"uchimura", {"S0 = 0.532", "C2 = ", "w0 = ", "bool w2 = ", "w1 = ", "toe = "}},
        {"khronos_neutral", {"start = 0.76", "peak = ", "desaturation = 0.15"}},
        {"agx_minimal", {"n = ", "n2 = n * n", "n4 = n2 * n2"}},
        {"aces_13", {"saturation = ", "yc = ", "hue = "}},
        {"somewhat_boring", {"luma = ", "cb = ", "cr = ", "by_channel_r = ", "by_channel_b = "}},
        {"reinhard_jodie", {"luminance = ", "t_r = ", "t_g = ", "t_b = "}},
        // A later stage has the same part under the name `largest`.
        {"aces_13:gamut_compressed", {"achromatic = "}}};
    for (const auto& [op, names] : sources) {
        const std::string text = text_of(request_of(op));
        for (const std::string& name : names)
            EXPECT_NE(text.find(" " + name), std::string::npos) << name << " in\n" << text;
    }
}

TEST(Shader, TextDoesNotDependOnEarlierTexts) {
    const std::string first = text_of(request_of("uchimura"));
    for (const char* other : {"gt7", "unreal", "reinhard_jodie", "hable_piecewise"})
        (void)text_of(request_of(other));
    const Expr other = named("other", Expr::input() / 0.22);  // a part of it, under another name
    EXPECT_EQ(text_of(request_of("uchimura")), first);
}

TEST(Shader, NoVariableHasAReservedName) {
    const std::string file =
        "tonewright = 1\nid = \"own\"\n[[stage]]\ncurve = \"\"\"\nhalf = x*0.3\nline = half + 0.1\n"
        "a__b = line*line\ngl_Color = a__b + half\na__b/gl_Color\n\"\"\"\n";
    ShaderRequest request;
    const std::shared_ptr<const Operator> own = parse_operator(file, "own.tone");
    request.view = make_view(resolve(*own, nullptr, {}, ""), "lin_rec709", 0, "linear");
    for (const ShaderLanguageInfo& language : shader_languages()) {
        request.language = language.language;
        const std::string text = text_of(request);
        for (const char* name : {" half_value = ", " line_value = ", " a_b = "})
            EXPECT_NE(text.find(name), std::string::npos) << language.id << "\n" << text;
        for (const char* word : {" half ", " line ", "a__b", " gl_"})
            EXPECT_EQ(text.find(word, text.find("\n\n")), std::string::npos) << word;
    }
}

TEST(Shader, MatricesAreRowsInEveryLanguage) {
    const Pipeline pipeline = {MatrixStage{{{{0.5, 0.25, 0.25}, {0, 1, 0}, {-0.125, 0, 1}}}, "m"}};
    const ShaderProgram program = make_program(pipeline, {});
    const std::string in_glsl =
        print_program(program, facts_of(ShaderLanguage::glsl), "f", {}).text;
    EXPECT_NE(in_glsl.find("dot(vec3(0.5, 0.25, 0.25), c),\n        dot(vec3(0.0, 1.0, 0.0), c),"),
              std::string::npos)
        << in_glsl;
    const std::string in_c = print_program(program, facts_of(ShaderLanguage::c), "f", {}).text;
    EXPECT_NE(in_c.find("0.5f * c.r + 0.25f * c.g + 0.25f * c.b"), std::string::npos) << in_c;
    EXPECT_NE(in_c.find("-0.125f * c.r + 0.0f * c.g + 1.0f * c.b"), std::string::npos) << in_c;
}

TEST(Shader, TablesWithEqualPositionsShareTheSearch) {
    Expr sum = 0.0;
    for (const double slope : {1.0, 2.0, 3.0}) {
        const Table table{{0, slope, 3 * slope}, Table::Interpolation::linear, {0, 0.25, 1}};
        sum = sum + lookup(std::make_shared<const Table>(table), Expr::input() * Expr::input());
    }
    const ShaderProgram program = make_program({curve_stage(sum)}, {});
    const auto count_in = [&](ShaderLanguage language, const std::string& what) {
        const std::string text = print_program(program, facts_of(language), "f", {}).text;
        int count = 0;
        for (std::size_t at = text.find(what); at != std::string::npos;
             at = text.find(what, at + 1))
            ++count;
        return count;
    };
    EXPECT_EQ(count_in(ShaderLanguage::glsl, "_positions[3] ="), 1);
    EXPECT_EQ(count_in(ShaderLanguage::glsl, " = f_curve_table_cell("), 1) << "one call for three";
    EXPECT_EQ(count_in(ShaderLanguage::glsl, "(x2, cell)"), 3) << "x * x computed once";
    // Its arrays are local to the function that reads them.
    EXPECT_EQ(count_in(ShaderLanguage::osl, "_positions[3] ="), 3);
}

TEST(Shader, LiteralsReadBackAsTheSameFloat) {
    const LanguageFacts& c = facts_of(ShaderLanguage::c);
    EXPECT_EQ(float_literal(1, c), "1.0f");
    EXPECT_EQ(float_literal(0.1, c), "0.1f");
    EXPECT_EQ(float_literal(-2.5, facts_of(ShaderLanguage::glsl)), "-2.5");
    EXPECT_EQ(float_literal(1e30, c), "1.0e+30f");
    EXPECT_EQ(float_literal(1e-42, c), "0.0f");  // a denormal, which GPUs take for 0
    EXPECT_EQ(float_literal(kInfinity, c), "3.0e+38f");
    for (const double x : {1.0 / 3, 12.47393, 65504.0, 1e-30})
        EXPECT_EQ(std::stof(float_literal(x, c)), static_cast<float>(x));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
