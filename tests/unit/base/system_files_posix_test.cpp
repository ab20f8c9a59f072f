// SPDX-License-Identifier: Apache-2.0
#include "base/system_files.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(SystemFiles, AProcessHasEndedOnceItIsWaitedFor) {
    EXPECT_FALSE(has_ended(this_process()));
    const pid_t child = ::fork();
    if (child == 0) ::_exit(0);
    ASSERT_EQ(::waitpid(child, nullptr, 0), child);
    EXPECT_TRUE(has_ended(child));
    EXPECT_EQ(machine_and_container(), machine_and_container());
}

TEST(SystemFiles, CreateNewFollowsNoLinkAndReplacesNothing) {
    const Folder folder;
    const int file = create_new(folder / "a", true);
    ASSERT_GE(file, 0);
    ::close(file);
    EXPECT_EQ(std::filesystem::status(folder / "a").permissions(),
              std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
    EXPECT_EQ(create_new(folder / "a", true), -1);
    std::filesystem::create_symlink(folder / "b", folder / "link");
    EXPECT_EQ(create_new(folder / "link", false), -1);
    EXPECT_FALSE(std::filesystem::exists(folder / "b"));
}

TEST(SystemFiles, OnlyOwnFilesAreTrusted) {
    const Folder folder;
    write(folder / "a", "text");
    const int file = open_own_file(folder / "a");
    EXPECT_GE(file, 0);
    ::close(file);
    std::filesystem::create_symlink(folder / "a", folder / "link");
    EXPECT_EQ(open_own_file(folder / "link"), -1) << "a link";
    EXPECT_FALSE(is_file_itself(folder / "link"));
    EXPECT_TRUE(is_file_itself(folder / "a"));
    ASSERT_EQ(::chmod((folder / "a").c_str(), 0666), 0);
    EXPECT_EQ(open_own_file(folder / "a"), -1) << "others may write into it";
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    EXPECT_EQ(open_own_file(folder / "pipe"), -1) << "and it does not block";
}

TEST(SystemFiles, IdentityFollowsLinksAndReplaceKeepsPermissions) {
    const Folder folder;
    write(folder / "a", "old");
    write(folder / "new", "new");
    std::filesystem::create_symlink(folder / "a", folder / "link");
    EXPECT_EQ(identity_of(folder / "a"), identity_of(folder / "link"));
    EXPECT_NE(identity_of(folder / "a"), identity_of(folder / "new"));
    EXPECT_FALSE(identity_of(folder / "none"));
    ASSERT_EQ(::chmod((folder / "a").c_str(), 0640), 0);
    EXPECT_EQ(replace(folder / "a", folder / "new", folder / "a"), 0);
    EXPECT_EQ(read(folder / "a"), "new");
    struct stat status {};
    ASSERT_EQ(::stat((folder / "a").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777, 0640U);
    EXPECT_NE(replace(folder / "a", folder / "none", folder / "a"), 0) << "an errno";
    remove_name((folder / "a").c_str());
    EXPECT_FALSE(std::filesystem::exists(folder / "a"));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
