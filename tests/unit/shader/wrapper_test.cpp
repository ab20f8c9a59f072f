// SPDX-License-Identifier: Apache-2.0
#include "shader/wrapper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "shader/texture_form.h"
#include "tonewright/error.h"
#include "tonewright/registry.h"
#include "tonewright/shader.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

Shader shader_of(const ShaderApplication& application) {
    ShaderRequest request;
    request.view = make_view(resolve_operator("hable"), "lin_rec709", 0, application.display);
    request.language = application.language;
    const ShaderErrors errors;
    return write_shader(request, &errors);
}

TEST(ShaderApplications, AreFoundByAnySpelling) {
    std::set<std::string> ids;
    for (const ShaderApplication& application : shader_applications()) {
        EXPECT_TRUE(ids.insert(application.id).second) << application.id;
        EXPECT_EQ(&find_shader_application(application.id), &application);
        std::string other = application.id;
        std::replace(other.begin(), other.end(), '-', '_');
        std::transform(other.begin(), other.end(), other.begin(),
                       [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
        EXPECT_EQ(&find_shader_application(other), &application) << other;
        EXPECT_EQ(application.steps.find('\n'), std::string::npos);
        EXPECT_TRUE(application.display == kLinearOutput ||
                    find_display(application.display).id == application.display);
    }
    EXPECT_THROW((void)find_shader_application("threejss"), Error);
}

TEST(Wrapper, HoldsTheFunctionAndEveryArgumentAndNoMarks) {
    const std::vector<ShaderArgument> arguments = {{"my_dial", "How much of it.", 0.75, 0.125, 8}};
    for (const ShaderApplication& application : shader_applications()) {
        Shader shader = shader_of(application);
        EXPECT_EQ(second_language(application).has_value(), application.id == "threejs-tsl");
        const std::string without = wrap(application, shader, {}, "").text;
        const std::string with = wrap(application, shader, arguments, "").text;
        shader.textures.push_back({"my_nodes", {2, 2, 2}, std::vector<float>(32, 0.5F)});
        if (grid_form(application)) {
            const Shader wrapped = wrap(application, shader, arguments, "");
            EXPECT_TRUE(wrapped.textures.empty());
            EXPECT_EQ(wrapped.files.empty(), !grid_form(application)->contents) << application.id;
            if (grid_form(application)->data) {
                // 0.5 is 0x3800 in a half float and 0x3F000000 in a float: little-endian bytes in
                // base64 and in hexadecimal digits.
                EXPECT_TRUE(wrapped.text.find("ADgAOAA4ADg") != std::string::npos ||
                            wrapped.text.find("0000003f0000003f") != std::string::npos)
                    << application.id;
            }
        }
        shader.textures.front() = {"my_tables", {3, 1, 1}, std::vector<float>(12, 0.5F)};
        std::string with_tables = without;
        if (const TextureForm* form = table_form(application)) {
            const Shader wrapped = wrap(application, shader, arguments, "");
            with_tables = wrapped.text;
            EXPECT_EQ(wrapped.files.empty(), !form->contents) << application.id;
            // 0.5 is 0x3F000000: four floats in base64 and in hexadecimal digits.
            if (form->data) {
                EXPECT_TRUE(wrapped.text.find("AAAAPwAAAD8AAAA/AAAAP") != std::string::npos ||
                            wrapped.text.find("0000003f0000003f") != std::string::npos)
                    << application.id;
            }
        }
        for (const std::string& text : {without, with, with_tables}) {
            EXPECT_NE(text.find(shader.function), std::string::npos) << application.id;
            for (const char* mark :
                 {"@function", "@call",   "@arguments", "@declarations", "@[",       "@]",
                  "@(",        "@)",      "@g(",        "@g)",           "@t(",      "@t)",
                  "@width",    "@height", "@depth",     "@texture",      "@numbers", "@grids",
                  "@bindings", "@other",  "@header",    "@name",         "@value"})
                EXPECT_EQ(text.find(mark), std::string::npos) << application.id << " " << mark;
        }
        EXPECT_EQ(without.find("my_dial"), std::string::npos) << application.id;
        EXPECT_NE(with.find("my_dial"), std::string::npos) << application.id;
        EXPECT_NE(with.find("0.75"), std::string::npos) << application.id;
    }
}

TEST(Wrapper, TextInStringsIsQuoted) {
    for (const ShaderApplication& application : shader_applications()) {
        Shader shader = shader_of(application);
        shader.text = "// `a` ${b} \\ \"\"\"\n" + shader.text;
        const std::string text = wrap(application, shader, {}, shader.text).text;
        if (application.extension == ".js") {
            EXPECT_NE(text.find("// \\`a\\` \\${b} \\\\ \"\"\""), std::string::npos);
        } else if (application.extension == ".gd") {
            EXPECT_NE(text.find("// `a` ${b} \\\\ \\\"\\\"\\\""), std::string::npos);
        } else if (application.extension == ".frag") {
            EXPECT_EQ(text.find('"'), std::string::npos);
        } else {
            EXPECT_NE(text.find("// `a` ${b} \\ \"\"\""), std::string::npos) << application.id;
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
