// SPDX-License-Identifier: Apache-2.0
#include "ocio/extend.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tonewright/error.h"
#include "tonewright/generated_files.h"
#include "unit/folder.h"
#include "unit/ocio/own_config.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Writes it as the command does: tables, the record, the config.
void apply(const ExtendedConfig& extended, const Folder& folder) {
    for (const GeneratedFile& file : extended.files) {
        std::filesystem::create_directories(
            std::filesystem::path(folder / file.path).parent_path());
        write(folder / file.path, file.contents);
    }
    std::filesystem::create_directories(folder / "tonewright");
    write(folder / extended.record.path, extended.record.contents);
    write(extended.path, extended.text);
}

TEST(ExtendConfig, AddsAViewAndKeepsEveryByteOfTheRest) {
    const Folder folder;
    const std::string path = folder / "studio.ocio";
    write(path, kOwn);
    const ExtendedConfig extended = extend_config(path, hable_view());
    EXPECT_EQ(read(path), kOwn) << "nothing is written yet";
    EXPECT_EQ(extended.path, path);
    const auto views = std::find_if(extended.added.begin(), extended.added.end(),
                                    [](const auto& a) { return a.kind == "view"; });
    ASSERT_NE(views, extended.added.end());
    ASSERT_EQ(views->names.size(), 1U);
    EXPECT_NE(views->names[0].find("Hable"), std::string::npos);
    // The old lines are there in their order; the search path has one more folder at its end.
    std::size_t at = 0;
    for (std::size_t begin = 0; begin < kOwn.size();) {
        const std::size_t end = kOwn.find('\n', begin);
        const std::string line = kOwn.substr(begin, end - begin);
        at = extended.text.find(line, at);
        ASSERT_NE(at, std::string::npos) << line;
        at += line.size();
        begin = end + 1;
    }
    apply(extended, folder);
    const std::vector<ExtendedView> checked = extended.check(path);
    ASSERT_EQ(checked.size(), 1U);
    EXPECT_EQ(checked[0].display, "sRGB");
    // One curve for each channel needs no 3D LUT; float's own error in sRGB codes is 1e-5.
    EXPECT_LT(checked[0].max, 1e-4);
    EXPECT_THROW((void)extend_config(path, hable_view()), Error) << "the names are taken";

    const ExtendedConfig reduced = reduce_config(path);
    EXPECT_EQ(reduced.text, kOwn) << "the way back";
    std::vector<std::string> tables;
    for (const GeneratedFile& file : extended.files)
        tables.push_back(file.path);
    std::vector<std::string> unused = reduced.unused_files;
    std::sort(tables.begin(), tables.end());
    std::sort(unused.begin(), unused.end());
    EXPECT_EQ(unused, tables);
}

TEST(ExtendConfig, AnUpdateReplacesWhatWasAdded) {
    const Folder folder;
    const std::string path = folder / "studio.ocio";
    write(path, kOwn);
    apply(extend_config(path, hable_view()), folder);
    const std::string first = read(path);
    // Without options the earlier ones are repeated.
    EXPECT_EQ(extend_config(path, {}, true).text, first);
    ConfigOptions other;
    other.views = {"reinhard"};
    const ExtendedConfig updated = extend_config(path, other, true);
    EXPECT_EQ(updated.text.find("Hable"), std::string::npos);
    EXPECT_NE(updated.text.find("Reinhard"), std::string::npos);
}

TEST(ReduceConfig, RefusesWhatWasEditedOrNeverAdded) {
    const Folder folder;
    const std::string path = folder / "studio.ocio";
    write(path, kOwn);
    EXPECT_THROW((void)reduce_config(path), FileError) << "nothing was added";
    EXPECT_THROW((void)reduce_config(folder / "none.ocio"), FileError);
    EXPECT_THROW((void)extend_config(folder / "none.ocio", hable_view()), FileError);
    apply(extend_config(path, hable_view()), folder);
    std::string edited = read(path);
    const std::size_t at = edited.find("Hable");
    ASSERT_NE(at, std::string::npos);
    write(path, edited.replace(at, 5, "Table"));
    EXPECT_THROW((void)reduce_config(path), FileError);
    write(path, "no config");
    EXPECT_THROW((void)extend_config(path, hable_view()), FileError);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
