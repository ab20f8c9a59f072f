// SPDX-License-Identifier: Apache-2.0
#include "image/openimageio_writers.h"

#include <OpenImageIO/imagebuf.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "unit/errors.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(AllWriters, EachFormatIsWrittenInParts) {
    const Folder folder;
    constexpr int kWidth = 5;
    constexpr int kHeight = 4;
    std::vector<float> pixels;
    for (int i = 0; i < kWidth * kHeight * 3; ++i)
        pixels.push_back(static_cast<float>(i) / (kWidth * kHeight * 3));
    // By a proxy, by name, in a format of ours with a compression that is not, and the last row
    // first.
    for (const std::string name : {"a.tga", "a.tif", "a.exr", "a.dpx", "b.exr"}) {
        PictureSpec spec;
        spec.width = spec.full_width = kWidth;
        spec.height = spec.full_height = kHeight;
        spec.nchannels = 3;
        spec.channelnames = {"R", "G", "B"};
        spec.format = OIIO::TypeDesc::FLOAT;
        WriteOptions options;
        if (name == "a.exr") options.compression = "dwaa";
        if (name == "b.exr") spec.attribute("openexr:lineOrder", "decreasingY");
        FileWriter writer(folder / name, options, 1, all_writers());
        writer.open(spec);
        EXPECT_EQ(writer.is_bottom_up(), name == "b.exr");
        for (const int half : {0, 1}) {
            const int first = writer.is_bottom_up() ? 2 - 2 * half : 2 * half;
            writer.write_rows({first, first + 2, OIIO::TypeDesc::FLOAT,
                               reinterpret_cast<const std::byte*>(
                                   &pixels[static_cast<std::size_t>(first) * kWidth * 3])});
        }
        writer.finish();
        OIIO::ImageBuf picture(folder / name);
        ASSERT_TRUE(picture.read(0, 0, true, OIIO::TypeDesc::FLOAT)) << name << picture.geterror();
        // Half a code of 8 bits and the rounding of floats in TGA; DWAA's quality 45 loses a
        // hundredth.
        const float bound = name == "a.tga" ? 0.501F / 255 : name == "a.exr" ? 0.01F : 1e-4F;
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                EXPECT_NEAR(picture.getchannel(x, y, 0, 1),
                            pixels[static_cast<std::size_t>((y * kWidth + x) * 3 + 1)], bound)
                    << name;
            }
        }
    }
}

TEST(AllWriters, UnknownFormatsAreNamed) {
    const Folder folder;
    EXPECT_EQ(error_of([&] { FileWriter(folder / "a", {}, 1, all_writers()); }),
              folder / "a" + ": cannot write: the name has no extension that selects a format");
    EXPECT_NE(error_of([&] {
                  FileWriter(folder / "a.qqq", {}, 1, all_writers());
              }).find("a.qqq: cannot write: "),
              std::string::npos);
    EXPECT_TRUE(folder.files().empty());
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
