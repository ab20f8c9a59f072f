// SPDX-License-Identifier: Apache-2.0
#include "tasks/conformance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tonewright/registry.h"
#include "unit/errors.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

ConformanceResult write_kit(const std::string& op, std::string_view display,
                            const std::string& folder, const Listener& listener = {}) {
    return write_conformance_kit(
        {make_view(resolve_operator(op), "lin_rec709", 0, display), folder}, listener);
}

struct Row {
    std::string group;
    std::vector<double> scene, display, in_float, code;
};

std::vector<Row> rows_of(const std::string& table) {
    std::vector<Row> rows;
    std::istringstream lines(table);
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("#") || line.starts_with("group,")) continue;
        std::istringstream cells(line);
        Row row;
        std::getline(cells, row.group, ',');
        for (std::vector<double>* numbers : {&row.scene, &row.display, &row.in_float, &row.code}) {
            for (int i = 0; i < 3; ++i) {
                std::string cell;
                std::getline(cells, cell, ',');
                numbers->push_back(std::strtod(cell.c_str(), nullptr));
            }
        }
        rows.push_back(row);
    }
    return rows;
}

TEST(Conformance, TableHasTheOperatorsColors) {
    const Folder folder;
    const ConformanceResult result = write_kit("reinhard", kLinearOutput, folder.path());
    const std::vector<Row> rows = rows_of(read(folder / "colors.csv"));
    EXPECT_EQ(rows.size(), result.colors);
    std::map<std::string, int> groups;
    for (const Row& row : rows) {
        ++groups[row.group];
        for (std::size_t c = 0; c < 3; ++c) {
            const double x = row.scene[c];
            EXPECT_GE(x, 0);
            EXPECT_EQ(static_cast<double>(static_cast<float>(x)), x) << "exact in float";
            // Reinhard et al. 2002, equation 3. The table has 12 digits.
            EXPECT_NEAR(row.display[c], x / (1 + x), 1e-12);
        }
    }
    EXPECT_EQ(groups["gray"], 49);
    EXPECT_EQ(groups["saturated"], 66);
    EXPECT_EQ(groups.size(), 6U);
}

TEST(Conformance, TolerancesAreErrorsOfCodeValues) {
    const Folder folder;
    const double tolerance = write_kit("reinhard", kLinearOutput, folder / "light").tolerance;
    EXPECT_GE(tolerance, 2e-6);
    EXPECT_LE(tolerance, 1.0 / 1023);
    // IEC 61966-2-1.
    const auto encode = [](double x) {
        return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
    };
    // Three digits in the table; the two parts of the curve are 1e-7 apart where they meet.
    const auto three_digits = [](double x) { return 0.01 * x + 1e-7; };
    for (const Row& row : rows_of(read(folder / "light/colors.csv"))) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double code = encode(row.display[c]);
            EXPECT_NEAR(encode(row.display[c] + row.code[c]) - code, 1.0 / 255,
                        three_digits(1.0 / 255));
            EXPECT_NEAR(encode(row.display[c] + row.in_float[c]) - code, tolerance,
                        three_digits(tolerance));
        }
    }
    (void)write_kit("reinhard", "srgb", folder / "srgb");
    for (const Row& row : rows_of(read(folder / "srgb/colors.csv")))
        EXPECT_NEAR(row.code[0], 1.0 / 255, three_digits(1.0 / 255));
    (void)write_kit("reinhard", "rec2100_pq", folder / "pq");
    for (const Row& row : rows_of(read(folder / "pq/colors.csv")))
        EXPECT_NEAR(row.code[0], 1.0 / 1023, three_digits(1.0 / 1023));
}

TEST(Conformance, OtherTablesHaveTheColorsWhereEnginesDiffer) {
    const Folder folder;
    (void)write_kit("reinhard", kLinearOutput, folder.path());
    for (const Row& row : rows_of(read(folder / "negative.csv")))
        EXPECT_LT(*std::min_element(row.scene.begin(), row.scene.end()), 0);
    int nan = 0;
    int infinite = 0;
    for (const Row& row : rows_of(read(folder / "extremes.csv"))) {
        for (std::size_t c = 0; c < 3; ++c) {
            nan += std::isnan(row.scene[c]) ? 1 : 0;
            infinite += std::isinf(row.scene[c]) ? 1 : 0;
            EXPECT_TRUE(std::isfinite(row.display[c]));
        }
    }
    EXPECT_EQ(nan, 6);
    EXPECT_EQ(infinite, 12);
}

TEST(Conformance, ReadmeNamesTheOperatorAndHasNoPlaceholders) {
    const Folder folder;
    (void)write_kit("hable:gdc", kLinearOutput, folder.path());
    const std::string text = read(folder / "README.md");
    EXPECT_NE(text.find("`hable:gdc`"), std::string::npos);
    EXPECT_NE(text.find("exposure_bias 1"), std::string::npos) << "settings";
    EXPECT_EQ(text.find('@'), std::string::npos) << text.substr(text.find('@'), 40);
    for (const char* file :
         {"run.c", "run_js.mjs", "run_glsl.mjs", "run_hlsl.mjs", "run_wgsl.mjs", "run_results.mjs"})
        EXPECT_FALSE(read(folder / file).empty()) << file;
}

TEST(Conformance, RefusesLocalOperatorsAndWarnsBeforeItWrites) {
    const Folder folder;
    const View local =
        make_view(resolve_picture_operator("reinhard_local"), "lin_rec709", 0, kLinearOutput);
    EXPECT_NE(error_of([&] {
                  (void)write_conformance_kit({local, folder / "kit"}, {});
              }).find("maps each pixel by itself"),
              std::string::npos);
    const Listener refuses = {.warn = [](const std::string& line) { throw Error(line); }};
    EXPECT_NE(error_of([&] {
                  (void)write_kit("drago", kLinearOutput, folder / "kit", refuses);
              }).find("measures each picture"),
              std::string::npos);
    EXPECT_TRUE(folder.files().empty());
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
