// SPDX-License-Identifier: Apache-2.0
#include "picture/png_writer.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/half_value.h"
#include "picture/png_chunks.h"
#include "tonewright/error.h"
#include "unit/folder.h"
#include "unit/picture/written_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;

constexpr int kAllRows = 1 << 20;

template <class T>
std::string write_ours(const std::string& path, const ImageSpec& spec, const TypeDesc& type,
                       const std::vector<T>& values, int batch = kAllRows, unsigned threads = 2) {
    const TestFile file(path);
    const std::unique_ptr<RowWriter> writer = create_png(file, picture_spec(spec), threads);
    if (!writer) return {};
    give_rows(*writer, type, values, batch);
    EXPECT_EQ(fault_of_png(path, writer->spec()), "");
    return read(path);
}

std::string write_ours(const std::string& path, const ImageSpec& spec,
                       const std::vector<float>& values, int batch = kAllRows,
                       unsigned threads = 2) {
    return write_ours(path, spec, TypeDesc::FLOAT, values, batch, threads);
}

void expect_equal_pixels(const ImageSpec& spec, const std::vector<float>& values) {
    const Folder folder;
    ASSERT_NE(write_ours(folder / "ours.png", spec, values), "");
    write_by_oiio(folder / "oiio.png", spec, values);
    const std::vector<unsigned char> ours = codes_of(folder / "ours.png");
    ASSERT_FALSE(ours.empty());
    EXPECT_EQ(ours, codes_of(folder / "oiio.png"))
        << spec.width << " x " << spec.height << ", " << spec.nchannels << " channels of "
        << spec.format.c_str();
}

TEST(PngWriter, PixelsEqualThoseOfOpenImageIO) {
    for (const TypeDesc type : {TypeDesc::UINT8, TypeDesc::UINT16}) {
        for (int channels = 1; channels <= 4; ++channels) {
            for (const auto& [width, height] :
                 std::vector<std::pair<int, int>>{{1, 1}, {1, 9}, {9, 1}, {13, 7}, {64, 64}}) {
                const ImageSpec spec = straight_spec(width, height, channels, type);
                for (const Content content :
                     {Content::noise, Content::flat, Content::ramp, Content::edges})
                    expect_equal_pixels(spec, values_of(spec, content));
            }
        }
    }
}

TEST(PngWriter, PixelsOfManyBlocksEqualThoseOfOpenImageIO) {
    // 700 rows of 4200 bytes: six blocks of half a megabyte; 300000 bytes: a row that is a block.
    for (const auto& [width, height] : std::vector<std::pair<int, int>>{{700, 700}, {150000, 3}}) {
        for (const Content content : {Content::noise, Content::flat, Content::ramp}) {
            const ImageSpec spec = straight_spec(width, height, 3, TypeDesc::UINT16);
            expect_equal_pixels(spec, values_of(spec, content));
        }
    }
}

TEST(PngWriter, BytesDependNeitherOnThreadsNorOnBatches) {
    const Folder folder;
    const ImageSpec spec = straight_spec(1000, 1500, 3, TypeDesc::UINT8);
    std::vector<float> values = values_of(spec, Content::ramp);
    for (std::size_t i = 0; i < values.size() / 2; ++i)
        values[i] = noise(static_cast<std::uint32_t>(i));
    const std::string expected = write_ours(folder / "a.png", spec, values, kAllRows, 1);
    for (unsigned threads = 0; threads <= 8; ++threads)
        EXPECT_TRUE(write_ours(folder / "a.png", spec, values, kAllRows, threads) == expected)
            << threads;
    for (const int batch : {1, 7, 64, 1499})
        EXPECT_TRUE(write_ours(folder / "a.png", spec, values, batch) == expected) << batch;
}

TEST(PngWriter, RowsMayHaveTheTypesOfTheInterface) {
    const Folder folder;
    for (const TypeDesc type : {TypeDesc::UINT8, TypeDesc::UINT16}) {
        const ImageSpec spec = straight_spec(256, 256, 1, type);
        std::vector<std::uint16_t> halves;
        std::vector<float> values;
        for (unsigned bits = 0; bits < 65536; ++bits) {
            halves.push_back(static_cast<std::uint16_t>(bits));
            values.push_back(static_cast<float>(half_value(bits)));
        }
        const std::string expected = write_ours(folder / "a.png", spec, values);
        EXPECT_TRUE(write_ours(folder / "a.png", spec, TypeDesc::HALF, halves) == expected);
        // Code values: the bits of the halves.
        const double most = type == TypeDesc::UINT8 ? 255 : 65535;
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = static_cast<float>(
                static_cast<double>(type == TypeDesc::UINT8 ? i % 256 : i) / most);
        const std::string of_codes = write_ours(folder / "a.png", spec, values);
        if (type == TypeDesc::UINT16) {
            EXPECT_TRUE(write_ours(folder / "a.png", spec, type, halves) == of_codes);
        } else {
            const std::vector<std::uint8_t> bytes(halves.begin(), halves.end());
            EXPECT_TRUE(write_ours(folder / "a.png", spec, type, bytes) == of_codes);
        }
    }
}

TEST(PngWriter, FilesAreAsSmallAsThoseOfOpenImageIO) {
    const Folder folder;
    const ImageSpec spec = straight_spec(800, 800, 3, TypeDesc::UINT8);
    const auto columns = static_cast<std::size_t>(spec.width);
    std::vector<float> photograph = values_of(spec, Content::ramp);
    std::vector<float> drawing(photograph.size());
    for (std::size_t i = 0; i < photograph.size(); ++i) {
        const std::size_t x = i / 3 % columns;
        const std::size_t y = i / 3 / columns;
        photograph[i] += 0.02F * noise(static_cast<std::uint32_t>(i));
        drawing[i] = (x / 5 * 7 + y / 5 * 3) % 11 < 4 ? 1.0F : 0.0F;
    }
    for (const std::vector<float>& values :
         {photograph, drawing, values_of(spec, Content::noise)}) {
        write_by_oiio(folder / "oiio.png", spec, values);
        const auto size = static_cast<double>(write_ours(folder / "ours.png", spec, values).size());
        // The limit for photographs, docs/performance.md.
        EXPECT_LE(size, 1.05 * static_cast<double>(read(folder / "oiio.png").size()));
    }
}

TEST(PngWriter, AttributesSelectTheCompression) {
    const Folder folder;
    ImageSpec spec = straight_spec(300, 900, 3, TypeDesc::UINT8);
    const std::vector<float> values = values_of(spec, Content::ramp);
    write_ours(folder / "a.png", spec, values);
    const std::vector<unsigned char> codes = codes_of(folder / "a.png");
    std::vector<std::size_t> sizes;
    for (const char* name : {"default", "filtered", "huffman", "rle", "fixed"}) {
        spec.attribute("compression", name);
        sizes.push_back(write_ours(folder / "a.png", spec, values).size());
        EXPECT_EQ(codes_of(folder / "a.png"), codes) << name;
    }
    EXPECT_GT(sizes[2], sizes[0]);  // a code of one bit at least for each byte
    spec.attribute("compression", "default");
    spec.attribute("png:compressionLevel", 0);
    EXPECT_GT(write_ours(folder / "a.png", spec, values).size(), codes.size());  // stored
    EXPECT_EQ(codes_of(folder / "a.png"), codes);
}

TEST(PngWriter, ChunksFollowTheHeader) {
    const Folder folder;
    const std::string path = folder / "a.png";
    const ImageSpec spec = straight_spec(5, 3, 3, TypeDesc::UINT16);
    const std::string chunks = cicp_chunk({9, 16}) + clli_chunk({});
    {
        const TestFile file(path);
        const std::unique_ptr<RowWriter> writer = create_png(file, picture_spec(spec), 1, chunks);
        ASSERT_TRUE(writer);
        give_rows(*writer, TypeDesc::FLOAT, values_of(spec, Content::noise), 1);
    }
    EXPECT_EQ(read(path).substr(kAfterPngHeader, chunks.size()), chunks);
    EXPECT_EQ(codes_of(path).size(), 5U * 3U * 3U * 2U);
}

TEST(PngWriter, SpecSaysWhatTheFileHolds) {
    const Folder folder;
    const TestFile file(folder / "a.png");
    ImageSpec spec(5, 3, 4, TypeDesc::HALF);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    const std::unique_ptr<RowWriter> writer = create_png(file, picture_spec(spec), 1);
    ASSERT_TRUE(writer);
    EXPECT_EQ(writer->spec().format, TypeDesc(TypeDesc::UINT8));
    EXPECT_EQ(writer->spec().alpha_channel, 3);
}

TEST(PngWriter, LeavesOtherPicturesToOpenImageIO) {
    const Folder folder;
    const TestFile file(folder / "a.png");
    const auto is_written = [&](const ImageSpec& spec) {
        return create_png(file, picture_spec(spec), 1) != nullptr;
    };
    ImageSpec spec = straight_spec(5, 3, 4, TypeDesc::UINT8);
    EXPECT_TRUE(is_written(spec));
    spec.erase_attribute("oiio:UnassociatedAlpha");
    EXPECT_FALSE(is_written(spec));
    EXPECT_FALSE(is_written(ImageSpec(5, 3, 5, TypeDesc::UINT8)));
    EXPECT_FALSE(is_written(ImageSpec(0, 3, 3, TypeDesc::UINT8)));
    spec = ImageSpec(5, 3, 3, TypeDesc::UINT8);
    spec.depth = 2;
    EXPECT_FALSE(is_written(spec));
    spec.depth = 1;
    spec.attribute("oiio:dither", 1);
    EXPECT_FALSE(is_written(spec));
    spec.format = TypeDesc::UINT16;  // which has no dither
    EXPECT_TRUE(is_written(spec));
    spec.attribute("png:filter", 16);
    EXPECT_FALSE(is_written(spec));
}

TEST(PngWriter, FullDiskIsAnError) {
    const ImageSpec spec = straight_spec(700, 700, 3, TypeDesc::UINT16);
    const TestFile full("/dev/full", O_WRONLY);
    const auto expect_full = [](const FileError& error) {
        EXPECT_EQ(error.problem().error_number, ENOSPC);
    };
    try {
        const auto writer = create_png(full, picture_spec(spec), 1);
        FAIL() << "the header was written";
    } catch (const FileError& error) {
        expect_full(error);
    }
    // The header fits, but the rows do not.
    const Folder folder;
    const TestFile file(folder / "a.png");
    const std::unique_ptr<RowWriter> writer = create_png(file, picture_spec(spec), 2);
    ASSERT_TRUE(writer);
    ASSERT_GE(::dup2(full, file), 0);
    try {
        give_rows(*writer, TypeDesc::FLOAT, values_of(spec, Content::noise), 64);
        FAIL() << "the rows were written";
    } catch (const FileError& error) {
        expect_full(error);
    }
}

TEST(PngWriter, MissingRowsAreAnError) {
    const Folder folder;
    const TestFile file(folder / "a.png");
    const std::unique_ptr<RowWriter> writer =
        create_png(file, picture_spec(straight_spec(5, 3, 3, TypeDesc::UINT8)), 1);
    ASSERT_TRUE(writer);
    const std::vector<float> row(15);
    writer->write_rows(1, TypeDesc::FLOAT, reinterpret_cast<const std::byte*>(row.data()));
    EXPECT_THROW(writer->finish(), FileError);
}

TEST(PngWriter, FaultNamesTheDifference) {
    const Folder folder;
    const std::string path = folder / "a.png";
    const ImageSpec spec = straight_spec(50, 30, 3, TypeDesc::UINT8);
    const std::string file = write_ours(path, spec, values_of(spec, Content::noise));
    const auto fault = [&](int width, int channels, TypeDesc type) {
        return fault_of_png(path, picture_spec(ImageSpec(width, 30, channels, type)));
    };
    EXPECT_EQ(fault(50, 3, TypeDesc::UINT8), "");
    EXPECT_EQ(fault(51, 3, TypeDesc::UINT8),
              "what was written reads back with size 50 x 30; expected 51 x 30");
    EXPECT_EQ(fault(50, 4, TypeDesc::UINT8),
              "what was written reads back with channels 3; expected 4");
    EXPECT_EQ(fault(50, 3, TypeDesc::UINT16),
              "what was written reads back with bits 8; expected 16");
    const std::string incomplete =
        "what was written cannot be read back: it is no complete PNG file";
    for (const std::string& damaged :
         {file.substr(0, file.size() - 1), file.substr(0, 20), std::string("P6"), std::string()}) {
        write(path, damaged);
        EXPECT_EQ(fault(50, 3, TypeDesc::UINT8), incomplete);
    }
    EXPECT_EQ(fault_of_png(folder / "none.png", picture_spec(spec)),
              "what was written cannot be read back: No such file or directory");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
