// SPDX-License-Identifier: Apache-2.0
#include "shader/texture_form.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "expr/nodes.h"
#include "shader/print.h"
#include "shader/program.h"
#include "tonewright/error.h"
#include "unit/shader/requests.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(TextureForm, FilesHoldTheTexelsInTheirOrder) {
    ShaderTexture texture{"nodes", {2, 2, 2}, {}};
    for (int i = 0; i < 8; ++i)
        texture.rgba.insert(texture.rgba.end(), {static_cast<float>(i), 0.5F, 0.25F, 1});
    const std::string cube = grid_form(find_shader_application("resolve"))->contents(texture);
    EXPECT_NE(cube.find("LUT_3D_SIZE 2\n0 0.5 0.25\n1 0.5 0.25\n2 0.5 0.25\n"), std::string::npos);
    const std::string script = grid_form(find_shader_application("unity"))->contents(texture);
    EXPECT_NE(script.find("new Texture3D(2, 2, 2, TextureFormat.RGBAHalf"), std::string::npos);
    // 0, 0.5, 0.25, 1 in half floats.
    EXPECT_NE(script.find("\"AAAAOAA0ADw"), std::string::npos);
    const std::string ktx2 = grid_form(find_shader_application("bevy"))->contents(texture);
    EXPECT_EQ(ktx2.substr(1, 6), "KTX 20");
    EXPECT_EQ(ktx2.substr(ktx2.size() - 64, 8), std::string("\0\0\0\x38\0\x34\0\x3c", 8));
}

TEST(TextureForm, FilesOfTablesHave32BitFloats) {
    const ShaderTexture texture{"tables", {1, 2, 1}, {0, 0.5F, 0.25F, 1, 1, 1, 1, 1}};
    const std::string script = form_of(find_shader_application("unity"), texture).contents(texture);
    EXPECT_NE(script.find("new Texture2D(1, 2, TextureFormat.RGBAFloat, false, false)"),
              std::string::npos)
        << script;
    // 0, 0.5, 0.25, 1 are 0, 0x3F000000, 0x3E800000, 0x3F800000 (IEEE 754), here little-endian.
    EXPECT_NE(script.find("\"AAAAAAAAAD8AAIA+AACAP"), std::string::npos) << script;
    const std::string bytes("\0\0\0\0\0\0\0\x3f\0\0\x80\x3e\0\0\x80\x3f", 16);
    const std::string ktx2 = form_of(find_shader_application("bevy"), texture).contents(texture);
    EXPECT_EQ(ktx2.substr(ktx2.size() - 32, 16), bytes);
    // OpenEXR's channels stand in alphabetical order: A, B, G, R of the first row.
    const std::string exr = form_of(find_shader_application("unreal"), texture).contents(texture);
    const std::string first =
        bytes.substr(12, 4) + bytes.substr(8, 4) + bytes.substr(4, 4) + bytes.substr(0, 4);
    EXPECT_EQ(exr.substr(exr.size() - 40, 16), first);
}

ShaderProgram program_with(const std::vector<Table>& tables) {
    Expr f = Expr::input();
    for (const Table& table : tables)
        f = lookup(std::make_shared<const Table>(table), f);
    return make_program({curve_stage(f)}, {});
}

std::vector<double> line_of(std::size_t count, double slope) {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < count; ++i)
        numbers.push_back(slope * static_cast<double>(i) / static_cast<double>(count));
    return numbers;
}

/// The numbers of one channel from a row on.
std::vector<float> numbers_in(const ShaderTexture& texture, std::size_t channel, int row,
                              std::size_t count) {
    std::vector<float> numbers;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t texel = static_cast<std::size_t>(row * texture.size[0]) + i;
        numbers.push_back(texture.rgba.at(4 * texel + channel));
    }
    return numbers;
}

std::vector<float> floats(const std::vector<double>& numbers) {
    return {numbers.begin(), numbers.end()};
}

TEST(TextureForm, FiveArraysTakeTwoRowsOfOneTexture) {
    const std::vector<double> positions = {0, 0.25, 0.5, 1};
    const ShaderProgram program =
        program_with({{line_of(4, 1), Table::Interpolation::linear, positions},
                      {line_of(4, 2), Table::Interpolation::linear, positions},
                      {line_of(4, 3), Table::Interpolation::linear, positions},
                      {line_of(4, 4)}});
    for (const ShaderApplication& application : shader_applications()) {
        if (!table_form(application)) continue;
        ASSERT_TRUE(grid_form(application)) << application.id;
        const PrintedProgram printed =
            print_program(program, language_for(application), "f", {}, ShaderTables::texture);
        ASSERT_EQ(printed.textures.size(), 1U) << application.id;
        const ShaderTexture& texture = printed.textures.front();
        EXPECT_EQ(texture.name, "f_tables");
        EXPECT_EQ(texture.size, (std::array{4, 2, 1}))
            << application.id << ": equal positions once";
        std::vector<std::vector<float>> arrays;
        for (std::size_t k = 0; k < 5; ++k)
            arrays.push_back(numbers_in(texture, k % 4, static_cast<int>(k / 4), 4));
        for (const std::vector<double>& numbers :
             {positions, line_of(4, 1), line_of(4, 2), line_of(4, 3), line_of(4, 4)})
            EXPECT_EQ(std::count(arrays.begin(), arrays.end(), floats(numbers)), 1);
        EXPECT_EQ(printed.text.find("[4]"), std::string::npos) << printed.text;
        EXPECT_EQ(printed.text.find("f(float3 scene, Texture2D f_tables)") != std::string::npos,
                  application.id == "unreal")
            << printed.text;
    }
}

TEST(TextureForm, LongTablesTakeSeveralRows) {
    const ShaderProgram program = program_with({{line_of(5000, 1)}});
    // Above 4096 numbers, a texture is the default.
    const PrintedProgram printed =
        print_program(program, language_for(find_shader_application("mpv")), "f", {});
    ASSERT_EQ(printed.textures.size(), 1U);
    EXPECT_EQ(printed.textures[0].size, (std::array{2048, 3, 1}));
    EXPECT_EQ(numbers_in(printed.textures[0], 0, 0, 5000), floats(line_of(5000, 1)));
    EXPECT_NE(
        printed.text.find("ivec2((cell + 1) - 2048 * ((cell + 1) / 2048), (cell + 1) / 2048)"),
        std::string::npos)
        << printed.text;
    const PrintedProgram in_babylon =
        print_program(program, language_for(find_shader_application("babylon")), "f", {});
    EXPECT_EQ(in_babylon.textures[0].size, (std::array{256, 20, 1})) << "a volume";
}

TEST(TextureForm, TablesOfAces20) {
    ShaderRequest request = request_of("aces_20");
    const ShaderErrors not_needed;
    const auto has_array = [](const Shader& shader) {
        return shader.text.find("[361]") != std::string::npos ||
               shader.text.find("f32, 361>") != std::string::npos;
    };
    for (const ShaderApplication& application : shader_applications()) {
        request.application = &application;
        request.tables = ShaderTables::by_size;
        EXPECT_TRUE(has_array(write_shader(request, &not_needed))) << application.id;
        request.tables = ShaderTables::texture;
        if (table_form(application)) {
            const Shader shader = write_shader(request, &not_needed);
            EXPECT_FALSE(has_array(shader)) << application.id;
            EXPECT_NE(shader.text.find("// tw_aces_20_tables: 361 x 2 texels") == std::string::npos,
                      application.id != "babylon");
            continue;
        }
        try {
            (void)write_shader(request, &not_needed);
            FAIL() << application.id;
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find("expected array: no texture of 32-bit floats is "
                                                 "possible there"),
                      std::string::npos)
                << application.id << ": " << e.what();
        }
    }
}

TEST(TextureForm, BabylonHasATextureForGridOrTables) {
    const auto grid = std::make_shared<const Grid>(2, [] { return std::vector<double>(24, 0.5); });
    Pipeline pipeline = {GridStage{Expr::input(), grid}};
    pipeline.push_back(
        curve_stage(lookup(std::make_shared<const Table>(Table{line_of(8, 1)}), Expr::input())));
    const ShaderProgram program = make_program(pipeline, {});
    const auto print = [&](const char* application) {
        return print_program(program, language_for(find_shader_application(application)), "f", {},
                             ShaderTables::texture);
    };
    EXPECT_EQ(print("threejs").textures.size(), 2U);
    EXPECT_THROW((void)print("babylon"), Error);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
