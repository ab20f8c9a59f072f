// SPDX-License-Identifier: Apache-2.0
#include "tonewright/pipeline.h"

#include <gtest/gtest.h>

#include <set>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(DocumentedDifferences, SayWhatTheUserSees) {
    using Kind = DocumentedDifference::Kind;
    const auto text = [](Kind kind, double value, const char* when = "") {
        return to_string(DocumentedDifference{kind, value, when});
    };
    EXPECT_EQ(text(Kind::black, 0.00287), "lifts black to 0.0029");
    EXPECT_EQ(text(Kind::black, -0.0023), "takes black to -0.0023, which displays clip");
    EXPECT_EQ(text(Kind::black, 0, "soft"), "soft: black is 0");
    EXPECT_EQ(text(Kind::crushes_black, 0.004), "shows grays up to 0.004 as black");
    EXPECT_EQ(text(Kind::never_reaches_white, 0.9826),
              "never reaches white: at most 0.983 of display white");
    EXPECT_EQ(text(Kind::exceeds_white, 1.287), "exceeds white, up to 1.29; SDR displays clip it");
    EXPECT_EQ(text(Kind::exceeds_white, kInfinity),
              "exceeds white without limit; SDR displays clip it");
    EXPECT_EQ(text(Kind::not_monotone, 0.0044), "non-monotone below 0.0044");
    EXPECT_EQ(text(Kind::not_monotone, kInfinity), "non-monotone");
    EXPECT_EQ(text(Kind::tints_gray, 0.0574), "tints gray: its channels differ by up to 0.057");
    EXPECT_EQ(text(Kind::jumps, 0.00104), "jumps by 0.001 from one gray to the next");
    EXPECT_EQ(text(Kind::exceeds_white, 10, "hdr"),
              "hdr: exceeds white, up to 10; SDR displays clip it");
}

TEST(DocumentedDifferences, EveryKindHasAName) {
    using Kind = DocumentedDifference::Kind;
    const std::vector<std::string>& names = difference_names();
    ASSERT_EQ(names.size(), static_cast<std::size_t>(Kind::jumps) + 1);
    EXPECT_EQ(names[static_cast<std::size_t>(Kind::black)], "black");
    EXPECT_EQ(names[static_cast<std::size_t>(Kind::exceeds_white)], "exceeds_white");
    EXPECT_EQ(names[static_cast<std::size_t>(Kind::jumps)], "jumps");
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
