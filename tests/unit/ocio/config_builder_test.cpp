// SPDX-License-Identifier: Apache-2.0
#include "ocio/config_builder.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::vector<DisplayedView> shown(const std::string& op, const std::vector<std::string>& displays) {
    ConfigModel::View view;
    view.name = "V";
    view.op = resolve_operator(op);
    std::vector<const Display*> all;
    for (const std::string& id : displays)
        all.push_back(&find_display(id));
    return displayed_views(view, all);
}

TEST(DisplayedViews, DisplaysOfTheSameLightShareATransform) {
    // sRGB and a 2.2 display have one gamut and one peak, so that one transform serves both.
    const auto sdr = shown("agx_blender", {"srgb", "g22"});
    ASSERT_EQ(sdr.size(), 2U);
    EXPECT_EQ(sdr[0].transform, sdr[1].transform);
    EXPECT_EQ(sdr[0].name, "V");
    // ACES 2.0 limits to the gamut and to the peak of the display.
    const auto wide = shown("aces_20", {"srgb", "display_p3", "rec2100_pq"});
    ASSERT_EQ(wide.size(), 3U);
    std::set<std::string> transforms;
    for (const DisplayedView& view : wide)
        transforms.insert(view.transform);
    EXPECT_EQ(transforms.size(), 3U);
    EXPECT_NE(wide[2].name.find("nits"), std::string::npos)
        << "an HDR version has its peak in its name";
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
