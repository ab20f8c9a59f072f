// SPDX-License-Identifier: Apache-2.0
#include "ocio/newer_profile.h"

#include <OpenColorIO/OpenColorIO.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace OCIO = OCIO_NAMESPACE;

std::string config_of(const std::string& version, const std::string& transform) {
    return "ocio_profile_version: " + version + R"(
roles: {default: raw, scene_linear: raw}
file_rules:
  - !<Rule> {name: Default, colorspace: raw}
displays:
  a:
    - !<View> {name: Raw, colorspace: raw}
colorspaces:
  - !<ColorSpace> {name: raw, isdata: true, interop_id: data}
  - !<ColorSpace> {name: newer, from_scene_reference: )" +
           transform + "}\n";
}

TEST(NewerProfile, OlderOnesStayAsTheyAre) {
    for (const char* version : {"1", "2", "2.0", "2.1"})
        EXPECT_FALSE(make_readable(config_of(version, "!<MatrixTransform> {}"))) << version;
    for (const char* text : {"", "a: [", "- 1", "a: 1\n"})
        EXPECT_FALSE(make_readable(text)) << text;
}

TEST(NewerProfile, UnknownTransformsBecomeIdentities) {
    const auto readable =
        make_readable(config_of("2.99", "!<BuiltinTransform> {style: SURPRISE_to_ACES2065-1}"));
    ASSERT_TRUE(readable);
    EXPECT_EQ(readable->profile, "2.99");
    EXPECT_EQ(readable->unread, std::vector<std::string>{"color space newer"});
    EXPECT_TRUE(readable->older.empty());
    std::istringstream text(readable->text);
    const OCIO::ConstConfigRcPtr config = OCIO::Config::CreateFromStream(text);
    EXPECT_NO_THROW(config->validate());
    float rgb[] = {0.25F, 0.5F, 0.75F};
    config->getProcessor("raw", "newer")->getDefaultCPUProcessor()->applyRGB(rgb);
    EXPECT_EQ(rgb[1], 0.5F);
    // One that OpenColorIO knows stays.
    EXPECT_TRUE(make_readable(config_of("2.99", "!<MatrixTransform> {offset: [1, 1, 1, 0]}"))
                    ->unread.empty());
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
