// SPDX-License-Identifier: Apache-2.0
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "tonewright/error.h"
#include "tonewright/image_io.h"
#include "unit/image/picture_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

class ImageFile : public PictureFiles {};

/// OpenImageIO 2.4 keeps what a reader reported by its address and thread. A reader that another
/// thread destroys leaves it behind, for the next reader at that address.
TEST_F(ImageFile, ErrorsOfOtherReadersAreNotThisOnes) {
    write_image_atomically(noise_picture(3, TypeDesc::UINT8), file("good.sgi"), WriteOptions{});
    write(file("bad.sgi"), "no picture");
    for (int i = 0; i < 50; ++i) {
        std::unique_ptr<OIIO::ImageInput> bad = OIIO::ImageInput::create("sgi");
        ImageSpec spec;
        ASSERT_FALSE(bad->open(file("bad.sgi"), spec));
        std::thread([&] { bad.reset(); }).join();
        EXPECT_EQ(message_of([&] { (void)read_image(file("good.sgi")); }), "no error");
    }
}

TEST_F(ImageFile, RoundTrip) {
    const ImageBuf picture = noise_picture(4);
    for (const char* type : {"half", "float"}) {
        write_image_atomically(picture, file("a.exr"), parse_pixel_type(type));
        const ImageBuf back = read_image(file("a.exr"));
        EXPECT_EQ(back.spec().format, TypeDesc(type));
        EXPECT_EQ(back.nchannels(), 4);
        const auto difference = OIIO::ImageBufAlgo::compare(picture, back, 1e-3F, 1e-3F);
        EXPECT_LE(difference.maxerror, std::string(type) == "half" ? std::exp2(-12) : 0.0);
    }
    EXPECT_EQ(files(), 1U);
}

TEST_F(ImageFile, FolderWithoutPermission) {
    if (::geteuid() == 0) GTEST_SKIP() << "root may write into any folder";
    fs::create_directory(file("locked"));
    fs::permissions(file("locked"), fs::perms::owner_read | fs::perms::owner_exec);
    const std::string path = file("locked/a.exr");
    expect_file_error(message_of([&] { write_image_atomically(noise_picture(), path); }), path,
                      "Permission denied");
}

TEST_F(ImageFile, LinksAndPermissionsStay) {
    const ImageBuf picture = noise_picture();
    write(file("target.png"), "old");
    fs::permissions(file("target.png"), fs::perms::owner_read | fs::perms::owner_write);
    fs::create_symlink("target.png", file("link.png"));
    write_image_atomically(picture, file("link.png"));
    EXPECT_TRUE(fs::is_symlink(file("link.png")));
    EXPECT_EQ(read_image(file("target.png")).spec().width, 160);
    EXPECT_EQ(fs::status(file("target.png")).permissions(),
              fs::perms::owner_read | fs::perms::owner_write);
    EXPECT_EQ(files(), 2U);
}

TEST_F(ImageFile, LongNames) {
    const std::string name = std::string(250, 'n') + ".png";
    write_image_atomically(noise_picture(), file(name));
    EXPECT_EQ(read_image(file(name)).spec().height, 120);
}

TEST(PixelType, Names) {
    EXPECT_EQ(parse_pixel_type("uint8"), TypeDesc::UINT8);
    EXPECT_EQ(parse_pixel_type("uint16"), TypeDesc::UINT16);
    EXPECT_EQ(parse_pixel_type("half"), TypeDesc::HALF);
    EXPECT_EQ(parse_pixel_type("float"), TypeDesc::FLOAT);
    try {
        (void)parse_pixel_type("flaot");
        FAIL();
    } catch (const Error& e) {
        EXPECT_STREQ(
            e.what(),
            "pixel type is flaot; expected uint8, uint16, half or float; did you mean float?");
    }
    EXPECT_THROW((void)parse_pixel_type(""), Error);
}

TEST(WriteOptions, AlphaIsReadFromItsText) {
    using Alpha = WriteOptions::Alpha;
    WriteOptions options;
    for (const auto& [text, alpha] : std::vector<std::pair<const char*, Alpha>>{
             {"ignore", Alpha::ignore}, {"opaque", Alpha::opaque}, {"keep", Alpha::keep}}) {
        set_alpha(options, text);
        EXPECT_EQ(options.alpha, alpha) << text;
    }
    set_alpha(options, "over:0,0.5,1");
    EXPECT_EQ(options.alpha, Alpha::over);
    EXPECT_EQ(options.background, (std::array<float, 3>{0, 0.5F, 1}));
    for (const char* text : {"", "overlay", "over", "over:", "over:1", "over:1,1", "over:1,1,1,1",
                             "over:1,1,2", "over:-0.1,0,0", "over:nan,0,0", "over:0,0,0x"})
        EXPECT_THROW(set_alpha(options, text), Error) << text;
}

TEST(WriteOptions, PixelTypeHasTheBitsOfDpx) {
    WriteOptions options;
    set_pixel_type(options, "uint10");
    EXPECT_EQ(options.bits, 10);
    EXPECT_EQ(options.type, OIIO::TypeDesc(OIIO::TypeDesc::UINT16));
    set_pixel_type(options, "half");
    EXPECT_EQ(options.bits, 0) << "those of before are gone";
    EXPECT_EQ(options.type, OIIO::TypeDesc(OIIO::TypeDesc::HALF));
    EXPECT_THROW(set_pixel_type(options, "uint14"), Error);
}

TEST(AssociatedAlpha, MultipliesColorThatIsNot) {
    OIIO::ImageSpec spec(2, 1, 4, OIIO::TypeDesc::FLOAT);
    const float pixels[] = {0.8F, 0.4F, 2.0F, 0.5F, 0.3F, 0.2F, 0.1F, 0.0F};
    const auto picture = [&](bool is_unassociated) {
        OIIO::ImageSpec own = spec;
        if (is_unassociated) own.attribute("oiio:UnassociatedAlpha", 1);
        OIIO::ImageBuf buffer(own);
        EXPECT_TRUE(buffer.set_pixels(buffer.roi(), OIIO::TypeDesc::FLOAT, pixels));
        return buffer;
    };
    const OIIO::ImageBuf same = with_associated_alpha(picture(false));
    const OIIO::ImageBuf multiplied = with_associated_alpha(picture(true));
    EXPECT_EQ(multiplied.spec().get_int_attribute("oiio:UnassociatedAlpha", 0), 0);
    for (int x = 0; x < 2; ++x) {
        const float alpha = pixels[4 * x + 3];
        for (int c = 0; c < 4; ++c) {
            const float value = pixels[4 * x + c];
            EXPECT_EQ(same.getchannel(x, 0, 0, c), value);
            EXPECT_EQ(multiplied.getchannel(x, 0, 0, c), c == 3 ? value : value * alpha)
                << "alpha 0 makes black";
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
