// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "base/atomic_file.h"
#include "base/input_file.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

class Files : public ::testing::Test {
  protected:
    Files()
        : folder_(fs::temp_directory_path() / ("tonewright_files." + std::to_string(::getpid()))) {
        fs::create_directories(folder_);
        EXPECT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
    }
    ~Files() override { fs::remove_all(folder_); }

    [[nodiscard]] std::string path(const std::string& name) const {
        return (folder_ / name).string();
    }
    void put(const std::string& name, const std::string& text) const {
        std::ofstream(path(name)) << text;
    }
    [[nodiscard]] std::string text_of(const std::string& name) const {
        std::ifstream file(path(name));
        return {std::istreambuf_iterator<char>(file), {}};
    }

    fs::path folder_;
};

std::string write_error(const std::string& path) {
    try {
        write_text_atomically(path, "new");
    } catch (const FileError& e) {
        return e.what();
    }
    return "none";
}

TEST_F(Files, NoDevicePipeOrFolderIsReplaced) {
    const std::string no_file = "is no regular file (a pipe or a device); expected a file";
    EXPECT_EQ(write_error("/dev/null"), "write: /dev/null: " + no_file);
    EXPECT_EQ(write_error(path("pipe")), "write: " + path("pipe") + ": " + no_file);
    EXPECT_EQ(write_error(folder_.string()), "write: " + folder_.string() + ": is a folder");
    fs::create_symlink("/dev/null", folder_ / "link");
    EXPECT_EQ(write_error(path("link")), "write: " + path("link") + ": " + no_file);
    struct stat status {};
    ASSERT_EQ(::stat("/dev/null", &status), 0);
    EXPECT_TRUE(S_ISCHR(status.st_mode));
    ASSERT_EQ(::lstat(path("pipe").c_str(), &status), 0);
    EXPECT_TRUE(S_ISFIFO(status.st_mode));
}

TEST_F(Files, TemporaryNamesAreUnique) {
    std::set<std::string> names;
    for (int i = 0; i < 20; ++i)
        names.insert(AtomicFile(path("a.txt")).path().string());
    EXPECT_EQ(names.size(), 20U);

    put("victim", "old");
    AtomicFile file(path("a.txt"));
    fs::create_symlink(folder_ / "victim", file.path());  // as one who had guessed the name
    EXPECT_EQ(file.create(), -1);
    EXPECT_EQ(errno, EEXIST);
    EXPECT_EQ(text_of("victim"), "old");
}

TEST_F(Files, LeftoversOfYesterdayAreRemoved) {
    const auto make = [&](const std::string& name) {
        put(name, "x");
        fs::last_write_time(path(name), fs::file_time_type::clock::now() - std::chrono::hours(49));
    };
    const std::vector<std::string> left = {".a.b.01234567.1.f.tmp.exr", ".c.01234567.12.ff.tmp.tmp",
                                           ".d.01234567.123456789.0f.tmp"};
    // Other targets, and what no temporary name is.
    const std::vector<std::string> other = {".e.01234567.1.f.tmp.exr",
                                            ".a.b.01234567.1.f.tmp.png",
                                            ".a.b.0123456g.1.f.tmp.exr",
                                            ".a.b.1234567.1.f.tmp.exr",
                                            ".a.b.01234567.1.g.tmp.exr",
                                            ".a.b.01234567.x.f.tmp.exr",
                                            ".a.b.01234567.1..tmp.exr",
                                            "a.b.01234567.1.f.tmp.exr",
                                            ".a.b.01234567.1.f.txt",
                                            ".a.b.01234567.1234567890.f.tmp.exr",
                                            ".tmp",
                                            ".d.tmp"};
    for (const std::string& name : left)
        make(name);
    for (const std::string& name : other)
        make(name);
    remove_leftovers({path("a.b.exr"), path("c.tmp"), path("d")});
    for (const std::string& name : left)
        EXPECT_FALSE(fs::exists(path(name))) << name;
    for (const std::string& name : other)
        EXPECT_TRUE(fs::exists(path(name))) << name;
}

TEST_F(Files, AnOldFileIsReplacedAndLinksStay) {
    put("old.txt", "old");
    fs::create_symlink("old.txt", folder_ / "link.txt");
    write_text_atomically(path("link.txt"), "new");
    EXPECT_TRUE(fs::is_symlink(folder_ / "link.txt"));
    EXPECT_EQ(text_of("old.txt"), "new");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 3) << "and the pipe";
}

TEST_F(Files, ATrialOfAFolderLeavesAFileOfThatNameAlone) {
    put(".tonewright", "mine");
    require_writable_folder(folder_.string());
    EXPECT_EQ(text_of(".tonewright"), "mine");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2);
}

std::string read_error(const std::string& path, std::size_t longest = 100) {
    std::string why;
    (void)read_file(path, longest, [&](const Problem& reason) { why = reason.value; });
    return why;
}

TEST_F(Files, OnlyFilesAreReadAndNothingBlocks) {
    put("a.txt", "text");
    EXPECT_EQ(read_file(path("a.txt"), 4, [](const Problem& why) { FAIL() << why.value; }), "text");
    EXPECT_EQ(read_error(path("a.txt"), 3), "it has 4 bytes; expected at most 3");
    EXPECT_EQ(read_error(path("none")), "No such file or directory");
    EXPECT_EQ(read_error(folder_.string()), "is a folder");
    for (const std::string& name : {path("pipe"), std::string("/dev/zero")}) {
        EXPECT_EQ(read_error(name), "is no regular file (a pipe or a device); expected a file");
        ASSERT_TRUE(why_not_readable(name));
        EXPECT_EQ(why_not_readable(name)->value, read_error(name));
    }
    EXPECT_EQ(why_no_file(path("none")), "") << "a name may be one that is to be written";
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
