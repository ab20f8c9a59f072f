// SPDX-License-Identifier: Apache-2.0
#include "image/luminance_chroma.h"

#include <OpenEXR/ImfRgbaFile.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "tonewright/image_io.h"
#include "unit/errors.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

/// Colors whose chroma changes slowly, so that half its resolution holds it. Black has none: the
/// filters would ring beside it.
std::vector<Imf::Rgba> smooth_colors() {
    std::vector<Imf::Rgba> pixels;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const float light = 0.25F + 4.0F * static_cast<float>(x) / kWidth;
            const float warm = 0.5F + 0.3F * std::sin(static_cast<float>(y) / 10);
            pixels.emplace_back(half(light), half(light * warm), half(light * 0.4F), half(0.5F));
        }
    }
    return pixels;
}

void write_by_openexr(const std::string& path, const std::vector<Imf::Rgba>& pixels,
                      Imf::RgbaChannels channels) {
    Imf::RgbaOutputFile file(path.c_str(), kWidth, kHeight, channels);
    file.setFrameBuffer(pixels.data(), 1, kWidth);
    file.writePixels(kHeight);
}

TEST(LuminanceChroma, ColorsAreThoseThatWereEncoded) {
    const Folder folder;
    const std::vector<Imf::Rgba> pixels = smooth_colors();
    for (const Imf::RgbaChannels channels : {Imf::WRITE_YC, Imf::WRITE_YCA}) {
        write_by_openexr(folder / "a.exr", pixels, channels);
        const OIIO::ImageBuf picture = read_image(folder / "a.exr");
        ASSERT_EQ(picture.nchannels(), channels == Imf::WRITE_YCA ? 4 : 3);
        EXPECT_EQ(picture.spec().channelnames[0], "R");
        EXPECT_EQ(picture.spec().format, OIIO::TypeHalf);
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                const Imf::Rgba& is = pixels[static_cast<std::size_t>(y * kWidth + x)];
                // Chroma is rounded to seven bits of mantissa, and resampled.
                const float bound = 0.02F * is.r + 0.002F;
                EXPECT_NEAR(picture.getchannel(x, y, 0, 0), is.r, bound);
                EXPECT_NEAR(picture.getchannel(x, y, 0, 1), is.g, bound);
                EXPECT_NEAR(picture.getchannel(x, y, 0, 2), is.b, bound);
                if (channels == Imf::WRITE_YCA) {
                    EXPECT_EQ(picture.getchannel(x, y, 0, 3), 0.5F);
                }
            }
        }
    }
}

TEST(LuminanceChroma, OtherAndTruncatedFilesAreTold) {
    const Folder folder;
    write_by_openexr(folder / "rgb.exr", smooth_colors(), Imf::WRITE_RGB);
    EXPECT_EQ(open_luminance_chroma(folder / "rgb.exr"), nullptr);
    write_by_openexr(folder / "gray.exr", smooth_colors(), Imf::WRITE_Y);
    EXPECT_EQ(open_luminance_chroma(folder / "gray.exr"), nullptr);
    write_by_openexr(folder / "yc.exr", smooth_colors(), Imf::WRITE_YC);
    EXPECT_NE(open_luminance_chroma(folder / "yc.exr"), nullptr);
    std::filesystem::resize_file(folder / "yc.exr",
                                 std::filesystem::file_size(folder / "yc.exr") / 2);
    const std::string error = error_of([&] { (void)read_image(folder / "yc.exr"); });
    EXPECT_EQ(error.find(folder / "yc.exr" + ": cannot read: "), 0U) << error;
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
