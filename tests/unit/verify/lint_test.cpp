// SPDX-License-Identifier: Apache-2.0
#include "tonewright/lint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tonewright/error.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Findings of a config without a fault, after a change. tests/cli/test_lint.py has one for every
/// finding.
std::vector<LintFinding> lint(const std::string& old, const std::string& changed) {
    const Folder folder;
    std::string text = read(TONEWRIGHT_TEST_DATA "/good_config.ocio");
    if (!old.empty()) {
        EXPECT_NE(text.find(old), std::string::npos);
        text.replace(text.find(old), old.size(), changed);
    }
    write(folder / "config.ocio", text);
    return lint_config(folder / "config.ocio", false);
}

bool has(const std::vector<LintFinding>& all, LintFinding::Level level, const std::string& where,
         const std::string& words) {
    return std::any_of(all.begin(), all.end(), [&](const LintFinding& f) {
        return f.level == level && f.where == where && f.what.find(words) != std::string::npos;
    });
}

TEST(Lint, AConfigWithoutAFaultHasNoFindings) { EXPECT_TRUE(lint("", "").empty()); }

TEST(Lint, FindingsHaveTheirLevelAndPlace) {
    using Level = LintFinding::Level;
    EXPECT_TRUE(has(lint("scene_linear: lin, ", ""), Level::error, "role scene_linear", "missing"));
    EXPECT_TRUE(has(lint(" data: raw,", ""), Level::warning, "role data", "Blender"));
    EXPECT_TRUE(has(lint(", encoding: display-linear", ""), Level::note, "space xyz", "encoding"));
    EXPECT_TRUE(has(
        lint("{name: aces, encoding: scene-linear}",
             "{name: aces, encoding: log, to_scene_reference: !<FileTransform> {src: gone.clf}}"),
        Level::error, "space aces", "gone.clf"));
    // A matrix alone passes NaN on.
    EXPECT_TRUE(
        has(lint("!<RangeTransform> {min_in_value: 0, min_out_value: 0, max_in_value: 1, "
                 "max_out_value: 1}",
                 "!<MatrixTransform> {matrix: [2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}"),
            Level::warning, "view sRGB / Plain", "NaN"));
}

TEST(Lint, WhatIsNoConfigIsAnError) {
    EXPECT_THROW((void)lint_config("/nonexistent/config.ocio", false), FileError);
    const Folder folder;
    write(folder / "config.ocio", "no config");
    EXPECT_THROW((void)lint_config(folder / "config.ocio", false), FileError);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
