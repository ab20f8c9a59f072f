// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "tonewright/engines.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Verdict = EngineToneMapper::Verdict;

std::string title_of(const EngineToneMapper& row) {
    return row.program + " " + row.version + " " + row.name;
}

TEST(EnginesTable, EveryOperatorResolves) {
    for (const EngineToneMapper& row : engine_tone_mappers()) {
        if (!row.op.empty()) {
            EXPECT_NO_THROW((void)resolve_operator(row.op)) << title_of(row);
        }
    }
}

TEST(EnginesTable, RowsAreComplete) {
    std::set<std::string> titles;
    for (const EngineToneMapper& row : engine_tone_mappers()) {
        const std::string title = title_of(row);
        EXPECT_TRUE(titles.insert(title).second) << title;
        EXPECT_FALSE(row.order.empty()) << title;
        EXPECT_EQ(row.measured.size(), std::string("2026-11-28").size()) << title;
        if (row.display != kLinearOutput && row.display != kNativeOutput) {
            EXPECT_EQ(find_display(row.display).id, row.display) << title;
        }
        if (row.verdict == Verdict::none) {
            EXPECT_TRUE(row.op.empty()) << title;
            EXPECT_FALSE(row.note.empty()) << title << ": the reason";
        } else {
            EXPECT_FALSE(row.op.empty()) << title;
            EXPECT_TRUE(row.difference.has_value()) << title;
        }
    }
}

/// Equal means within 1e-6, or within what the note says about the program's own rounding.
TEST(EnginesTable, VerdictsFollowTheDifferences) {
    for (const EngineToneMapper& row : engine_tone_mappers()) {
        if (row.verdict == Verdict::equal && *row.difference > 1e-6) {
            EXPECT_FALSE(row.note.empty()) << title_of(row);
        }
        // The rounding of an 8-bit picture, in 8-bit codes; of floats, the polynomial of AgX.
        if (row.verdict == Verdict::equal) {
            EXPECT_LE(*row.difference, row.unit == "8-bit codes" ? 0.51 : 2e-5) << title_of(row);
        }
    }
}

/// The numbers that the project promises.
TEST(EnginesTable, IsLargeEnough) {
    const std::vector<EngineToneMapper>& rows = engine_tone_mappers();
    std::set<std::string> programs;
    for (const EngineToneMapper& row : rows)
        programs.insert(row.program);
    EXPECT_GE(rows.size(), 90U);
    EXPECT_GE(programs.size(), 24U);
    EXPECT_GE(
        std::count_if(rows.begin(), rows.end(),
                      [](const EngineToneMapper& row) { return row.verdict == Verdict::equal; }),
        70);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
