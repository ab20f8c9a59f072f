// SPDX-License-Identifier: Apache-2.0
#include "tasks/verify.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tasks/config.h"
#include "tonewright/registry.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

VerifyRequest quick_request() {
    VerifyRequest request = {.is_quick = true, .has_lint = true};
    request.options.with_gpu = false;
    request.options.only_best_target = true;
    return request;
}

TEST(VerifyTask, RowsComeAsTheyAreMeasured) {
    VerifyRequest request = quick_request();
    request.options.operators = {resolve_operator("hable")};
    std::vector<std::string> backends;
    const VerifyResult result =
        verify(request, {.on_row = [&](const ParityRow& row) { backends.push_back(row.backend); }});
    EXPECT_FALSE(result.lint);
    EXPECT_TRUE(result.is_ok);
    EXPECT_EQ(result.failed, 0U);
    ASSERT_FALSE(backends.empty());
    ASSERT_EQ(backends.size(), result.rows.size());
    EXPECT_TRUE(backends.front().starts_with("simd"));
    // An error at the first row leaves the others unmeasured.
    int rows = 0;
    EXPECT_THROW((void)verify(request, {.on_row =
                                            [&](const ParityRow&) {
                                                ++rows;
                                                throw Error("enough");
                                            }}),
                 Error);
    EXPECT_EQ(rows, 1);
}

TEST(VerifyTask, ConfigIsCheckedBeforeItsViews) {
    const Folder folder;
    ConfigRequest config;
    config.options.views = {"hable"};
    config.options.displays = {"srgb"};
    config.folder = folder / "config";
    ASSERT_EQ(write_config(config, {}).size(), 1U);
    VerifyRequest request = quick_request();
    request.options.config = config.folder;
    std::vector<std::string> order;
    const VerifyListener listener = {.on_lint = [&](const auto&) { order.push_back("lint"); },
                                     .on_row = [&](const ParityRow&) { order.push_back("row"); }};
    const VerifyResult result = verify(request, listener);
    ASSERT_TRUE(result.lint);
    EXPECT_TRUE(result.is_ok);
    ASSERT_GT(order.size(), 1U);
    EXPECT_EQ(order[0], "lint");
    EXPECT_EQ(order[1], "row");
    request.has_lint = false;
    EXPECT_FALSE(verify(request).lint);
}

TEST(VerifyTask, DefectNeedsACloserMatch) {
    const Operator& op = find_operator("hable");
    LutMatch match;
    match.definition = &op;
    match.mean = 0.009;
    EXPECT_TRUE(is_same(match));
    match.definition = &known_defects().front();
    EXPECT_FALSE(is_same(match));
    match.mean = 0.003;
    EXPECT_TRUE(is_same(match));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
