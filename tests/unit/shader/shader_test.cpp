// SPDX-License-Identifier: Apache-2.0
#include "tonewright/shader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/format_number.h"

#include "base/random.h"
#include "full_counts.h"
#include "shader/float_form.h"
#include "shader/float_run.h"
#include "shader/print.h"
#include "tonewright/definition.h"
#include "tonewright/error.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

ShaderRequest request_of(const std::string& op, const std::string& look = "",
                         const std::string& display = "linear",
                         ShaderLanguage language = ShaderLanguage::glsl) {
    ShaderRequest request;
    request.view = make_view(resolve_operator(op, {}, look), "lin_rec709", 0, display);
    request.language = language;
    return request;
}

std::string error_of(const ShaderRequest& request) {
    try {
        (void)write_shader(request);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

/// Numbers that break shaders: 0, denormals, the largest half float, far beyond it, infinity; all
/// signs, all combinations.
std::vector<float> hostile_colors(std::size_t random_count) {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    const std::vector<float> values = {0.0F,    -0.0F,   1e-45F, 1e-38F, 1e-30F, 1e-10F,
                                       0.18F,   1.0F,    16.3F,  65504,  1e30F,  kInf,
                                       -1e-45F, -1e-10F, -0.2F,  -65504, -1e30F, -kInf};
    std::vector<float> rgb;
    for (const float r : values) {
        for (const float g : values) {
            for (const float b : values)
                rgb.insert(rgb.end(), {r, g, b});
        }
    }
    SampleRandom random(19);
    for (std::size_t i = 0; i < 3 * random_count; ++i) {
        const auto x = static_cast<float>(std::exp2(random.uniform(-149, 127)));
        rgb.push_back(random.uniform(0, 1) < 0.3 ? -x : x);
    }
    return rgb;
}

/// Every finite color and both infinities give finite numbers, as float computes them.
void expect_finite(const ShaderProgram& program, const std::vector<float>& rgb,
                   const std::string& what) {
    std::vector<float> out(rgb.size());
    FloatRun(program).run_rgb(rgb.data(), out.data(), rgb.size() / 3);
    for (std::size_t i = 0; i < rgb.size(); ++i) {
        if (std::isfinite(out[i])) continue;
        const std::size_t c = i / 3 * 3;
        FAIL() << what << ": (" << rgb[c] << ", " << rgb[c + 1] << ", " << rgb[c + 2] << ") gives "
               << out[i];
    }
}

TEST(Shader, EveryVariantInEveryLanguageIsAsciiAndHasItsOwnName) {
    std::set<std::string> names;
    int count = 0;
    for (const OperatorVariant& variant : all_variants()) {
        // All names; a fifth of the texts.
        EXPECT_TRUE(
            names.insert(shader_function_name(request_of(variant.name, variant.look))).second)
            << variant.name;
        if (count++ % count_of(1, 5) != 0) continue;
        const bool is_lattice = reads_lattice(request_of(variant.name, variant.look).view);
        const ShaderErrors errors = measure_shader(request_of(variant.name, variant.look, "srgb"));
        for (const ShaderLanguageInfo& language : shader_languages()) {
            const ShaderRequest request =
                request_of(variant.name, variant.look, "srgb", language.language);
            if (is_lattice && !language.holds_lattices) {
                EXPECT_NE(error_of(request).find("expected a language with textures"),
                          std::string::npos)
                    << variant.name << " " << language.id;
                continue;
            }
            const Shader shader = write_shader(request, &errors);
            EXPECT_EQ(shader.function, shader_function_name(request));
            EXPECT_NE(shader.text.find(" " + shader.function + "("), std::string::npos);
            for (const char c : shader.text)
                ASSERT_TRUE((c >= ' ' && c <= '~') || c == '\n') << variant.name << " " << int{c};
            const std::string code = shader.text.substr(shader.text.find("\n\n"));
            EXPECT_EQ(code.find(" inf"), std::string::npos) << variant.name;
            EXPECT_EQ(code.find(" nan"), std::string::npos) << variant.name;
            EXPECT_EQ(shader.textures.empty(), !is_lattice || language.id == "c")
                << variant.name << " " << language.id;
            for (const ShaderTexture& texture : shader.textures) {
                EXPECT_NE(shader.text.find(" " + texture.name), std::string::npos);
                const auto [width, height, depth] = texture.size;
                EXPECT_EQ(texture.rgba.size(),
                          4 * static_cast<std::size_t>(width * height * depth));
            }
        }
    }
}

TEST(Shader, HeadersStateTheMeasuredErrors) {
    const std::string not_measured = "not with these settings";
    const ShaderErrors errors;
    for (const OperatorVariant& variant : all_variants()) {
        const Shader shader = write_shader(request_of(variant.name, variant.look), &errors);
        ASSERT_NE(shader.text.find("// Measured   in code values of sRGB"), std::string::npos)
            << shader.function << " is not in src/shader/measured_errors.inc: its definition has "
            << "changed; run tests/shader/record_errors.py";
    }
    ShaderRequest request = request_of("hable");
    request.view.op = resolve_operator("hable", {{"white", "5"}});
    EXPECT_NE(write_shader(request).text.find(not_measured), std::string::npos);
    request = request_of("hable");
    request.view.exposure_stops = 1;
    EXPECT_NE(write_shader(request).text.find(not_measured), std::string::npos);
}

TEST(Shader, NamesTellPresetFromOperator) {
    EXPECT_EQ(shader_function_name(request_of("hable_gdc")), "tw_hable_gdc");
    EXPECT_EQ(shader_function_name(request_of("hable:gdc")), "tw_hable_preset_gdc");
    EXPECT_EQ(shader_function_name(request_of("reinhard:luminance", "", "srgb")),
              "tw_reinhard_luminance_encoded");
    EXPECT_EQ(shader_function_name(request_of("agx_sobotka", "golden")), "tw_agx_sobotka_golden");
    ShaderRequest inverse = request_of("reinhard", "", "srgb");
    inverse.is_inverse = true;
    EXPECT_EQ(shader_function_name(inverse), "tw_reinhard_inverse_encoded");
}

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
// specification; S. Wrensch, "Minimal AgX Implementation" and ACESlib.RRT_Common of ACES 1.3.
TEST(Shader, PartsHaveTheNamesOfTheirSources) {
    const std::map<std::string, std::vector<std::string>> sources = {
        {"uchimura", {"S0 = 0.532", "C2 = ", "w0 = ", "bool w2 = ", "w1 = ", "toe = "}},
        {"khronos_neutral", {"start = 0.76", "peak = ", "desaturation = 0.15"}},
        {"agx_minimal", {"n = ", "n2 = n * n", "n4 = n2 * n2"}},
        {"aces_13", {"saturation = ", "yc = ", "hue = "}},
        {"somewhat_boring", {"luma = ", "cb = ", "cr = ", "by_channel_r = ", "by_channel_b = "}},
        {"reinhard_jodie", {"luminance = ", "t_r = ", "t_g = ", "t_b = "}}};
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
    const PartNames outer;
    (void)named("other", Expr::input() / 0.22);  // a part of it, under another name
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

TEST(FloatForm, GuardsOnlyWhatCanGoWrong) {
    const Expr x = Expr::input();
    const auto form = [&](const Expr& e, const Interval& in) {
        return to_string(FloatForm({in}, {})(e));
    };
    EXPECT_EQ(form(log2(x), {0.1, 1}), "log2(x)");
    EXPECT_EQ(form(sqrt(x), {0, 1}), "sqrt(x)");
    EXPECT_EQ(form(sqrt(x), {-1, 1}), "sqrt(max(x, 0))");
    EXPECT_EQ(form(1 / (x + 1), {0, 1}), "1/(x + 1)");
    EXPECT_EQ(form(1 / x, {0, 1}), "1/max(x, 1e-30)");
    EXPECT_EQ(form(1 / x, {-1, 1}), "1/select(less(abs(x), 1e-30), 1e-30, x)");
    EXPECT_EQ(form(pow(x, 2), {-1, 1}), "x*x");
    EXPECT_EQ(form(pow(x, 0.5), {0, 1}), "sqrt(x)");
    EXPECT_EQ(form(pow(x, 2.2), {0.5, 1}), "pow(x, 2.2)");
    EXPECT_EQ(form(pow(x, 2.2), {0, 1}), "pow(max(x, 1.1754943508222875e-38), 2.2)");
    // The smallest float to the power of 0.01 is 0.42: 0 has to be told apart.
    EXPECT_EQ(form(pow(x, 0.01), {0, 1}),
              "select(less(0, x), pow(max(x, 1.1754943508222875e-38), 0.01), 0)");
}

// 1 - e^-x of small x, which float rounds away as it is written.
TEST(FloatForm, OneMinusAnExponentialKeepsItsDigits) {
    const Expr x = Expr::input();
    const Expr f = FloatForm({{0, 4}}, {})(1 - exp(-x));
    ShaderProgram program;
    program.scalars.push_back({"f", f});
    program.steps.emplace_back(ScalarStep{0});
    const FloatRun run(program);
    for (const float at : {0.0F, 1e-8F, 1e-4F, 0.01F, 0.1F, 0.24F, 0.26F, 1.0F, 4.0F}) {
        std::array<float, 3> color = {at, at, at};
        run.run_rgb(color.data(), color.data(), 1);
        const double right = -std::expm1(-double{at});
        EXPECT_NEAR(double{color[0]}, right, 4e-7 * right) << at;  // a few roundings
    }
}

TEST(Shader, FiniteInFloatForHostileColors) {
    const std::vector<float> rgb = hostile_colors(2000);
    for (const OperatorVariant& variant : all_variants()) {
        for (const char* display : {"linear", "srgb", "rec2100_pq"}) {
            const ShaderRequest request = request_of(variant.name, variant.look, display);
            expect_finite(make_program(build_view(request.view), {}), rgb,
                          variant.name + " " + variant.look + " " + display);
        }
    }
}

// Parameters at the ends of their intervals and between, as constants and as uniforms.
TEST(Shader, FiniteInFloatForAllSettings) {
    const std::vector<float> rgb = hostile_colors(200);
    SampleRandom random(7);
    int count = 0;
    for (const Operator& op : all_operators()) {
        const std::vector<std::string> live = live_parameters(op);
        if (live.empty()) continue;
        for (int round = 0; round < 32; ++round) {
            Settings settings;
            UniformValues values;
            UniformRanges ranges;
            for (const ParameterSpec& spec : op.parameters) {
                if (std::find(live.begin(), live.end(), spec.name) == live.end()) continue;
                const double at = random.uniform(0, 1);
                const double value = at < 0.25   ? spec.min
                                     : at > 0.75 ? spec.max
                                                 : random.uniform(spec.min, spec.max);
                values[spec.name] = value;
                ranges[spec.name] = {spec.min, spec.max};
                settings[spec.name] = shortest(value);
            }
            try {
                (void)resolve(op, nullptr, settings, "");
            } catch (const Error&) {
                continue;  // parameters that contradict each other
            }
            ++count;
            const ResolvedOperator resolved = resolve(op, nullptr, {}, "");
            const View view = make_view(resolved, "lin_rec709", 0, "linear");
            const Pipeline pipeline = build_live_view(view, live);
            std::string what = op.id;
            for (const auto& [name, value] : values)
                what += " " + name + "=" + std::to_string(value);
            ShaderProgram program = make_program(pipeline, ranges);
            for (ScalarFunction& function : program.scalars)
                function.f = bind_uniforms(function.f, values);
            for (ColorFunction& function : program.colors) {
                for (ColorFunction::Call& call : function.calls)
                    call.argument = bind_uniforms(call.argument, values);
                for (Expr& e : function.f)
                    e = bind_uniforms(e, values);
            }
            expect_finite(program, rgb, what + " with uniforms");
            expect_finite(make_program(bind_uniforms(pipeline, values), {}), rgb, what);
        }
    }
    EXPECT_GE(count, 200);
}

TEST(Shader, ExposureIsAnArgumentInStops) {
    ShaderRequest request = request_of("reinhard");
    request.uniforms = {"exposure"};
    EXPECT_NE(write_shader(request).text.find("vec3 tw_reinhard(vec3 scene, float exposure) {"),
              std::string::npos);
    const Pipeline live = build_live_view(request.view, {"exposure"});
    View exposed = request.view;
    exposed.exposure_stops = 1.5;
    const auto a = compose(bind_uniforms(live, {{"exposure", 1.5}}));
    const auto b = compose(build_view(exposed));
    const std::array<double, 3> color = {0.3, 1.7, 0.02};
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(evaluate(a[c], color), evaluate(b[c], color), 1e-15);  // two roundings
}

TEST(Shader, ExposureComesBeforeTheLimit) {
    ShaderRequest request = request_of("reinhard");
    request.uniforms = {"exposure"};
    const ShaderProgram live =
        make_program(build_live_view(request.view, request.uniforms), {{"exposure", {-64, 64}}});
    request.view.exposure_stops = -17;
    const ShaderProgram constant = make_program(build_view(request.view), {});
    const std::array<double, 3> sun = {3e5, 2e5, 8e4};
    for (std::size_t c = 0; c < 3; ++c) {
        const double x = sun[c] / 131072;
        EXPECT_NEAR(evaluate(compose(constant)[c], sun), x / (x + 1), 1e-15);
        EXPECT_NEAR(evaluate(bind_uniforms(compose(live)[c], {{"exposure", -17}}), sun),
                    x / (x + 1), 1e-15);
    }
}

// Curves in front of an argument and behind it, and one that reads it.
TEST(Shader, FittedCurvesLeaveArgumentsAlone) {
    ShaderRequest request = request_of("uchimura", "", "srgb");
    request.curves = ShaderCurves::fitted;
    for (const std::vector<std::string>& uniforms :
         {std::vector<std::string>{"exposure"}, {"max_brightness"}, {"exposure", "contrast"}}) {
        request.uniforms = uniforms;
        // An error of the polynomials is at most 3 units of 2^-24.
        EXPECT_LE(measure_shader(request).in_float, 4e-7) << uniforms.back();
    }
    const ShaderErrors unmeasured;
    const std::string text = write_shader(request, &unmeasured).text;
    EXPECT_NE(text.find("exp2(exposure)"), std::string::npos);
}

// What three channels have in common is a function; its formula stands there once.
TEST(Shader, ACurveOfEachChannelIsWrittenOnce) {
    const ShaderErrors unmeasured;
    const std::string text = write_shader(request_of("agx_blender:formula"), &unmeasured).text;
    const auto count_of = [&](const std::string& words) {
        int count = 0;
        for (std::size_t at = text.find(words); at != std::string::npos;
             at = text.find(words, at + 1))
            ++count;
        return count;
    };
    EXPECT_EQ(count_of("log2("), 1);
    EXPECT_EQ(count_of("_mix_curve("), 4);  // and three calls
}

TEST(Shader, ErrorsAreOneLine) {
    ShaderRequest request = request_of("hable");
    request.uniforms = {"whit"};
    EXPECT_NE(error_of(request).find("uniforms is whit; expected exposure"), std::string::npos);
    EXPECT_NE(error_of(request).find("did you mean white?"), std::string::npos);
    request.uniforms = {"white", "white"};
    EXPECT_EQ(error_of(request), "uniforms is white twice; expected it once");
    request = request_of("hable_piecewise");
    request.uniforms = {"toe_length"};  // fixed
    EXPECT_NE(error_of(request).find("uniforms is toe_length"), std::string::npos);
    request = request_of("reinhard_jodie");
    request.is_inverse = true;
    EXPECT_NE(error_of(request).find("reinhard_jodie has no inverse: stage "), std::string::npos);
    EXPECT_THROW((void)find_shader_language("cg"), Error);
    EXPECT_EQ(find_shader_language("GLSL_ES").id, "glsl-es");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
