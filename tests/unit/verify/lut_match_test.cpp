// SPDX-License-Identifier: Apache-2.0
#include "tonewright/lut_match.h"

#include <gtest/gtest.h>

#include <vector>

#include "tonewright/lut_file.h"
#include "unit/folder.h"
#include "unit/lut/lut_cases.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

LutFile file_of(const Folder& folder, const LutRequest& request) {
    const Lut lut = sample_lut(request);
    write(folder / "a.cube", write_lut(lut, request, {}));
    return LutFile(folder / "a.cube");
}

TEST(LutMatch, FindsTheOperatorItsEncodingAndItsDisplay) {
    const Folder folder;
    const LutFile lut = file_of(folder, request_for("hable", "log2", LutFormat::cube, 33));
    const std::vector<LutMatch> matches =
        match_lut(lut, resolve_operators({"hable", "reinhard", "aces_narkowicz"}), 2);
    ASSERT_EQ(matches.size(), 2U);
    EXPECT_EQ(matches[0].op, "hable");
    EXPECT_EQ(matches[0].encoding, "log2:-10:6.5");
    EXPECT_EQ(matches[0].display, "srgb");
    ASSERT_NE(matches[0].definition, nullptr);
    EXPECT_EQ(matches[0].definition->id, "hable");
    EXPECT_LE(matches[0].p999, matches[1].p999) << "the nearest first";
    // 33 nodes of 16.5 stops are half a stop apart. The second derivative of a curve in codes is
    // below 0.1 a stop^2, so that a straight line errs by at most 0.1/8 0.52^2.
    EXPECT_LT(matches[0].p999, 0.004);
    EXPECT_GT(matches[0].p999, 1e-6) << "measured, not assumed";
    // Reinhard and Narkowicz show 0.18 at codes 0.05 and more away.
    EXPECT_GT(matches[1].p999, 0.02) << matches[1].op;
}

TEST(LutMatch, FindsAPlainClamp) {
    const Folder folder;
    const LutFile lut = file_of(folder, request_for("clamp", "srgb", LutFormat::cube, 17));
    EXPECT_EQ(match_lut(lut, {resolve_operator("clamp")}, 1).at(0).op, "clamp");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
