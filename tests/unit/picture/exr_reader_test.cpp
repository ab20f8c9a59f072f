// SPDX-License-Identifier: Apache-2.0
#include "picture/exr_reader.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/error.h"
#include "unit/folder.h"
#include "unit/picture/exr_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;

/// Blocks of tiles are left to OpenImageIO for those compressions of OpenEXR that are in its C++
/// library.
bool has_tiles(std::string_view compression) {
    return !compression.starts_with("b44") && !compression.starts_with("dwa");
}

/// Compares both readers.
void expect_same_reading(const std::string& path, int step = 64) {
    SCOPED_TRACE(path);
    std::string error;
    const std::vector<ReadPicture> expected = read_by_oiio(path, &error);
    ASSERT_EQ(error, "");
    const auto reader = open_exr(path, 2);
    ASSERT_TRUE(reader);
    const auto count = static_cast<int>(expected.size());
    ASSERT_FALSE(reader->has_picture(count));
    for (int i = 0; i < count; ++i) {
        ASSERT_TRUE(reader->has_picture(i));
        const ReadPicture& picture = expected[static_cast<std::size_t>(i)];
        expect_same_spec(picture.spec, reader->spec(i));
        EXPECT_TRUE(all_rows(*reader, i, step) == picture.pixels);
    }
}

class ExrReaderOf : public testing::TestWithParam<const char*> {};

TEST_P(ExrReaderOf, GivesThePixelsAndAttributesOfOpenImageIO) {
    const Folder folder;
    const std::vector<std::vector<std::string>> channels = {{"Y"},
                                                            {"R", "G", "B"},
                                                            {"R", "G", "B", "A"},
                                                            {"X", "Y"},
                                                            {"a.R", "a.G", "b.Z", "A", "Z"},
                                                            {"R", "G", "B", std::string(255, 'm')}};
    unsigned seed = 0;
    for (const TypeDesc& type : {OIIO::TypeHalf, OIIO::TypeFloat, OIIO::TypeUInt32}) {
        for (const auto& names : channels) {
            for (const auto& [width, height] : {std::pair(1, 1), {37, 21}, {131, 100}}) {
                for (const int tile : {0, 16, 48}) {
                    if (tile > 0 && !has_tiles(GetParam())) continue;
                    ImageSpec spec = spec_of_size(width, height, names, type);
                    spec.attribute("compression", GetParam());
                    spec.tile_width = tile;
                    spec.tile_height = tile / 2;
                    const std::string path = folder / "noise.exr";
                    write_by_oiio(path, {spec}, ++seed);
                    expect_same_reading(path, seed % 2 != 0 ? 64 : 7);
                    if (testing::Test::HasFailure()) {
                        FAIL() << type.c_str() << " " << width << " " << names.size() << " "
                               << tile;
                    }
                }
            }
        }
    }
}

TEST_P(ExrReaderOf, ConvertsChannelsOfDifferentTypesToFloat) {
    const Folder folder;
    for (const int tile : {0, 32}) {
        if (tile > 0 && !has_tiles(GetParam())) continue;
        ImageSpec spec = spec_of_size(45, 70, {"R", "G", "B", "A", "Z", "id"}, OIIO::TypeHalf);
        spec.channelformats = {OIIO::TypeHalf,  OIIO::TypeHalf,  OIIO::TypeHalf,
                               OIIO::TypeFloat, OIIO::TypeFloat, OIIO::TypeUInt32};
        spec.attribute("compression", GetParam());
        spec.tile_width = spec.tile_height = tile;
        write_by_oiio(folder / "mixed.exr", {spec}, 5);
        expect_same_reading(folder / "mixed.exr");
    }
}

TEST_P(ExrReaderOf, ReadsDamagedFilesAsOpenImageIOOrNotAtAll) {
    const Folder folder;
    ImageSpec spec = spec_of_size(30, 90, {"R", "G", "B"}, OIIO::TypeHalf);
    spec.attribute("compression", GetParam());
    write_by_oiio(folder / "whole.exr", {spec}, 3);
    const std::string whole = read(folder / "whole.exr");
    std::string error;
    const std::vector<std::byte> pixels = read_by_oiio(folder / "whole.exr", &error).at(0).pixels;
    const std::string path = folder / "damaged.exr";
    const auto expect_no_wrong_pixels = [&](bool is_truncated) {
        try {
            const auto reader = open_exr(path, 2);
            if (!reader) return;
            const double bytes =
                static_cast<double>(reader->spec(0).scanline_bytes()) * reader->spec(0).height;
            if (bytes > 1 << 24) return;  // PictureReader refuses it
            const std::vector<std::byte> given = all_rows(*reader, 0, 64);
            EXPECT_FALSE(is_truncated);
            error.clear();
            const std::vector<ReadPicture> expected = read_by_oiio(path, &error);
            if (expected.empty()) {
                EXPECT_TRUE(given == pixels) << error;
            } else {
                EXPECT_TRUE(given == expected[0].pixels);
            }
        } catch (const FileError& e) {
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        }
    };
    for (std::size_t part = 0; part < 50; ++part) {
        SCOPED_TRACE(part);
        write(path, whole.substr(0, whole.size() * part / 50));
        expect_no_wrong_pixels(true);
    }
    for (std::size_t i = 0; i < 400; ++i) {
        std::string damaged = whole;
        const std::size_t at = i * (whole.size() - 1) / 399;
        SCOPED_TRACE(at);
        damaged[at] = static_cast<char>(damaged[at] ^ static_cast<char>(1U << i % 8));
        write(path, damaged);
        expect_no_wrong_pixels(false);
    }
}

INSTANTIATE_TEST_SUITE_P(All, ExrReaderOf,
                         testing::Values("none", "rle", "zips", "zip", "piz", "pxr24", "b44",
                                         "b44a", "dwaa", "dwab"),
                         [](const auto& test) { return std::string(test.param); });

TEST(ExrReader, ReadsPartsOfAFile) {
    const Folder folder;
    for (const int tile : {0, 16}) {
        ImageSpec first = spec_of_size(45, 70, {"R", "G", "B", "A"}, OIIO::TypeHalf);
        first.attribute("oiio:subimagename", "rgba");
        first.attribute("view", "left");
        ImageSpec second = spec_of_size(12, 30, {"Z"}, OIIO::TypeFloat);
        second.attribute("oiio:subimagename", "depth");
        second.attribute("compression", "piz");
        first.tile_width = first.tile_height = second.tile_width = second.tile_height = tile;
        write_by_oiio(folder / "parts.exr", {first, second}, 7);
        expect_same_reading(folder / "parts.exr");
    }
}

TEST(ExrReader, ReadsRowsFromTheLastToTheFirst) {
    const Folder folder;
    ImageSpec spec = spec_of_size(45, 70, {"R", "G", "B"}, OIIO::TypeHalf);
    spec.attribute("openexr:lineOrder", "decreasingY");
    write_by_oiio(folder / "down.exr", {spec}, 7);
    expect_same_reading(folder / "down.exr");
}

TEST(ExrReader, LeavesOthersToOpenImageIO) {
    const Folder folder;
    EXPECT_FALSE(open_exr(folder / "missing.exr", 1));
    write(folder / "text.exr", "no picture");
    EXPECT_FALSE(open_exr(folder / "text.exr", 1));
    write(folder / "empty.exr", "");
    EXPECT_FALSE(open_exr(folder / "empty.exr", 1));
    EXPECT_FALSE(open_exr(folder.path(), 1));
    ImageSpec spec = spec_of_size(45, 70, {"R", "G", "B"}, OIIO::TypeHalf);
    spec.tile_width = spec.tile_height = 32;
    for (const char* compression : {"b44", "b44a", "dwaa", "dwab"}) {
        spec.attribute("compression", compression);
        write_by_oiio(folder / "other.exr", {spec}, 7);
        EXPECT_FALSE(open_exr(folder / "other.exr", 1)) << compression;
    }
}

/// Photographs, and files of reported cases.
TEST(ExrReader, ReadsSharedFilesAsOpenImageIO) {
    const char* shared = std::getenv("TONEWRIGHT_SHARED");
    const std::filesystem::path folder = std::filesystem::path(shared ? shared : "") / "data";
    std::error_code error;
    if (!shared || !std::filesystem::is_directory(folder, error))
        GTEST_SKIP() << "TONEWRIGHT_SHARED, the folder of data/hdr, is unset";
    int count = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.path().extension() != ".exr") continue;
        std::string reason;
        if (open_exr(entry.path().string(), 1)) {
            (void)read_by_oiio(entry.path().string(), &reason);
            if (reason.empty()) {
                expect_same_reading(entry.path().string());
                ++count;
            }
        }
    }
    EXPECT_GE(count, 8);  // the photographs alone are more
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
