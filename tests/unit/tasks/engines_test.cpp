// SPDX-License-Identifier: Apache-2.0
#include "tasks/engines.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <sstream>
#include <string>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(EnginesLists, DistancesAreAMetric) {
    const MeaningTable table = meaning_table("Filmic");
    ASSERT_GE(table.meanings.size(), 5U);
    ASSERT_EQ(table.distances.size(), table.meanings.size());
    for (std::size_t i = 0; i < table.meanings.size(); ++i) {
        EXPECT_EQ(table.distances[i][i], 0);
        for (std::size_t j = 0; j < i; ++j) {
            EXPECT_EQ(table.distances[i][j], table.distances[j][i]);
            EXPECT_GT(table.distances[i][j], 1) << table.meanings[i].op << table.meanings[j].op;
        }
    }
}

TEST(EnginesLists, AMeaningTableAsText) {
    MeaningTable table{"Aces", {{"a", {"X One", "Y Two"}}, {"bb", {"Z Three"}}}, {}};
    table.distances = {{0, 12.34}, {12.34, 0}};
    EXPECT_EQ(to_text(table),
              "  mean difference in 8-bit steps     1    2\n"
              "  1 a                              0.0   12\n"
              "      X One, Y Two\n"
              "  2 bb                              12  0.0\n"
              "      Z Three");
    EXPECT_EQ(to_json(table).dump(),
              R"({"name":"Aces","meanings":[{"operator":"a","uses":["X One","Y Two"]},)"
              R"({"operator":"bb","uses":["Z Three"]}],"distances":[[0.0,12.34],[12.34,0.0]]})");
    table = {"Photographic", {{"a", {"X One"}}}, {{0}}};
    EXPECT_EQ(to_text(table), "  a\n      X One") << "one meaning has no distances";
}

TEST(EnginesLists, ARowAsJson) {
    const EngineToneMapper row = {.program = "X",
                                  .version = "1.2",
                                  .package = "x@1.2",
                                  .name = "Tone",
                                  .names = {"T"},
                                  .verdict = EngineToneMapper::Verdict::nearest,
                                  .op = "hable",
                                  .order = "curve",
                                  .difference = 0.5,
                                  .unit = "display-linear",
                                  .is_clamped = true,
                                  .display = "linear",
                                  .measured = "2026-11-28",
                                  .note = ""};
    EXPECT_EQ(to_json(row).dump(),
              R"({"engine":"X","version":"1.2","package":"x@1.2","name":"Tone","names":["T"],)"
              R"("operator":"hable","order":"curve","verdict":"nearest","difference":0.5,)"
              R"("unit":"display-linear","compared":"clamped to [0, 1]","display":"linear",)"
              R"("measured":"2026-11-28","note":""})");
}

TEST(EnginesLists, TextFitsTerminals) {
    std::istringstream lines(engines_as_text());
    std::string line;
    std::size_t rows = 0;
    while (std::getline(lines, line)) {
        EXPECT_LE(line.size(), 120U) << line;
        rows += line.find(" equal ") != std::string::npos ? 1U : 0U;
    }
    EXPECT_GE(rows, 70U);
}

TEST(EnginesLists, MarkdownHasEveryRow) {
    const std::string text = engines_as_markdown();
    for (const EngineToneMapper& row : engine_tone_mappers())
        EXPECT_NE(text.find("| `" + row.name + "` |"), std::string::npos) << row.name;
    EXPECT_EQ(meaning_tables().size(), ambiguous_names().size());
    EXPECT_NE(text.find("### \"ACES\"\n"), std::string::npos);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
