// SPDX-License-Identifier: Apache-2.0
#include "tonewright/shader.h"

#include <gtest/gtest.h>

#include <set>

#include "full_counts.h"
#include "shader/program.h"
#include "tonewright/error.h"
#include "tonewright/registry.h"
#include "unit/shader/requests.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string error_of(const ShaderRequest& request) {
    try {
        (void)write_shader(request);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
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
        const bool is_grid = reads_grid(request_of(variant.name, variant.look).view);
        const ShaderErrors errors = measure_shader(request_of(variant.name, variant.look, "srgb"));
        for (const ShaderLanguageInfo& language : shader_languages()) {
            const ShaderRequest request =
                request_of(variant.name, variant.look, "srgb", language.language);
            const Shader shader = write_shader(request, &errors);
            EXPECT_EQ(shader.function, shader_function_name(request));
            EXPECT_NE(shader.text.find(" " + shader.function + "("), std::string::npos);
            for (const char c : shader.text)
                ASSERT_TRUE((c >= ' ' && c <= '~') || c == '\n') << variant.name << " " << int{c};
            const std::string code = shader.text.substr(shader.text.find("\n\n"));
            EXPECT_EQ(code.find(" inf"), std::string::npos) << variant.name;
            EXPECT_EQ(code.find(" nan"), std::string::npos) << variant.name;
            EXPECT_EQ(shader.textures.empty(),
                      !is_grid || language.id == "c" || !language.holds_grids)
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

TEST(Shader, EveryApplicationTakesAnOperatorWithAGrid) {
    for (const ShaderApplication& application : shader_applications()) {
        ShaderRequest request = request_of("agx_blender", "", application.display);
        request.application = &application;
        const Shader shader = write_shader(request);
        const bool is_half = shader.text.find("in half floats") != std::string::npos;
        // The error of a half float near 1, through a power of 2.4 and sRGB's curve; computed nodes
        // are within what the formula's float error is.
        EXPECT_LT(shader.errors.in_float, is_half ? 1.2 * 0x1p-12 : 4e-6) << application.id;
        // mpv takes the nodes as they are, in 32-bit floats.
        EXPECT_EQ(shader.text.find("// 3D LUT     57^3 nodes") == std::string::npos,
                  application.id == "mpv");
        request.tables = ShaderTables::formula;
        const Shader computed = write_shader(request);
        EXPECT_LT(computed.errors.in_float, 4e-6) << application.id;
        EXPECT_TRUE(computed.files.empty());
        EXPECT_LT(computed.text.size(), 30000U) << "no table";
    }
    // A look amplifies the error of half floats 18 times, so its nodes are computed; mpv has 32
    // bits.
    ShaderRequest request = request_of("agx_blender", "punchy");
    for (const char* application : {"threejs", "babylon", "mpv"}) {
        request.application = &find_shader_application(application);
        const Shader shader = write_shader(request);
        EXPECT_LT(shader.errors.in_float, 1e-5) << application;
        EXPECT_EQ(shader.text.find("in half floats"), std::string::npos) << application;
    }
    request.tables = ShaderTables::texture;
    request.application = &find_shader_application("babylon");
    EXPECT_NE(error_of(request).find("Babylon.js has a texture for one"), std::string::npos);
    request = request_of("agx_blender");
    request.tables = ShaderTables::texture;
    request.application = &find_shader_application("shadertoy");
    EXPECT_NE(error_of(request).find("no texture is possible there"), std::string::npos);
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
