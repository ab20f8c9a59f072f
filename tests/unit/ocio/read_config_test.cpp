// SPDX-License-Identifier: Apache-2.0
#include "ocio/read_config.h"

#include <OpenColorIO/OpenColorIO.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tonewright/error.h"
#include "tonewright/ocio.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const std::string kText =
    "ocio_profile_version: 2.1\nroles: {default: raw}\ncolorspaces:\n  - !<ColorSpace> {name: raw, "
    "isdata: true}\n";

TEST(ReadConfig, ReadsAFileOrSaysWhyNot) {
    const Folder folder;
    write(folder / "config.ocio", kText);
    EXPECT_EQ(read_config(folder / "config.ocio")->getNumColorSpaces(), 1);
    EXPECT_EQ(read_config_text(folder / "config.ocio"), kText);
    const auto error = [&](const std::string& path) -> std::string {
        try {
            (void)read_config(path);
        } catch (const FileError& e) {
            return e.what();
        }
        return "no error";
    };
    EXPECT_NE(error(folder / "none.ocio").find("none.ocio"), std::string::npos);
    write(folder / "bad.ocio", "no config");
    EXPECT_NE(error(folder / "bad.ocio").find("bad.ocio"), std::string::npos);
    EXPECT_EQ(error(folder / "bad.ocio").find('\n'), std::string::npos) << "one line";
}

TEST(ReadConfig, TheCopyKeepsTheDefaultViewTransform) {
    const OCIO::ConfigRcPtr config = OCIO::Config::CreateRaw()->createEditableCopy();
    const auto transform = OCIO::ViewTransform::Create(OCIO::REFERENCE_SPACE_SCENE);
    transform->setName("mine");
    transform->setTransform(OCIO::MatrixTransform::Create(),
                            OCIO::VIEWTRANSFORM_DIR_FROM_REFERENCE);
    config->addViewTransform(transform);
    config->setDefaultViewTransformName("mine");
    EXPECT_STREQ(editable_copy(*config)->getDefaultViewTransformName(), "mine");
}

TEST(Messages, OfOpenColorIOComeOnceAndWithoutItsPrefix) {
    std::vector<std::string> messages;
    redirect_opencolorio_messages([&](const std::string& text) { messages.push_back(text); });
    for (int i = 0; i < 2; ++i)
        OCIO::LogMessage(OCIO::LOGGING_LEVEL_WARNING, "a surprise\n");
    OCIO::ResetToDefaultLoggingFunction();
    EXPECT_EQ(messages, std::vector<std::string>{"a surprise"});
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
