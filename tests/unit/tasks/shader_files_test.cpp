// SPDX-License-Identifier: Apache-2.0
#include "tasks/shader_files.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tonewright/registry.h"
#include "unit/errors.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

ShaderRequest request_for(const char* op) {
    ShaderRequest request;
    request.view = make_view(resolve_operator(op), "lin_rec709", 0, kLinearOutput);
    return request;
}

TEST(ShaderFiles, WritesTheTextOfWriteShader) {
    const Folder folder;
    const ShaderRequest request = request_for("hable");
    const ShaderResult result = write_shader_files(request, folder / "hable.glsl", {});
    EXPECT_EQ(result.shader.text, write_shader(request).text);
    EXPECT_EQ(read(folder / "hable.glsl"), result.shader.text);
    EXPECT_FALSE(result.is_double);
    EXPECT_TRUE(result.beside.empty());
    EXPECT_EQ(write_shader_files(request, "", {}).shader.text, result.shader.text) << "no file";
}

TEST(ShaderFiles, TexturesLieBesideTheText) {
    const Folder folder;
    ShaderRequest request = request_for("aces_20");
    request.tables = ShaderTables::texture;
    const ShaderResult result = write_shader_files(request, folder / "aces.glsl", {});
    ASSERT_EQ(result.beside.size(), result.shader.textures.size());
    ASSERT_FALSE(result.beside.empty());
    EXPECT_EQ(read(result.beside[0]).size(), 4 * result.shader.textures[0].rgba.size());
    EXPECT_EQ(folder.files().size(), result.beside.size() + 1);
    EXPECT_NE(error_of([&] {
                  (void)write_shader_files(request, "", {});
              }).find("reads the file tw_aces_20"),
              std::string::npos);
}

TEST(ShaderFiles, CodeValuesForAnApplicationThatEncodesAreSaid) {
    const auto warnings_of = [](const char* application, const char* display) {
        std::vector<std::string> warnings;
        ShaderRequest request;
        request.application = &find_shader_application(application);
        request.view = make_view(resolve_operator("hable"), "lin_rec709", 0, display);
        (void)write_shader_files(
            request, "", {.warn = [&](const std::string& line) { warnings.push_back(line); }});
        return warnings;
    };
    ASSERT_EQ(warnings_of("filament", "srgb").size(), 1U);
    EXPECT_EQ(warnings_of("filament", "srgb")[0],
              "Filament encodes its picture, so code values of srgb are encoded twice");
    EXPECT_TRUE(warnings_of("filament", "linear").empty());
    EXPECT_TRUE(warnings_of("nuke", "srgb").empty()) << "with OpenColorIO, Nuke encodes nothing";
}

TEST(ShaderFiles, JavascriptIsTheReference) {
    ShaderRequest request = request_for("hable");
    request.language = ShaderLanguage::javascript;
    EXPECT_TRUE(write_shader_files(request, "", {}).is_double);
}

TEST(ShaderFiles, WarnsBeforeItWrites) {
    const Folder folder;
    const Listener refuses = {.warn = [](const std::string& line) { throw Error(line); }};
    EXPECT_NE(error_of([&] {
                  (void)write_shader_files(request_for("drago"), folder / "drago.glsl", refuses);
              }).find("measures each picture"),
              std::string::npos);
    EXPECT_TRUE(folder.files().empty());
    EXPECT_EQ(error_of([&] { (void)write_shader_files(request_for("hable"), folder.path(), {}); }),
              "write: " + folder.path() + ": is a folder");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
