// SPDX-License-Identifier: Apache-2.0
#include "tonewright/definition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tonewright/registry.h"
#include "tonewright/view.h"
#include "unit/definition/definitions.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(LutStage, TakesPathsFromTheFolderOfTheFile) {
    std::string read;
    const auto op = parse_operator(kHead + "[[stage]]\nlut = \"luts/a.cube\"\ninput = \"none\"\n",
                                   "ops/my.tone", [&](const std::string& path) {
                                       read = path;
                                       return small_table(path);
                                   });
    EXPECT_EQ(read, "ops/luts/a.cube");
    const std::array<double, 3> shown = shown_by(built(*op), 0.5, 0.25, 2);
    EXPECT_EQ(shown, (std::array<double, 3>{0.75, 0.875, 0}));  // 1 - table
}

TEST(LutStage, EncodesLightForTheLut) {
    // 0.18 is 10 stops of 16.5 above the lower end, between entries 1 and 2 of the table.
    const double code = 10 / 16.5;
    const double wanted = 1 - (0.25 + (code - 0.5) * 1.5);
    for (const char* text : {"lut = \"a.cube\"\ninput = \"log2\"\n", "lut = \"stated.cube\"\n",
                             "lut = \"a.cube\"\ninput = \"log2\"\nspace = \"lin_ap1\"\n"}) {
        const auto op = parse_operator(kHead + "[[stage]]\n" + text, "my.tone", small_table);
        // Rows of a matrix between primaries of white sum to 1, but for the rounding of white.
        for (const double channel : shown_by(built(*op), 0.18, 0.18, 0.18))
            EXPECT_NEAR(channel, wanted, 1e-6) << text;
    }
}

TEST(LutStage, RefusesUnsupportedFiles) {
    const auto error = [](const std::string& stage) -> std::string {
        try {
            (void)parse_operator(kHead + "[[stage]]\n" + stage, "my.tone", small_table);
        } catch (const DefinitionError& e) {
            return e.what();
        }
        return "no error";
    };
    EXPECT_EQ(error("lut = \"missing.cube\"\ninput = \"none\"\n"),
              "my.tone:4:7: read: missing.cube: gone");
    EXPECT_EQ(error("lut = \"a.cube\"\n").substr(0, 62),
              "my.tone:4:7: the LUT does not say which encoding it expects; e");
    EXPECT_EQ(error("lut = \"my.tone\"\n").substr(0, 46),
              "my.tone:4:7: lut is \"my.tone\"; expected a file");
    EXPECT_EQ(error("lut = 3\n"), "my.tone:4:7: lut is 3; expected text in quotes");
    EXPECT_EQ(error("lut = \"a.cube\"\ninput = \"acesct\"\n").substr(0, 44),
              "my.tone:5:9: input encoding is acesct; expec");
    EXPECT_EQ(error("lut = \"a.cube\"\ninput = \"none\"\nspace = \"lin_ap1\"\n"),
              "my.tone:5:9: space is lin_ap1; expected an input encoding beside it");
}

TEST(LutOperator, HasTheParametersThatTheFileStates) {
    const auto op = load_operator("my luts/Stated Film.cube", small_table);
    EXPECT_EQ(op->id, "stated_film");
    EXPECT_EQ(op->view, "Small");
    // The name has a capital letter: the stub does not take it for a file that states anything.
    EXPECT_NE(resolve(*op, nullptr, {}, "").caution().find("unknown"), std::string::npos);
    const auto stated = load_operator("stated.cube", small_table);
    const ResolvedOperator resolved = resolve(*stated, nullptr, {}, "");
    EXPECT_EQ(resolved.params.text("input"), "log2:-10:6.5");
    EXPECT_EQ(resolved.output_display(), "rec1886");
    EXPECT_EQ(resolved.caution(), "");
    EXPECT_THROW((void)load_operator("stated.cube"), FileError) << "without a reader";
    EXPECT_THROW((void)resolve(*stated, nullptr, {{"output", "paper"}}, ""), Error);
    // The space that the file states belongs to its own encoding.
    const ResolvedOperator slog = resolve(*stated, nullptr, {{"input", "slog3"}}, "");
    EXPECT_TRUE(std::get<MatrixStage>(slog.build()[0]).m ==
                rgb_to_rgb(kRec709, find_input_space("lin_sgamut3").primaries));
}

TEST(LutOperator, IsShownAsItIsOnItsOwnDisplay) {
    const auto op = load_operator("stated.cube", small_table);
    const ResolvedOperator resolved = resolve(*op, nullptr, {}, "");
    const auto on = [&](const char* display) {
        return shown_by(build_view(make_view(resolved, "lin_rec709", 0, display)), 0.1, 0.3, 0.2);
    };
    const std::array<double, 3> code = on("native");
    EXPECT_EQ(on("rec1886"), code);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(on("linear").at(i), std::pow(code.at(i), 2.4), 1e-15);  // ITU-R BT.1886
        EXPECT_NEAR(on("g22").at(i), std::pow(code.at(i), 2.4 / 2.2), 1e-15);
    }
}

TEST(LutOperator, TextsNameFiles) {
    for (const char* text : {"film.cube", "FILM.CUBE:input=acescct", "a.dds output=linear",
                             "dir.lut/film.clf", "my film.exr"}) {
        EXPECT_TRUE(names_a_lut(text)) << text;
    }
    for (const char* text : {"my.tone", "hable:film.cube", "film.cubes", "film.cube/x", "agx"})
        EXPECT_FALSE(names_a_lut(text)) << text;
    EXPECT_EQ(
        resolve_operator("stated.cube:output=linear", {}, {}, OperatorSet(small_table)).output(),
        OutputKind::display_linear);
}

TEST(LutOperator, ExtensionsHaveTheDotAndNameLuts) {
    const std::vector<std::string>& all = table_extensions();
    for (const char* extension : {".cube", ".clf", ".icc", ".png"})
        EXPECT_EQ(std::count(all.begin(), all.end(), extension), 1) << extension;
    EXPECT_EQ(std::count(all.begin(), all.end(), ".tone"), 0);
    for (const std::string& extension : all) {
        EXPECT_EQ(extension[0], '.');
        EXPECT_TRUE(names_a_lut("a b" + extension)) << extension;
        EXPECT_TRUE(names_a_lut("a" + extension + ":input=srgb")) << extension;
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
