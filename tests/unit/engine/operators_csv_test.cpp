// SPDX-License-Identifier: Apache-2.0
//
// The reference engine against independent numbers: tests/data/operators.csv, see the README beside
// it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>

#include "base/format_number.h"
#include "resolve_any.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr const char* kFile = TONEWRIGHT_TEST_DATA "/operators.csv";
constexpr const char* kHeader =
    "operator,settings,look,output,input,in_r,in_g,in_b,out_r,out_g,out_b,tolerance,origin";

struct Row {
    int line = 0;
    std::string op;
    Settings settings;
    std::string look;
    std::string output;
    std::string input;
    Vector3 in{};
    Vector3 expected{};
    double tolerance = 0;
    std::string origin;
    /// Reads a file that is no part of the repository, and is not here.
    bool needs_shared = false;
};

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    std::size_t begin = 0;
    for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
        end = text.find(separator, begin);
        parts.push_back(text.substr(begin, end == std::string::npos ? end : end - begin));
    }
    return parts;
}

double number(const std::string& text, int line) {
    double value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc() || result.ptr != text.data() + text.size()) {
        throw Error("line " + std::to_string(line) + ": `" + text + "` is no number");
    }
    return value;
}

/// Makes a `file=` of the table a path that opens here; false when its folder is not at hand.
bool find_file(std::string& file) {
    constexpr std::string_view kShared = "$TONEWRIGHT_SHARED/";
    if (!file.starts_with(kShared)) {
        file = std::string(TONEWRIGHT_TEST_DATA) + "/" + file;
        return true;
    }
    const char* shared = std::getenv("TONEWRIGHT_SHARED");
    if (!shared) return false;
    file = std::string(shared) + "/" + file.substr(kShared.size());
    return true;
}

/// @throws Error  when the file is not what README.md says.
std::vector<Row> read_rows() {
    std::ifstream file(kFile);
    std::string text;
    if (!std::getline(file, text) || text != kHeader)
        throw Error(std::string(kFile) + ": expected the header " + kHeader);
    std::vector<Row> rows;
    for (int line = 2; std::getline(file, text); ++line) {
        const std::vector<std::string> field = split(text, ',');
        if (field.size() != 13)
            throw Error("line " + std::to_string(line) + ": expected 13 fields");
        Row row;
        row.line = line;
        row.op = field[0];
        if (!field[1].empty()) {
            for (const std::string& setting : split(field[1], ';')) {
                const std::size_t equals = setting.find('=');
                if (equals == std::string::npos)
                    throw Error("line " + std::to_string(line) + ": expected name=value");
                row.settings[setting.substr(0, equals)] = setting.substr(equals + 1);
                if (setting.starts_with("file="))
                    row.needs_shared = !find_file(row.settings["file"]);
            }
        }
        row.look = field[2];
        row.output = field[3];
        row.input = field[4];
        for (std::size_t c = 0; c < 3; ++c) {
            row.in[c] = number(field[5 + c], line);
            row.expected[c] = number(field[8 + c], line);
        }
        row.tolerance = number(field[11], line);
        row.origin = field[12];
        rows.push_back(std::move(row));
    }
    return rows;
}

const std::vector<Row>& rows() {
    static const std::vector<Row> all = [] {
        try {
            return read_rows();
        } catch (const Error& e) {
            ADD_FAILURE() << e.what();
            return std::vector<Row>{};
        }
    }();
    return all;
}

std::vector<std::string> registry_ids() {
    std::vector<std::string> ids;
    for (const Operator& op : all_operators())
        ids.push_back(op.id);
    for (const Operator& defect : known_defects())
        ids.push_back(defect.id);
    return ids;
}

std::string label(const Row& row) {
    std::string text = row.op;
    for (const auto& [name, value] : row.settings)
        text += " " + name + "=" + value;
    if (!row.look.empty()) text += " look=" + row.look;
    return text + " " + row.output + " of " + row.input + " (" + shortest(row.in[0]) + ", " +
           shortest(row.in[1]) + ", " + shortest(row.in[2]) + ")";
}

class OperatorsCsv : public ::testing::TestWithParam<std::string> {};

TEST_P(OperatorsCsv, HasTheExpectedValues) {
    int row_count = 0;
    int failed = 0;
    double worst = 0;
    int skipped = 0;
    for (const Row& row : rows()) {
        if (row.op != GetParam()) continue;
        if (row.needs_shared) {
            ++skipped;
            continue;
        }
        ++row_count;
        const View view =
            make_view(resolve_any(row.op, row.settings, row.look), row.input, 0, row.output);
        const Vector3 actual = ReferenceEngine(build_view(view))(row.in);
        for (std::size_t c = 0; c < 3; ++c) {
            const double error = std::fabs(actual[c] - row.expected[c]);
            // Relative; below a thousandth the absolute error counts.
            const double allowed = row.tolerance * std::max(std::fabs(row.expected[c]), 0.001);
            worst = std::max(worst, error / allowed);
            if (error <= allowed) continue;  // a NaN is not
            ++failed;
            ADD_FAILURE() << "line " << row.line << ": " << label(row) << ", channel " << c << ": "
                          << shortest(actual[c]) << ", expected " << shortest(row.expected[c])
                          << ", error " << error << ", " << error / allowed
                          << " times the tolerance\n  expected value from: " << row.origin;
        }
    }
    EXPECT_GT(row_count, 0) << "no row of tests/data/operators.csv for " << GetParam();
    if (skipped > 0) {
        std::printf("%s: %d rows skipped: TONEWRIGHT_SHARED, the folder of their files, is unset\n",
                    GetParam().c_str(), skipped);
    }
    RecordProperty("rows", row_count);
    RecordProperty("worst_error_over_tolerance", shortest(worst));
    std::printf("%s: %d rows, %d channels failed, worst error %.3g times the tolerance\n",
                GetParam().c_str(), row_count, failed, worst);
}

INSTANTIATE_TEST_SUITE_P(Operators, OperatorsCsv, ::testing::ValuesIn(registry_ids()),
                         [](const auto& test) { return test.param; });

TEST(OperatorsCsvFile, NamesOperatorsOfTheRegistryOnly) {
    const std::vector<std::string> ids = registry_ids();
    ASSERT_FALSE(rows().empty());
    for (const Row& row : rows()) {
        EXPECT_TRUE(std::find(ids.begin(), ids.end(), row.op) != ids.end())
            << "line " << row.line << ": " << row.op << " is no operator";
    }
}

TEST(OperatorsCsvFile, RowsSayWhereTheirNumbersComeFrom) {
    std::set<std::string> seen;
    for (const Row& row : rows()) {
        EXPECT_FALSE(row.origin.empty()) << "line " << row.line;
        EXPECT_EQ(row.origin.find("tonewright"), std::string::npos)
            << "line " << row.line << ": no value comes from this program";
        EXPECT_TRUE(row.output == "native" || row.output == "linear") << "line " << row.line;
        EXPECT_TRUE(row.tolerance > 0 && std::isfinite(row.tolerance)) << "line " << row.line;
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_TRUE(std::isfinite(row.in[c]) && std::isfinite(row.expected[c])) << row.line;
        EXPECT_TRUE(seen.insert(label(row) + row.origin).second)
            << "line " << row.line << ": twice from the same source";
    }
}

/// Rows that reference/style.md requires for a new operator.
TEST(OperatorsCsvFile, EveryOperatorHasTheRowsThatFindMistakes) {
    for (const std::string& id : registry_ids()) {
        bool black = false;
        bool mid_gray = false;
        bool bright = false;
        bool saturated = false;
        bool negative = false;
        for (const Row& row : rows()) {
            if (row.op != id) continue;
            const auto [lo, hi] = std::minmax({row.in[0], row.in[1], row.in[2]});
            black = black || (lo == 0 && hi == 0);
            mid_gray = mid_gray || (lo == 0.18 && hi == 0.18);
            bright = bright || hi >= 16;
            saturated = saturated || (lo > 0 && hi > 8 * lo);
            negative = negative || lo < 0;
        }
        EXPECT_TRUE(black) << id;
        EXPECT_TRUE(mid_gray) << id;
        EXPECT_TRUE(bright) << id;
        EXPECT_TRUE(saturated) << id;
        EXPECT_TRUE(negative) << id;
    }
}

TEST(OperatorsCsvFile, EveryPresetAndLookHasRows) {
    for (const Operator& op : all_operators()) {
        const auto has_row = [&](const Settings& settings, const std::string& look) {
            return std::any_of(rows().begin(), rows().end(), [&](const Row& row) {
                if (row.op != op.id || row.look != look) return false;
                return std::all_of(settings.begin(), settings.end(), [&](const auto& setting) {
                    const auto it = row.settings.find(setting.first);
                    return it != row.settings.end() && it->second == setting.second;
                });
            });
        };
        EXPECT_TRUE(has_row({}, "")) << op.id;
        for (const Preset& preset : op.presets)
            EXPECT_TRUE(has_row(preset.settings, "")) << op.id << ":" << preset.id;
        for (const Look& look : op.looks)
            EXPECT_TRUE(has_row({}, look.id)) << op.id << " look " << look.id;
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
