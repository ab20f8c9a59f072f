// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/input_files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "unit/errors.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Names = std::vector<std::string>;

TEST(InputFiles, PicturesOfAFolderAreSorted) {
    const Folder folder;
    for (const char* name : {"b.EXR", "a.png", "notes.txt", ".hidden.png"})
        write(folder / name, "");
    std::filesystem::create_directory(folder / "c.png");
    EXPECT_EQ(pictures_of_folder(folder.path()), (Names{folder / "a.png", folder / "b.EXR"}));
    EXPECT_TRUE(is_folder(folder.path()));
    EXPECT_FALSE(is_folder(folder / "a.png"));
    EXPECT_NE(error_of([&] { (void)pictures_of_folder(folder / "c.png"); }).find("has no pictures"),
              std::string::npos);
    EXPECT_TRUE(is_picture_extension(".exr"));
    EXPECT_FALSE(is_picture_extension(".txt"));
}

TEST(InputFiles, ListsHaveOneNameALine) {
    const Folder folder;
    write(folder / "list", "# comment\n\n a.exr \nb c.exr\n");
    EXPECT_EQ(names_of_list(folder / "list"), (Names{"a.exr", "b c.exr"}));
    write(folder / "empty", "#\n");
    EXPECT_NE(error_of([&] { (void)names_of_list(folder / "empty"); }).find("the list is empty"),
              std::string::npos);
}

TEST(InputFiles, ResultsHaveTheNamesOfTheirPictures) {
    const std::vector<FrameFiles> files = files_into_folder({"x/a.exr", "b.exr"}, "out", "png");
    ASSERT_EQ(files.size(), 2U);
    EXPECT_EQ(files[0].in, "x/a.exr");
    EXPECT_EQ(files[0].out, "out/a.png");
    EXPECT_EQ(
        error_of([] {
            (void)files_into_folder({"x/a.exr", "a.tif"}, "out", "png");
        }),
        "x/a.exr and a.tif would both be written to out/a.png; expected different file names");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
