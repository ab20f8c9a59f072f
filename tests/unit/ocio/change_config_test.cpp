// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tonewright/error.h"
#include "tonewright/ocio.h"
#include "unit/errors.h"
#include "unit/folder.h"
#include "unit/ocio/own_config.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Kind = ConfigChange::Kind;

/// kOwn in a folder.
class ChangeConfig : public testing::Test {
  protected:
    ChangeConfig() { write(path_, kOwn); }

    ChangedConfig add(const char* view = "hable") const {
        ConfigChange change;
        change.options.views = {view};
        return change_config(path_, change);
    }

    Folder folder_;
    std::string path_ = folder_ / "studio.ocio";
};

TEST_F(ChangeConfig, AddsAViewAndRemovesItAgain) {
    const ChangedConfig added = add();
    EXPECT_EQ(added.path, path_);
    EXPECT_EQ(added.folder, "tonewright");
    EXPECT_TRUE(added.backup.empty());
    ASSERT_EQ(added.views.size(), 1U);
    EXPECT_EQ(added.views[0].display, "sRGB");
    EXPECT_LT(added.views[0].max, 1e-4) << "one curve for each channel needs no 3D LUT";
    EXPECT_NE(read(path_).find("Hable"), std::string::npos);
    const std::vector<std::string> files = folder_.files();
    EXPECT_GE(files.size(), 2U) << "the config, its record";
    EXPECT_TRUE(std::none_of(files.begin(), files.end(),
                             [](const std::string& file) { return file.ends_with(".new"); }));

    const ChangedConfig removed = change_config(path_, {.kind = Kind::remove});
    EXPECT_EQ(read(path_), kOwn);
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"studio.ocio"}));
    EXPECT_TRUE(removed.views.empty());
    EXPECT_EQ(removed.removed_tables + 2, files.size());
}

TEST_F(ChangeConfig, UpdateReplacesTheViews) {
    add();
    ConfigChange change;
    change.kind = Kind::update;
    change.options.views = {"reinhard"};
    change_config(path_, change);
    EXPECT_EQ(read(path_).find("Hable"), std::string::npos);
    EXPECT_NE(read(path_).find("Reinhard"), std::string::npos);
    const std::string text = read(path_);
    change_config(path_, {.kind = Kind::update});
    EXPECT_EQ(read(path_), text) << "without options: the same views";
}

TEST_F(ChangeConfig, BackupsAreNumbered) {
    ConfigChange change;
    change.options = hable_view();
    change.has_backup = true;
    EXPECT_EQ(change_config(path_, change).backup, path_ + ".bak");
    EXPECT_EQ(read(path_ + ".bak"), kOwn);
    change.kind = Kind::update;
    EXPECT_EQ(change_config(path_, change).backup, path_ + ".bak2");
}

TEST_F(ChangeConfig, LinkStaysAndGetsALinkToTheTables) {
    std::filesystem::create_directory(folder_ / "sub");
    std::filesystem::rename(path_, folder_ / "sub/real.ocio");
    std::filesystem::create_symlink("sub/real.ocio", path_);
    const ChangedConfig changed = add();
    EXPECT_TRUE(std::filesystem::is_symlink(path_));
    EXPECT_EQ(std::filesystem::canonical(changed.path),
              std::filesystem::canonical(folder_ / "sub/real.ocio"));
    ASSERT_EQ(changed.links.size(), 1U);
    EXPECT_EQ(changed.links[0].path, folder_ / "tonewright");
    EXPECT_EQ(changed.links[0].target, "sub/tonewright");
    change_config(path_, {.kind = Kind::remove});
    EXPECT_FALSE(std::filesystem::exists(folder_ / "tonewright"));
}

TEST_F(ChangeConfig, LinkInPlaceOfTheFolderStays) {
    std::filesystem::create_directory(folder_ / "elsewhere");
    std::filesystem::create_directory_symlink("elsewhere", folder_ / "tonewright");
    add("AgX");
    EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "tonewright"));
    change_config(path_, {.kind = Kind::remove});
    EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "tonewright"));
    EXPECT_EQ(read(path_), kOwn);
}

TEST_F(ChangeConfig, WarnsBeforeItWrites) {
    std::filesystem::create_hard_link(path_, folder_ / "other.ocio");
    ConfigChange change;
    change.options.views = {"drago"};
    std::vector<std::string> warnings;
    change.warn = [&](const std::string& line) {
        EXPECT_EQ(read(path_), kOwn);
        warnings.push_back(line);
        if (warnings.size() == 2) throw Error("enough");
    };
    EXPECT_EQ(error_of([&] { change_config(path_, change); }), "enough");
    ASSERT_EQ(warnings.size(), 2U);
    EXPECT_EQ(warnings[0], path_ + " has 2 hard links: only this name gets the new contents");
    EXPECT_NE(warnings[1].find("Drago"), std::string::npos) << warnings[1];
    EXPECT_EQ(read(path_), kOwn);
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"other.ocio", "studio.ocio"}));
}

TEST_F(ChangeConfig, FailedChangeLeavesNothing) {
    EXPECT_THROW(change_config(path_, {.kind = Kind::remove}), FileError) << "nothing was added";
    ConfigChange one{.kind = Kind::remove};
    one.options.views = {"hable"};
    EXPECT_THROW(change_config(path_, one), Error) << "all are removed, not one";
    // A file is in the way of the record.
    write(folder_ / "tonewright", "a file");
    EXPECT_THROW(add(), FileError);
    EXPECT_EQ(read(path_), kOwn);
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"studio.ocio", "tonewright"}));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
