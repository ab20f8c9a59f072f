// SPDX-License-Identifier: Apache-2.0
#include "picture/exr_writer.h"

#include <OpenImageIO/imageio.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/error.h"
#include "unit/errors.h"
#include "unit/folder.h"
#include "unit/picture/exr_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;

class ExrWriterOf : public testing::TestWithParam<const char*> {};

TEST_P(ExrWriterOf, WritesThePixelsAndAttributesOfOpenImageIO) {
    const std::vector<std::vector<std::string>> channels = {{"Y"},
                                                            {"R", "G", "B"},
                                                            {"R", "G", "B", "A"},
                                                            {"v", "u"},
                                                            {"a.R", "a.G", "b.Z", "A", "Z"},
                                                            {"R", "G", "B", std::string(255, 'm')}};
    unsigned seed = 0;
    for (const TypeDesc& type : {OIIO::TypeHalf, OIIO::TypeFloat, OIIO::TypeUInt32}) {
        for (const auto& names : channels) {
            if (names.size() == 1 && std::string_view(GetParam()).starts_with("dwa")) continue;
            for (const auto& [width, height] : {std::pair(1, 1), {37, 21}, {131, 100}}) {
                ImageSpec spec = spec_of_size(width, height, names, type);
                spec.attribute("compression", GetParam());
                const std::size_t count = spec.image_pixels() * names.size();
                ++seed;
                expect_same_file(spec, type, noise_of(type, count, seed),
                                 seed % 2 != 0 ? std::vector<int>{64} : std::vector<int>{3, 1, 40});
                if (testing::Test::HasFailure())
                    FAIL() << type.c_str() << " " << width << " " << names.size();
            }
        }
    }
}

TEST_P(ExrWriterOf, StoresBlocksThatDoNotBecomeSmaller) {
    ImageSpec spec = spec_of_size(64, 40, {"R", "G", "B"}, OIIO::TypeHalf);
    spec.attribute("compression", GetParam());
    // Bits of a random generator, which nothing can compress.
    std::mt19937 random(3);
    std::vector<std::byte> pixels(spec.image_bytes());
    for (std::byte& byte : pixels)
        byte = static_cast<std::byte>(random());
    expect_same_file(spec, OIIO::TypeHalf, pixels, {64});
}

INSTANTIATE_TEST_SUITE_P(All, ExrWriterOf,
                         testing::Values("none", "rle", "zips", "zip", "piz", "pxr24", "b44",
                                         "b44a", "dwaa", "dwab", "dwaa:200", "dwab:1"),
                         [](const auto& test) {
                             std::string name = test.param;
                             std::replace(name.begin(), name.end(), ':', '_');
                             return name;
                         });

TEST(ExrWriter, RoundsFloatsAsOpenImageIO) {
    const std::vector<float> hard = {0.0F,
                                     -0.0F,
                                     1.0F,
                                     65504.0F,
                                     65519.99F,
                                     65520.0F,
                                     -1e30F,
                                     0x1p-14F,
                                     0x1p-24F,
                                     0x1p-25F,
                                     0x1.8p-25F,
                                     0x1.000002p-25F,
                                     1.00048828125F,
                                     1.00146484375F,
                                     3.3e-5F,
                                     6.1e-5F,
                                     std::numeric_limits<float>::infinity()};
    ImageSpec spec(static_cast<int>(hard.size()), 100, 1, OIIO::TypeHalf);
    std::vector<std::byte> pixels = noise_of(OIIO::TypeFloat, spec.image_pixels(), 5);
    for (std::size_t i = 0; i < pixels.size() / sizeof(float);
         ++i) {  // NaN: the test of nearest_half()
        float value = 0;
        std::memcpy(&value, &pixels[i * sizeof value], sizeof value);
        if (i < hard.size()) value = hard[i];
        if (value != value) value = 1;
        std::memcpy(&pixels[i * sizeof value], &value, sizeof value);
    }
    expect_same_file(spec, OIIO::TypeFloat, pixels, {7});
    spec.format = OIIO::TypeFloat;
    expect_same_file(spec, OIIO::TypeHalf, noise_of(OIIO::TypeHalf, spec.image_pixels(), 5), {7});
}

TEST(ExrWriter, LeavesOthersToOpenImageIO) {
    const Folder folder;
    const Descriptor file(folder / "none.exr");
    const auto is_left = [&](auto change) {
        PictureSpec spec = spec_of(ImageSpec(5, 5, 3, OIIO::TypeHalf));
        change(spec);
        return !create_exr(file.number(), spec, 1);
    };
    EXPECT_FALSE(is_left([](PictureSpec&) {}));
    EXPECT_TRUE(is_left([](PictureSpec& spec) { spec.tile_width = spec.tile_height = 16; }));
    EXPECT_TRUE(is_left([](PictureSpec& spec) { spec.deep = true; }));
    EXPECT_TRUE(is_left([](PictureSpec& spec) { spec.depth = 2; }));
    EXPECT_TRUE(is_left([](PictureSpec& spec) { spec.nchannels = 0; }));
    EXPECT_TRUE(is_left([](PictureSpec& spec) {
        spec.channelformats = {OIIO::TypeHalf, OIIO::TypeHalf, OIIO::TypeFloat};
    }));
    EXPECT_TRUE(is_left([](PictureSpec& spec) {
        spec.nchannels = 1;
        spec.channelnames = {"Y"};
        spec.attribute("compression", "dwaa");
    }));
    EXPECT_TRUE(
        is_left([](PictureSpec& spec) { spec.attribute("openexr:lineOrder", "decreasingY"); }));
    EXPECT_TRUE(is_left([](PictureSpec& spec) { spec.channelnames[0] = std::string(256, 'a'); }));
}

TEST(ExrWriter, ReportsAFullDiskAndMissingRows) {
    const PictureSpec spec = spec_of(ImageSpec(500, 100, 3, OIIO::TypeHalf));
    const std::vector<std::byte> rows = noise_of(OIIO::TypeHalf, 500 * 100 * 3, 1);
    const int full = ::open("/dev/full", O_WRONLY);
    ASSERT_GE(full, 0);
    int error_number = 0;
    try {
        const auto writer = create_exr(full, spec, 1);
        ASSERT_TRUE(writer);
        writer->write_rows(100, OIIO::TypeHalf, rows.data());
    } catch (const FileError& e) {
        error_number = e.problem().error_number;
    }
    ::close(full);
    EXPECT_EQ(error_number, ENOSPC);

    const Folder folder;
    const Descriptor file(folder / "short.exr");
    const auto writer = create_exr(file.number(), spec, 1);
    writer->write_rows(99, OIIO::TypeHalf, rows.data());
    EXPECT_EQ(error_of([&] { writer->finish(); }), "96 of 100 rows were written");
}

TEST(ExrWriter, TakesTheLevelOfZlibAsQuality) {
    ImageSpec spec(200, 100, 3, OIIO::TypeHalf);
    const std::vector<std::byte> rows = noise_of(OIIO::TypeHalf, 200 * 100 * 3, 1);
    const Folder folder;
    const auto size_at = [&](const std::string& compression) {
        spec.attribute("compression", compression);
        write_by_us(folder / "level.exr", spec_of(spec), OIIO::TypeHalf, rows, {100});
        return read(folder / "level.exr").size();
    };
    EXPECT_LT(size_at("zip:9"), size_at("zip"));
    EXPECT_EQ(size_at("zip:4"), size_at("zip"));
    EXPECT_NE(size_at("zip:1"), size_at("zip"));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
