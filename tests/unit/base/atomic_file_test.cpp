// SPDX-License-Identifier: Apache-2.0
#include "base/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <set>

#include "base/input_file.h"
#include "tonewright/error.h"
#include "tonewright/generated_files.h"
#include "tonewright/lut.h"
#include "unit/errors.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

TEST(WriteText, WritesAndReplaces) {
    const Folder folder;
    const std::string path = folder / "a.cube";
    const std::string binary("one\0\n\r\ntwo", 10);
    write_text_atomically(path, binary);
    EXPECT_EQ(read(path), binary);
    write_text_atomically(path, "shorter");
    EXPECT_EQ(read(path), "shorter");
    write_text_atomically(path, "");
    EXPECT_EQ(read(path), "");
    const std::string large(3 << 20, 'x');
    write_text_atomically(path, large);
    EXPECT_EQ(read(path), large);
    EXPECT_EQ(folder.files(), (std::vector<std::string>{"a.cube"})) << "no temporary file is left";
}

TEST(WriteText, WorksWithARelativeName) {
    const Folder folder;
    const fs::path before = fs::current_path();
    fs::current_path(folder.path());
    write_text_atomically("plain.txt", "here");
    fs::current_path(before);
    EXPECT_EQ(read(folder / "plain.txt"), "here");
}

TEST(WriteText, FailureLeavesTheOldFile) {
    const Folder folder;
    write(folder / "old", "precious");
    fs::create_directories(folder / "full/of");
    const auto error = [&](const std::string& path) {
        try {
            write_text_atomically(path, "new");
        } catch (const FileError& e) {  // the command exits with 3, not 2
            return std::string(e.what());
        }
        return std::string("no error");
    };
    const std::string missing = folder / "missing/file";
    EXPECT_EQ(error(missing), "write: " + missing + ": No such file or directory");
    const std::string below_a_file = folder / "old/file";
    EXPECT_EQ(error(below_a_file), "write: " + below_a_file + ": Not a directory");
    const std::string is_a_folder = folder / "full";
    EXPECT_NE(error(is_a_folder), "no error");
    EXPECT_EQ(read(folder / "old"), "precious");
    EXPECT_TRUE(fs::is_directory(folder / "full/of"));
    EXPECT_EQ(folder.files(), (std::vector<std::string>{"old"})) << "no temporary file is left";
}

TEST(WriteText, AFullDiskLeavesTheOldFile) {
    const Folder folder;
    const std::string path = folder / "old";
    write(path, "precious");
    // A limit on the size of files stops the write half way, as a full disk does.
    struct rlimit before {};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    struct rlimit small = before;
    small.rlim_cur = 4096;
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const std::string message =
        error_of([&] { write_text_atomically(path, std::string(1 << 20, 'x')); });
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(message, "write: " + path + ": File too large");
    EXPECT_EQ(read(path), "precious");
    EXPECT_EQ(folder.files(), (std::vector<std::string>{"old"})) << "no temporary file is left";
}

std::string manifest_of(const std::vector<std::string>& paths) {
    std::string text = "path,operator\n";
    for (const std::string& path : paths)
        text += path + ",x\n";
    return text;
}

TEST(WriteFiles, WritesTheSetAndRemovesStaleFiles) {
    const Folder folder;
    const std::string root = folder / "set";
    write_generated_files(root,
                          {{"a/one.cube", "1"},
                           {"two.cube", "2"},
                           {"MANIFEST.csv", manifest_of({"a/one.cube", "two.cube"})}},
                          "MANIFEST.csv");
    EXPECT_EQ(read(root + "/a/one.cube"), "1");
    write(root + "/a/mine.cube", "not of the set");
    write_generated_files(root, {{"two.cube", "22"}, {"MANIFEST.csv", manifest_of({"two.cube"})}},
                          "MANIFEST.csv");
    EXPECT_EQ(folder.files(),
              (std::vector<std::string>{"set/MANIFEST.csv", "set/a/mine.cube", "set/two.cube"}))
        << "one.cube was of the old set alone; mine.cube never of any";
    EXPECT_EQ(read(root + "/two.cube"), "22");
}

TEST(WriteFiles, NeverChangesFilesOutside) {
    const Folder folder;
    const std::string root = folder / "set";
    fs::create_directories(root + "/sub");
    fs::create_directories(folder / "other");
    write(folder / "outside", "keep");
    write(folder / "other/file", "keep");
    write(root + "/MANIFEST.csv",
          manifest_of({"../outside", "sub/../../outside", folder / "outside", "..", ".", "",
                       "./../outside", "sub/../../other/file", folder / "other/file"}));
    write_generated_files(root, {{"new", "n"}}, "new");
    EXPECT_EQ(read(folder / "outside"), "keep");
    EXPECT_EQ(read(folder / "other/file"), "keep");
    EXPECT_EQ(read(root + "/new"), "n");
}

TEST(WriteFiles, NeverFollowsALinkOutside) {
    const Folder folder;
    const std::string root = folder / "set";
    fs::create_directories(root);
    fs::create_directories(folder / "other");
    write(folder / "other/file", "keep");
    fs::create_directory_symlink(folder / "other", root + "/link");
    write(root + "/MANIFEST.csv", manifest_of({"link/file"}));
    write_generated_files(root, {{"new", "n"}}, "new");
    EXPECT_EQ(read(folder / "other/file"), "keep");
}

TEST(WriteFiles, ADifferentSpellingIsNotStale) {
    const Folder folder;
    const std::string root = folder / "set";
    fs::create_directories(root + "/a");
    write(root + "/MANIFEST.csv", manifest_of({"./one", "a/../two"}));
    write_generated_files(root, {{"one", "1"}, {"two", "2"}}, "two");
    EXPECT_EQ(read(root + "/one"), "1");
    EXPECT_EQ(read(root + "/two"), "2");
}

TEST(WriteFiles, TheLastFileComesLast) {
    // An entry that cannot be written, named after the last one: the last one must not be there.
    const Folder folder;
    const std::string root = folder / "set";
    fs::create_directories(root);
    write(root + "/blocked", "a file, not a folder");
    EXPECT_THROW(
        write_generated_files(root, {{"config.ocio", "c"}, {"blocked/lut", "x"}}, "config.ocio"),
        FileError);
    EXPECT_FALSE(fs::exists(root + "/config.ocio"));
    EXPECT_EQ(read(root + "/blocked"), "a file, not a folder");
}

/// A folder with a pipe in it.
class Files : public ::testing::Test {
  protected:
    Files() { EXPECT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0); }

    [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }

    Folder folder_;
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
    EXPECT_EQ(write_error(folder_.path()), "write: " + folder_.path() + ": is a folder");
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

    write(path("victim"), "old");
    AtomicFile file(path("a.txt"));
    fs::create_symlink(folder_ / "victim", file.path());  // as one who had guessed the name
    EXPECT_EQ(file.create(), -1);
    EXPECT_EQ(errno, EEXIST);
    EXPECT_EQ(read(path("victim")), "old");
}

TEST_F(Files, LeftoversOfYesterdayAreRemoved) {
    const auto make = [&](const std::string& name) {
        write(path(name), "x");
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
    write(path("old.txt"), "old");
    fs::create_symlink("old.txt", folder_ / "link.txt");
    write_text_atomically(path("link.txt"), "new");
    EXPECT_TRUE(fs::is_symlink(folder_ / "link.txt"));
    EXPECT_EQ(read(path("old.txt")), "new");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 3) << "and the pipe";
}

TEST_F(Files, ATrialOfAFolderLeavesAFileOfThatNameAlone) {
    write(path(".tonewright"), "mine");
    require_writable_folder(folder_.path());
    EXPECT_EQ(read(path(".tonewright")), "mine");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 2);
}

std::string read_error(const std::string& path, std::size_t longest = 100) {
    std::string why;
    (void)read_file(path, longest, [&](const Problem& reason) { why = reason.value; });
    return why;
}

TEST_F(Files, OnlyFilesAreReadAndNothingBlocks) {
    write(path("a.txt"), "text");
    EXPECT_EQ(read_file(path("a.txt"), 4, [](const Problem& why) { FAIL() << why.value; }), "text");
    EXPECT_EQ(read_error(path("a.txt"), 3), "it has 4 bytes; expected at most 3");
    EXPECT_EQ(read_error(path("none")), "No such file or directory");
    EXPECT_EQ(read_error(folder_.path()), "is a folder");
    for (const std::string& name : {path("pipe"), std::string("/dev/zero")}) {
        EXPECT_EQ(read_error(name), "is no regular file (a pipe or a device); expected a file");
        ASSERT_TRUE(why_not_readable(name));
        EXPECT_EQ(why_not_readable(name)->value, read_error(name));
    }
    EXPECT_EQ(why_no_file(path("none")), "") << "a name may be one that is to be written";
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
