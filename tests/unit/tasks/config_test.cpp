// SPDX-License-Identifier: Apache-2.0
#include "tasks/config.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "unit/errors.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

ConfigRequest request_for(const char* view) {
    ConfigRequest request;
    request.options.views = {view};
    request.options.displays = {"srgb"};
    request.options.profiles = {"2.1"};
    return request;
}

TEST(WriteConfig, FolderAndArchiveHaveTheFilesOfMakeConfig) {
    const Folder folder;
    ConfigRequest request = request_for("AgX");
    request.folder = folder / "config";
    request.archive = folder / "config.ocioz";
    const std::vector<WrittenConfig> written = write_config(request, {});
    ASSERT_EQ(written.size(), 2U);
    EXPECT_EQ(written[0].path, request.folder);
    EXPECT_EQ(written[1].path, request.archive);
    std::size_t bytes = 0;
    const std::vector<GeneratedFile> files = make_config(request.options);
    for (const GeneratedFile& file : files) {
        EXPECT_EQ(read(request.folder + "/" + file.path), file.contents) << file.path;
        bytes += file.contents.size();
    }
    EXPECT_EQ(written[0].files, files.size());
    EXPECT_EQ(written[0].bytes, bytes);
    EXPECT_LT(written[1].files, files.size()) << "no README.md in an archive";
    EXPECT_EQ(read(request.archive).substr(0, 2), "PK");
}

TEST(WriteConfig, WarnsBeforeItWrites) {
    const Folder folder;
    ConfigRequest request = request_for("drago");
    request.folder = folder / "config";
    const Listener refuses = {.warn = [](const std::string& line) { throw Error(line); }};
    EXPECT_NE(error_of([&] { (void)write_config(request, refuses); }).find("Drago"),
              std::string::npos);
    EXPECT_TRUE(folder.files().empty());
}

TEST(WriteConfig, ArchiveHasItsOwnExtension) {
    ConfigRequest request = request_for("hable");
    request.archive = "config.zip";
    EXPECT_EQ(error_of([&] { (void)write_config(request, {}); }),
              "archive is config.zip; expected a name that ends in .ocioz");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
