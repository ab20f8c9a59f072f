// SPDX-License-Identifier: Apache-2.0
#include "tonewright/expr.h"

#include <gtest/gtest.h>

#include "base/strings.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(Names, NearestNameHelpsWithSlipsOnly) {
    const std::vector<std::string> ids = {"hable", "reinhard", "agx_sobotka"};
    EXPECT_EQ(nearest_name("habel", ids), "hable");
    EXPECT_EQ(nearest_name("Reinhart", ids), "reinhard");
    EXPECT_EQ(nearest_name("agx", ids), "agx_sobotka");
    EXPECT_EQ(nearest_name("xyz", ids), "");
    EXPECT_EQ(nearest_name("foo", {"toe", "ferwerda"}), "") << "two letters of three are no slip";
    EXPECT_EQ(nearest_name("rec709", {"rec2020", "rec1886"}), "") << "other digits, another thing";
    EXPECT_EQ(nearest_name("lin_rec708", {"lin_rec709"}), "lin_rec709");
    EXPECT_EQ(nearest_name("aces2", {"agx", "aces_20"}), "aces_20") << "without its separator";
    EXPECT_EQ(nearest_name("srbg", {"g22", "srgb"}), "srgb") << "letters that changed places";
    EXPECT_EQ(nearest_name("", ids), "");
    EXPECT_EQ(nearest_name(std::string(100000, 'a'), ids), "");
    EXPECT_EQ(join_choices({"a", "b", "c"}), "a, b or c");
}

TEST(Names, AWordOfANameMeansIt) {
    const std::vector<NamedChoice> displays = {{"srgb", {"sRGB", "srgb_rec709_display"}},
                                               {"display_p3", {"Display P3"}},
                                               {"rec1886", {"Rec.1886", "g24_rec709_display"}},
                                               {"p3d65_pq", {"P3-D65 PQ"}}};
    EXPECT_EQ(did_you_mean("P3", displays), "; did you mean display_p3 or p3d65_pq?");
    EXPECT_EQ(did_you_mean("rec709", displays), "; did you mean srgb or rec1886?");
    EXPECT_EQ(did_you_mean("davinci", std::vector<NamedChoice>{{"resolve", {"DaVinci Resolve"}}}),
              "; did you mean resolve?");
    EXPECT_EQ(did_you_mean("crt", displays), "");
}

TEST(Names, AreTheSameInAnyCaseAndWithAnyBetween) {
    for (const char* name :
         {"AgX Punchy", "agx_punchy", "AGX-punchy", " agx  punchy ", "agx - punchy"})
        EXPECT_EQ(folded_name(name), "agx_punchy") << name;
    EXPECT_FALSE(is_same_name("agxpunchy", "agx_punchy"));
    EXPECT_EQ(find_choice("x", "Log_Average", {"mean", "log-average"}), 1U);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
