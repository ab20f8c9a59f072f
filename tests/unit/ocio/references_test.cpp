// SPDX-License-Identifier: Apache-2.0
#include "ocio/references.h"

#include <OpenColorIO/OpenColorIO.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

OCIO::ConstConfigRcPtr config_of(const std::string& spaces) {
    std::istringstream text(R"(ocio_profile_version: 2.1
roles: {default: lin}
file_rules:
  - !<Rule> {name: Default, colorspace: lin}
displays:
  a:
    - !<View> {name: Raw, colorspace: lin}
colorspaces:
  - !<ColorSpace> {name: lin, aliases: [Linear]}
)" + spaces);
    return OCIO::Config::CreateFromStream(text);
}

std::string through(const std::string& name, const std::string& other) {
    return "  - !<ColorSpace> {name: " + name +
           ", to_scene_reference: !<ColorSpaceTransform> {src: " + other + ", dst: lin}}\n";
}

TEST(SpaceIndex, FindsNamesAliasesAndRolesInAnyCase) {
    const OCIO::ConstConfigRcPtr config = config_of(through("Mine", "lin"));
    const SpaceIndex index(*config);
    EXPECT_EQ(index.all().size(), 2U);
    for (const char* name : {"lin", "LINEAR", "default"}) {
        ASSERT_TRUE(index.find(name)) << name;
        EXPECT_STREQ(index.find(name)->getName(), "lin");
    }
    EXPECT_STREQ(index.find("mine")->getName(), "Mine");
    EXPECT_FALSE(index.find("yours"));
}

TEST(References, CirclesAreRefusedWithTheirMembers) {
    EXPECT_NO_THROW(check_references(
        *config_of(through("a", "lin") + through("b", "a") + through("c", "a")), "x.ocio"))
        << "shared, no circle";
    try {
        check_references(*config_of(through("a", "b") + through("b", "a")), "x.ocio");
        FAIL();
    } catch (const FileError& e) {
        const std::string message = e.what();
        EXPECT_NE(message.find("color space a -> color space b -> color space a"),
                  std::string::npos)
            << message;
        EXPECT_NE(message.find("x.ocio"), std::string::npos);
    }
}

TEST(References, EveryTransformOfATreeIsVisited) {
    const auto group = OCIO::GroupTransform::Create();
    const auto inner = OCIO::GroupTransform::Create();
    inner->appendTransform(OCIO::MatrixTransform::Create());
    inner->appendTransform(OCIO::LogTransform::Create());
    group->appendTransform(inner);
    group->appendTransform(OCIO::MatrixTransform::Create());
    int matrices = 0;
    int logs = 0;
    for_each_transform(group, [&](const OCIO::ConstTransformRcPtr& t) {
        matrices += t->getTransformType() == OCIO::TRANSFORM_TYPE_MATRIX;
        logs += t->getTransformType() == OCIO::TRANSFORM_TYPE_LOG;
    });
    EXPECT_EQ(matrices, 2);
    EXPECT_EQ(logs, 1);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
