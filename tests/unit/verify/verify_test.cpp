// SPDX-License-Identifier: Apache-2.0
#include "tonewright/verify.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

VerifyOptions quick() {
    VerifyOptions options;
    options.operators = {resolve_operator("reinhard")};
    options.gamut_grid_size = 3;
    options.random_count = 200;
    options.with_gpu = false;
    options.only_best_target = true;
    return options;
}

TEST(Verify, EveryBackendIsWithinItsBound) {
    std::vector<std::string> told;
    const std::vector<ParityRow> rows =
        verify(quick(), [&](const ParityRow& row) { told.push_back(row.backend); });
    ASSERT_GE(rows.size(), 3U) << "the engine, and OpenColorIO's lossless and default paths";
    ASSERT_EQ(told.size(), rows.size());
    for (std::size_t i = 0; i < told.size(); ++i) {
        const ParityRow& row = rows[i];
        EXPECT_EQ(told[i], row.backend);
        EXPECT_EQ(row.op, "reinhard");
        EXPECT_EQ(row.display, "srgb");
        EXPECT_TRUE(row.is_ok) << row.backend << " " << row.note;
        EXPECT_TRUE(row.is_total) << row.backend;
        EXPECT_GT(row.bound, 0) << row.backend;
        EXPECT_LE(row.max, row.bound) << row.backend;
        EXPECT_LE(row.mean, row.p999);
        EXPECT_LE(row.p999, row.max);
        EXPECT_LE(row.max, row.max_all);
    }
    EXPECT_EQ(rows[0].backend.find("simd "), 0U);
}

TEST(Verify, RequestsAreChecked) {
    for (const auto& change : std::vector<void (*)(VerifyOptions&)>{
             [](VerifyOptions& o) { o.operators = {resolve_picture_operator("reinhard_local")}; },
             [](VerifyOptions& o) { o.displays = {"srgbb"}; },
             [](VerifyOptions& o) { o.input = "lin_rec710"; },
             [](VerifyOptions& o) { o.config = "/nonexistent/config.ocio"; }}) {
        VerifyOptions options = quick();
        change(options);
        EXPECT_THROW((void)verify(options), Error);
    }
}

TEST(ParityTable, ColumnsStandBelowTheHeading) {
    ParityRow row;
    row.op = "hable";
    row.display = "srgb";
    row.backend = "simd AVX2";
    row.max = 1.25e-7;
    row.bound = 1e-6;
    const std::string heading = parity_heading();
    const std::string line = format_row(row);
    EXPECT_EQ(heading.back(), '\n');
    EXPECT_EQ(heading.find("display"), line.find("srgb"));
    EXPECT_EQ(heading.find("backend"), line.find("simd"));
    const std::size_t end = heading.find("max") + 3;
    EXPECT_EQ(line.substr(end - 7, 7), "1.2e-07") << "to the right";
    EXPECT_NE(line.find("  ok\n"), std::string::npos);
    row.is_ok = false;
    row.note = "worst at 1 0 0";
    EXPECT_NE(format_row(row).find("FAILED, worst at 1 0 0\n"), std::string::npos);
    row.bound = 0;
    row.note = "no OpenGL";
    EXPECT_NE(format_row(row).find("no OpenGL"), std::string::npos) << "a backend that is missing";
    EXPECT_EQ(format_row(row).find("e-"), std::string::npos) << "has no numbers";
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
