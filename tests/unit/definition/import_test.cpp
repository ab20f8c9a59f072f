// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "tonewright/definition.h"
#include "tonewright/error.h"
#include "tonewright/registry.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const std::string kReinhard = "// A comment.\nvec3 tonemap(vec3 c) { return c/(1.0 + c); }\n";

std::string error_of(const std::string& text, const ShaderImport& settings) {
    try {
        (void)import_shader(text, "a.glsl", settings);
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

TEST(Import, AWellKnownShaderIsTheBuiltInOperator) {
    const ImportedShader imported = import_shader(kReinhard, "a.glsl", {});
    EXPECT_EQ(imported.function, "tonemap");
    EXPECT_EQ(imported.stages, (std::vector<std::string>{"clamp", "curve"}));
    EXPECT_TRUE(imported.others.empty());
    const auto op = parse_operator(imported.definition, "a.tone");
    const std::array<Expr, 3> own = compose(resolve(*op, nullptr, {}, "").build());
    const std::array<Expr, 3> built_in = compose(resolve_operator("reinhard").build());
    for (const double x : {-1.0, 0.0, 1e-6, 0.18, 1.0, 65504.0}) {
        // One division and one addition each: the same operations, maybe in another order.
        EXPECT_NEAR(evaluate(own[0], std::array{x, 0.5, 0.5}),
                    evaluate(built_in[0], std::array{x, 0.5, 0.5}), 2e-16)
            << x;
    }
}

TEST(Import, SettingsChooseFunctionIdAndParameters) {
    ShaderImport settings;
    settings.function = "first";
    settings.id = "my_curve";
    settings.parameters["gain"] = {.value = 2};
    const ImportedShader imported = import_shader(
        "vec3 first(vec3 c, float gain) { return c*gain; }\nvec3 last(vec3 c) { return c; }\n",
        "a.glsl", settings);
    EXPECT_EQ(imported.function, "first");
    EXPECT_EQ(imported.others, std::vector<std::string>{"last"});
    const auto op = parse_operator(imported.definition, "a.tone");
    EXPECT_EQ(op->id, "my_curve");
    ASSERT_EQ(op->parameters.size(), 1U);
    EXPECT_EQ(op->parameters[0].default_value, 2);
    EXPECT_EQ(op->parameters[0].min, 2.0 / 16) << "without limits: from a sixteenth";
    EXPECT_EQ(op->parameters[0].max, 32) << "to sixteen times";
}

TEST(Import, ErrorsHaveThePlace) {
    EXPECT_EQ(error_of("vec3 f(vec3 c) { return c*; }", {}).find("a.glsl:1:27: "), 0U)
        << error_of("vec3 f(vec3 c) { return c*; }", {});
    EXPECT_NE(error_of("", {}), "no error");
    ShaderImport settings;
    settings.function = "tonemapp";
    EXPECT_NE(error_of(kReinhard, settings).find("tonemap"), std::string::npos) << "the nearest";
    settings.function = "";
    settings.primaries = "rec710";
    EXPECT_NE(error_of(kReinhard, settings).find("rec709"), std::string::npos);
}

TEST(Import, LoadsTheSameFromAFile) {
    const Folder folder;
    write(folder / "a.glsl", kReinhard);
    EXPECT_EQ(load_shader(folder / "a.glsl", {}).stages,
              import_shader(kReinhard, "a.glsl", {}).stages);
    EXPECT_THROW((void)load_shader(folder / "none.glsl", {}), FileError);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
