// SPDX-License-Identifier: Apache-2.0
#include "image/written_picture.h"

#include <OpenImageIO/imagebuf.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "image/spec_conversion.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 16;
constexpr int kHeight = 8;

/// Pixels of a ramp, in a file of 8 bits.
WrittenFile written_ramp(const Folder& folder, const std::string& name,
                         std::vector<float>& pixels) {
    OIIO::ImageSpec spec(kWidth, kHeight, 3, OIIO::TypeDesc::UINT8);
    for (std::size_t i = 0; i < std::size_t{3} * kWidth * kHeight; ++i)
        pixels.push_back(static_cast<float>(i % 256) / 255);
    OIIO::ImageBuf picture(spec);
    EXPECT_TRUE(picture.set_pixels(picture.roi(), OIIO::TypeFloat, pixels.data()));
    const std::string path = folder / name;
    EXPECT_TRUE(picture.write(path));
    return {.path = path, .spec = picture_spec(spec), .format = name.substr(name.find('.') + 1)};
}

TEST(FaultOfWritten, SizeChannelsTypeAndWindowAreCompared) {
    const Folder folder;
    std::vector<float> pixels;
    WrittenFile written = written_ramp(folder, "a.png", pixels);
    EXPECT_EQ(fault_of(written), "");
    WrittenFile other = written;
    other.spec.width = 17;
    EXPECT_EQ(fault_of(other), "what was written reads back with size 16 x 8; expected 17 x 8");
    other = written;
    other.spec.nchannels = 4;
    EXPECT_EQ(fault_of(other), "what was written reads back with channels 3; expected 4");
    other = written;
    other.spec.format = OIIO::TypeDesc::UINT16;
    EXPECT_EQ(fault_of(other), "what was written reads back with type uint8; expected uint16");
}

TEST(FaultOfWritten, PixelsAreCompared) {
    const Folder folder;
    std::vector<float> pixels;
    WrittenFile written = written_ramp(folder, "a.png", pixels);
    written.pixels = &pixels;
    EXPECT_EQ(fault_of(written), "");
    pixels[100] += 0.1F;
    EXPECT_EQ(fault_of(written), "what was written reads back with pixels that differ by 0.1");
    std::vector<float> shown;
    WrittenFile lossy = written_ramp(folder, "a.jpeg", shown);
    lossy.pixels = &shown;
    EXPECT_EQ(fault_of(lossy), "");
    for (float& value : shown)
        value = 1;
    EXPECT_NE(fault_of(lossy).find("on average"), std::string::npos);
}

TEST(FaultOfWritten, IncompleteFilesAreFound) {
    const Folder folder;
    std::vector<float> pixels;
    WrittenFile written = written_ramp(folder, "a.png", pixels);
    fs::resize_file(written.path, fs::file_size(written.path) / 2);
    written.is_opened_by_name = true;
    EXPECT_EQ(fault_of(written).find("what was written cannot be read back (disk full?)"), 0U);
    fs::resize_file(written.path, 0);
    EXPECT_EQ(fault_of(written).find("what was written cannot be read back (disk full?): "), 0U);
    written.codec = "avif";
    EXPECT_NE(fault_of(written).find("not AV1"), std::string::npos);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
