// SPDX-License-Identifier: Apache-2.0
#include <OpenColorIO/OpenColorIO.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tonewright/error.h"
#include "tonewright/generated_files.h"
#include "tonewright/ocio.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace OCIO = OCIO_NAMESPACE;

/// One view of one operator on one display, which takes no time.
ConfigOptions small() {
    ConfigOptions options;
    options.profiles = {"2.1"};
    options.views = {"clamp"};
    options.displays = {"sRGB"};
    options.looks = {"none"};
    return options;
}

std::string error_of(const ConfigOptions& options) {
    try {
        (void)ConfigPlan(options);
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

TEST(Config, ShowsWhatTheViewIs) {
    const std::vector<GeneratedFile> files = make_config(small());
    EXPECT_EQ(files.back().path, "config.ocio") << "written last, so that its tables exist";
    const Folder folder;
    write_generated_files(folder.path(), files, "config.ocio");
    const OCIO::ConstConfigRcPtr config =
        OCIO::Config::CreateFromFile((folder / "config.ocio").c_str());
    EXPECT_STREQ(config->getName(), kConfigName);
    EXPECT_STREQ(config->getDefaultDisplay(), "sRGB");
    const auto transform = OCIO::DisplayViewTransform::Create();
    transform->setSrc(config_space_name("lin_rec709").c_str());
    transform->setDisplay("sRGB");
    transform->setView(config->getDefaultView("sRGB"));
    const auto cpu = config->getProcessor(transform)->getDefaultCPUProcessor();
    // IEC 61966-2-1 of light in [0, 1]; OpenColorIO computes its power in float.
    float rgb[] = {0.18F, 0.001F, 2.0F};
    cpu->applyRGB(rgb);
    EXPECT_NEAR(rgb[0], 0.4613561F, 2e-6F);
    EXPECT_NEAR(rgb[1], 0.01292F, 2e-6F);
    EXPECT_NEAR(rgb[2], 1.0F, 2e-6F);
}

TEST(Config, OptionsAreCheckedBeforeTheWork) {
    EXPECT_EQ(error_of(small()), "no error");
    ConfigOptions options = small();
    options.profiles = {"2.2"};
    EXPECT_EQ(error_of(options), "profile is 2.2; expected 2.0, 2.1 or 2.5");
    options.profiles = {"2.1", "2.1"};
    EXPECT_EQ(error_of(options), "profile is 2.1 twice; expected it once");
    options.profiles = {};
    EXPECT_EQ(error_of(options), "no profile; expected 2.0, 2.1 or 2.5");
    options = small();
    options.views = {"clampp"};
    EXPECT_NE(error_of(options).find("did you mean"), std::string::npos) << error_of(options);
    options = small();
    options.views = {"none"};
    EXPECT_NE(error_of(options), "no error") << "nothing to show";
    options = small();
    options.custom = {{std::string(64, 'n'), resolve_operator("hable")}};
    EXPECT_NE(error_of(options).find("at most 63 bytes"), std::string::npos);
    EXPECT_THROW((void)make_config(options), Error) << "the same error";
}

TEST(Config, WarnsOfOperatorsThatMeasurePictures) {
    EXPECT_TRUE(ConfigPlan(small()).warnings().empty());
    ConfigOptions options = small();
    options.views = {"clamp", "drago", "drago"};
    options.views.pop_back();
    const std::vector<std::string> warnings = ConfigPlan(options).warnings();
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_EQ(warnings[0].find("a config cannot measure pictures: "), 0U) << warnings[0];
    EXPECT_EQ(warnings[0].find('\n'), std::string::npos) << "one line";
}

TEST(ConfigNames, AreThoseOfViewsDisplaysAndSpaces) {
    const ResolvedOperator op = resolve_operator("aces_20");
    EXPECT_EQ(config_view_name("ACES 2.0", op, find_display("srgb")), "ACES 2.0");
    const Display& pq = find_display("rec2100_pq");
    const std::string hdr =
        config_view_name("ACES 2.0", make_view(op, "lin_rec709", 0, pq.id).op, pq);
    EXPECT_EQ(hdr.find("ACES 2.0 - HDR "), 0U) << hdr;
    EXPECT_EQ(hdr.substr(hdr.size() - 5), " nits") << hdr;
    EXPECT_EQ(output_space_name("AgX", "sRGB"), "Output - AgX - sRGB");
    EXPECT_EQ(config_space_name("lin_rec709"), "Linear Rec.709");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
