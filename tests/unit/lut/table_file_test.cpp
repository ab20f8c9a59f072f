// SPDX-License-Identifier: Apache-2.0
#include "lut/table_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tonewright/engine.h"
#include "tonewright/lut.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(TableFile, KeepsNodesAndEntries) {
    Lut lut;
    lut.size = 3;
    for (int b = 0; b < 3; ++b) {
        for (int g = 0; g < 3; ++g) {
            for (int r = 0; r < 3; ++r) {
                for (const int place : {r * r, 10 + g, 20 - b})
                    lut.values.push_back(static_cast<float>(place));
            }
        }
    }
    const TableFile table = table_file_of(lut, "a.raw");
    EXPECT_EQ(table.description, "3D LUT of 3 x 3 x 3 nodes");
    const Vector3 shown = ReferenceEngine(table.stages)({0.5, 1, 0});
    EXPECT_EQ(shown, (Vector3{1, 12, 20}));
    lut.size = 130;
    EXPECT_THROW((void)table_file_of(lut, "a.raw"), FileError);
}

TEST(TableFile, KeepsTheHalfDomain) {
    std::vector<float> rows;
    for (int i = 0; i < 65536; ++i)
        rows.insert(rows.end(), 3, static_cast<float>(i % 0x8000));  // an even function
    const CurveStage stage = half_tables_of(rows);
    EXPECT_TRUE(stage.is_uniform());
    // 0x3C00 is 1, 0x3C01 the next half float.
    EXPECT_EQ(evaluate(stage.f[0], 1.0), 0x3C00);
    EXPECT_EQ(evaluate(stage.f[0], -1.0), 0x3C00);
    EXPECT_EQ(evaluate(stage.f[0], 1 + 0x1p-11), 0x3C00 + 0.5);
    EXPECT_EQ(evaluate(stage.f[0], 1e9), 0x7BFF);
}

TEST(TableFile, RangesBecomeZeroToOne) {
    Pipeline stages;
    add_range(stages, {0, 0, 0}, {1, 1, 1});
    EXPECT_TRUE(stages.empty());
    add_range(stages, {-1, 0, 0}, {1, 1, 4});
    EXPECT_EQ(ReferenceEngine(stages)({0, 0.25, 1}), (Vector3{0.5, 0.25, 0.25}));
}

TEST(TableReader, ReadsACubeAsItsNodes) {
    const Folder folder;
    // Red fastest: the node at (1, 0, 0) has the value (0.5, 0, 0), so red is halved.
    std::string text = "LUT_3D_SIZE 2\n";
    for (int i = 0; i < 8; ++i)
        text += fmt::format("{} {} {}\n", 0.5 * (i & 1), (i >> 1) & 1, i >> 2);
    write(folder / "a.cube", text);
    const TableReader reader = table_reader();
    const auto shown = [&] {
        return evaluate(compose(reader(folder / "a.cube").stages)[0], std::array{0.5, 0.25, 1.0});
    };
    EXPECT_DOUBLE_EQ(shown(), 0.25);
    EXPECT_NE(reader(folder / "a.cube").description.find("3D LUT"), std::string::npos);
    // A changed file is read again.
    write(folder / "a.cube", "LUT_1D_SIZE 2\n0 0 0\n0.125 1 1\n");
    EXPECT_DOUBLE_EQ(shown(), 0.0625);
    EXPECT_THROW((void)reader(folder / "none.cube"), FileError);
}

TEST(TableReader, PassesOtherFilesOn) {
    std::vector<std::string> asked;
    const TableReader reader = table_reader([&](const std::string& path) {
        asked.push_back(path);
        TableFile table;
        table.description = "of the next reader";
        return table;
    });
    const Folder folder;
    write(folder / "a.spi1d", "Version 1\n");
    EXPECT_EQ(reader(folder / "a.spi1d").description, "of the next reader");
    EXPECT_EQ(asked, std::vector<std::string>{folder / "a.spi1d"});
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
