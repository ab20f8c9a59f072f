// SPDX-License-Identifier: Apache-2.0
#include "tonewright/lint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tonewright/error.h"
#include "unit/lut/lut_cases.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// Without a fault, as in tests/cli/test_lint.py, which has one for every finding.
const std::string kGood = R"(ocio_profile_version: 2.1
search_path: luts
strictparsing: true
environment: {}
roles: {scene_linear: lin, default: lin, aces_interchange: aces, cie_xyz_d65_interchange: xyz, data: raw,
        color_picking: sRGB, texture_paint: sRGB, default_byte: sRGB, default_float: lin, default_sequencer: sRGB,
        compositing_log: lin}
file_rules:
  - !<Rule> {name: Default, colorspace: lin}
displays:
  sRGB:
    - !<View> {name: Plain, view_transform: plain, display_colorspace: sRGB}
    - !<View> {name: Raw, colorspace: raw}
active_displays: [sRGB]
active_views: [Plain, Raw]
inactive_colorspaces: []
default_view_transform: plain
view_transforms:
  - !<ViewTransform>
    name: plain
    from_scene_reference: !<RangeTransform> {min_in_value: 0, min_out_value: 0, max_in_value: 1, max_out_value: 1}
display_colorspaces:
  - !<ColorSpace> {name: xyz, encoding: display-linear}
  - !<ColorSpace> {name: sRGB, encoding: sdr-video}
colorspaces:
  - !<ColorSpace> {name: lin, aliases: [Linear], encoding: scene-linear}
  - !<ColorSpace> {name: aces, encoding: scene-linear}
  - !<ColorSpace> {name: raw, isdata: true, encoding: data}
)";

std::vector<LintFinding> lint(const std::string& old, const std::string& changed) {
    const Folder folder;
    std::string text = kGood;
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
