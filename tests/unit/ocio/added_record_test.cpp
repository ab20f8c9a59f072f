// SPDX-License-Identifier: Apache-2.0
#include "ocio/added_record.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tonewright/error.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(AddedRecord, TakesOutWhatItPutIn) {
    const std::string original = "a: 1\nb: 2\nc: 3\n";
    AddedRecord record;
    // Insertions by the places of the original text.
    const std::vector<YamlText::Insertion> insertions = {{5, "new: 1\n"}, {10, "more: 2\n"}};
    const std::string result = "a: 1\nnew: 1\nb: 2\nmore: 2\nc: 3\n";
    record.add(insertions, result);
    ASSERT_EQ(record.pieces.size(), 2U);
    EXPECT_EQ(record.without(result, "x.ocio"), original);
    // Other changes of the config stay.
    EXPECT_EQ(record.without("# mine\n" + result + "d: 4\n", "x.ocio"),
              "# mine\n" + original + "d: 4\n");
    EXPECT_THROW((void)record.without("a: 1\nnew: 2\nb: 2\nmore: 2\nc: 3\n", "x.ocio"), FileError)
        << "edited";
}

TEST(AddedRecord, ReadsWhatItWrites) {
    const Folder folder;
    const std::string config = folder / "x.ocio";
    EXPECT_EQ(AddedRecord::path_of(config), "tonewright/x.ocio.yaml");
    EXPECT_FALSE(AddedRecord::find(config, "a: 1\n")) << "no record";
    EXPECT_THROW((void)AddedRecord::read(config, "a: 1\n"), FileError);
    AddedRecord record;
    record.pieces = {{"before: \"quoted\"\n", "piece: [1]\n"}};
    record.files = {"tonewright/a_0123456789abcdef.clf"};
    record.options.views = {"AgX", "agx_blender:look=punchy"};
    record.custom = {{"Mine", "hable"}};
    record.options.exposure_stops = {-1, 0.5};
    std::filesystem::create_directories(folder / "tonewright");
    write(folder / AddedRecord::path_of(config), record.text("a: 1\n"));
    const AddedRecord read_back = AddedRecord::read(config, "a: 1\n");
    ASSERT_EQ(read_back.pieces.size(), 1U);
    EXPECT_EQ(read_back.pieces[0].before, record.pieces[0].before);
    EXPECT_EQ(read_back.pieces[0].text, record.pieces[0].text);
    EXPECT_EQ(read_back.files, record.files);
    EXPECT_EQ(read_back.options.views, record.options.views);
    ASSERT_EQ(read_back.custom.size(), 1U);
    EXPECT_EQ(read_back.custom[0].name, "Mine");
    EXPECT_EQ(read_back.options.exposure_stops, record.options.exposure_stops);
    EXPECT_NE(AddedRecord::mark_of("a: 1\n"), AddedRecord::mark_of("a: 2\n"));
    // A file outside the folder of tables must not be removed later.
    record.files = {"../passwd"};
    write(folder / AddedRecord::path_of(config), record.text("a: 1\n"));
    EXPECT_THROW((void)AddedRecord::read(config, "a: 1\n"), FileError);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
