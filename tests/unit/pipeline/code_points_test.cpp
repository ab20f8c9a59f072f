// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <set>

#include "tonewright/engine.h"
#include "tonewright/source_color.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// ITU-T H.273 (07/2021), tables 2 and 3: values that are neither reserved nor unspecified.
const std::set<int> kPrimariesOfTable2 = {1, 4, 5, 6, 7, 8, 9, 10, 11, 12, 22};
const std::set<int> kTransfersOfTable3 = {1, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18};

TEST(CodePoints, EveryPairOfTheTablesHasAColor) {
    for (int primaries = -1; primaries <= 256; ++primaries) {
        for (int transfer = -1; transfer <= 256; ++transfer) {
            const bool is_known =
                kPrimariesOfTable2.count(primaries) > 0 && kTransfersOfTable3.count(transfer) > 0;
            ASSERT_EQ(color_of_code_points(primaries, transfer).has_value(), is_known)
                << primaries << "/" << transfer;
        }
    }
}

TEST(CodePoints, NamesAreThoseOfDisplaysAndSpaces) {
    const auto name = [](int primaries, int transfer) {
        return color_of_code_points(primaries, transfer)->name;
    };
    EXPECT_EQ(name(1, 13), "sRGB");
    EXPECT_EQ(name(12, 13), "Display P3");
    EXPECT_EQ(name(9, 16), "Rec.2100-PQ");
    EXPECT_EQ(name(9, 18), "Rec.2100-HLG");
    EXPECT_EQ(name(12, 16), "P3-D65 PQ");
    EXPECT_EQ(name(1, 1), "Rec.1886");
    EXPECT_EQ(name(9, 14), "Rec.2020");
    EXPECT_EQ(name(1, 8), "lin_rec709");
    EXPECT_EQ(name(9, 8), "lin_rec2020");
    EXPECT_EQ(name(10, 8), "lin_ciexyzd65_scene");
    EXPECT_EQ(name(9, 13), "cicp:9/13");
    EXPECT_EQ(name(1, 16), "cicp:1/16");
}

/// A cache may compare names, so each name must find one color.
TEST(CodePoints, NamesFindTheSameColor) {
    const Vector3 codes = {0.9, 0.3, 0.05};
    for (const int primaries : kPrimariesOfTable2) {
        for (const int transfer : kTransfersOfTable3) {
            const SourceColor color = *color_of_code_points(primaries, transfer);
            const SourceColor again = find_source_color(color.name);
            EXPECT_EQ(again.name, color.name);
            EXPECT_EQ(again.primaries, color.primaries) << color.name;
            EXPECT_EQ(again.is_absolute, color.is_absolute) << color.name;
            EXPECT_EQ(again.is_absolute, transfer == 16 || transfer == 18) << color.name;
            EXPECT_EQ(ReferenceEngine(again.decode)(codes), ReferenceEngine(color.decode)(codes))
                << color.name;
        }
    }
}

TEST(CodePoints, MessagesNameBoth) {
    EXPECT_EQ(code_point_names(9, 16), "BT.2020 / PQ");
    EXPECT_EQ(code_point_names(2, 13), "unspecified / sRGB");
    EXPECT_EQ(code_point_names(3, 19), "reserved 3 / reserved 19");
    EXPECT_EQ(code_point_names(22, 7), "EBU 3213-E / SMPTE 240M");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
