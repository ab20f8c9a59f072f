// SPDX-License-Identifier: Apache-2.0
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <array>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "tonewright/error.h"
#include "tonewright/image_io.h"
#include "tonewright/tonemap.h"
#include "tonewright/view.h"
#include "unit/folder.h"
#include "unit/image/picture_files.h"
#include "unit/image/pictures.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

TEST(FileTags, FormatsWithoutColorTagsWarn) {
    const Folder folder;
    const auto warning = [&](const char* display, const char* name) {
        const std::vector<std::string> all = warnings_of(shown_on(display), folder / name);
        EXPECT_LE(all.size(), 1U);
        return all.empty() ? std::string() : all[0];
    };
    EXPECT_EQ(warning("rec2100_pq", "a.jpg"),
              "JPEG does not say that its colors are Rec.2100-PQ: viewers assume sRGB; "
              "gradients in 8 bits show bands");
    EXPECT_EQ(warning("rec2100_hlg", "a.tif"),
              "TIFF does not say that its colors are Rec.2100-HLG: viewers assume sRGB");
    EXPECT_EQ(warning("display_p3", "a.webp"),
              "WebP does not say that its colors are Display P3: viewers assume sRGB");
    EXPECT_EQ(warning("srgb", "a.hdr"),
              "most applications read Radiance HDR as linear light, but the file holds code values "
              "of sRGB; for linear light, use <<display=linear>>");
    EXPECT_EQ(warning("srgb", "a.exr"),
              "most applications read OpenEXR as linear light, but the file holds code values of "
              "sRGB; for linear light, use <<display=linear>>");
    EXPECT_EQ(warning("srgb", "a.webp"), "");
    EXPECT_EQ(warning("linear", "a.hdr"), "");
    EXPECT_EQ(warning("linear", "a.exr"), "");
    EXPECT_EQ(warning("rec2100_pq", "a.exr"),
              "most applications read OpenEXR as linear light, but the file holds code values of "
              "Rec.2100-PQ; for linear light, use <<display=linear>>");
    EXPECT_EQ(warnings_of(shown_on("srgb"), folder / "a.jpg", {.type = TypeDesc::UINT16}),
              std::vector<std::string>{"pixels are 8 bits, not 16 bits"});
}

TEST(PixelRange, ColorsBeyondHalfAreCounted) {
    const Folder folder;
    ImageSpec spec(10, 10, 4, TypeDesc::FLOAT);
    spec.channelnames = {"R", "G", "B", "Z"};
    ImageBuf picture(spec);
    OIIO::ImageBufAlgo::fill(picture, {65504.0F, -65504.0F, 65519.0F, 1e9F});
    const auto half = [&] {
        return warnings_of(picture, folder / "a.exr", {.type = TypeDesc::HALF});
    };
    // The largest half is 65504; numbers below 65520 round to it. Z is no color.
    EXPECT_EQ(half(), std::vector<std::string>());
    const std::vector<float> beyond = {0, -65520.0F, 0, 0};
    picture.setpixel(3, 4, 0, beyond.data());
    const std::vector<std::string> expected = {
        "1 % of the pixels are infinite, because half ends at 65504; <<pixel_type=float>> keeps "
        "them"};
    EXPECT_EQ(half(), expected);
    EXPECT_EQ(warnings_of(picture, folder / "a.exr", {.type = TypeDesc::FLOAT}),
              std::vector<std::string>());
    picture = picture.copy(TypeDesc::HALF);
    EXPECT_EQ(half(), expected);
}

TEST(FileTags, AWarningThatThrowsLeavesNothing) {
    const Folder folder;
    const std::string path = folder / "a.jpg";
    WriteOptions options;
    options.warn = [](const std::string& text) { throw std::runtime_error(text); };
    EXPECT_THROW(write_image_atomically(shown_on("rec2100_pq"), path, options), std::runtime_error);
    EXPECT_FALSE(fs::exists(path));
    EXPECT_EQ(std::distance(fs::directory_iterator(fs::path(path).parent_path()), {}), 0);
}

TEST(FileTags, AvifThatHoldsHevcIsAWarning) {
    if (!OIIO::ImageOutput::create("a.avif")) GTEST_SKIP() << "OpenImageIO without HEIF";
    const Folder folder;
    const std::string path = folder / "a.avif";
    const std::vector<std::string> warnings = warnings_of(shown_on("srgb"), path);
    // ISO/IEC 23000-22: AV1 has the brand avif, HEVC has heic.
    const bool is_avif = read(path).substr(8, 4) == "avif";
    EXPECT_EQ(warnings.size(), is_avif ? 0U : 1U);
    EXPECT_TRUE(warnings_of(shown_on("srgb"), folder / "a.heic").empty());
}

ImageBuf with_alpha(float alpha) {
    ImageBuf picture = make_picture(make_spec(6, 5, {"R", "G", "B", "A"}, TypeDesc::FLOAT));
    OIIO::ImageBufAlgo::fill(picture, {0.2F, 0.4F, 0.6F, alpha});
    return picture;
}

TEST(FileTags, AlphaThatIsZeroEverywhereIsAWarning) {
    const Folder folder;
    ImageBuf blank = with_alpha(0);
    for (const char* name : {"a.png", "a.tif"}) {
        const std::vector<std::string> warnings = warnings_of(blank, folder / name);
        ASSERT_EQ(warnings.size(), 1U) << name;
        EXPECT_TRUE(warnings[0].starts_with("alpha is 0 everywhere")) << warnings[0];
    }
    EXPECT_TRUE(warnings_of(blank, folder / "a.jpg").empty()) << "it has no alpha";
    EXPECT_TRUE(warnings_of(blank, folder / "a.exr").empty()) << "light without cover";
    OIIO::ImageBufAlgo::fill(blank, {0.0F, 0.0F, 0.0F, 0.0F});
    set(blank, 5, 4, {0.002F, 0.004F, 0.006F, 0.01F});
    EXPECT_TRUE(warnings_of(blank, folder / "a.png").empty());
}

TEST(FileTags, AlphaIsLeftOutOrMadeOpaque) {
    const Folder folder;
    using Alpha = WriteOptions::Alpha;
    for (const float alpha : {0.0F, 0.5F}) {
        const ImageBuf picture = with_alpha(alpha);
        for (const char* name : {"a.png", "a.tif", "a.exr"}) {
            const std::string path = folder / name;
            EXPECT_TRUE(warnings_of(picture, path, {.alpha = Alpha::ignore}).empty());
            ImageBuf back = read_image(path);
            EXPECT_EQ(back.nchannels(), 3) << name;
            EXPECT_NEAR(static_cast<double>(pixel(back, 3, 2)[2]), 0.6, 0.003) << name;
            EXPECT_TRUE(warnings_of(picture, path, {.alpha = Alpha::opaque}).empty());
            back = read_image(path);
            ASSERT_EQ(back.nchannels(), 4) << name;
            EXPECT_NEAR(static_cast<double>(pixel(back, 3, 2)[2]), 0.6, 0.003) << name;
            EXPECT_EQ(pixel(back, 3, 2)[3], 1.0F) << name;
        }
    }
}

TEST(FileTags, CompressionIsThatOfTheFormat) {
    const Folder folder;
    const ImageBuf picture = make_rgb(64, 64, TypeDesc::HALF);
    for (const char* name : {"none", "zip", "piz", "dwaa"}) {
        write_image_atomically(picture, folder / "a.exr", {.compression = name});
        EXPECT_EQ(read_image(folder / "a.exr").spec().get_string_attribute("compression"), name);
    }
    const auto size_of = [&](const char* name, const WriteOptions& options) {
        write_image_atomically(picture, folder / name, options);
        return read(folder / name).size();
    };
    EXPECT_LT(size_of("a.jpg", {.quality = 20}), size_of("a.jpg", {.quality = 95}));
    EXPECT_LT(size_of("a.jpg", {.compression = "jpeg:20"}),
              size_of("a.jpg", {.compression = "jpeg:95"}));
    EXPECT_LT(size_of("a.exr", {.compression = "dwaa:500"}),
              size_of("a.exr", {.compression = "dwaa:5"}));
    const auto refusal = [&](const char* name, const WriteOptions& options) {
        try {
            write_image_atomically(picture, folder / name, options);
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string("no error");
    };
    EXPECT_NE(refusal("b.exr", {.compression = "zap"}).find("did you mean zip"), std::string::npos);
    EXPECT_NE(refusal("b.bmp", {.compression = "zip"}).find("expected none"), std::string::npos);
    EXPECT_NE(refusal("b.png", {.quality = 50}).find("lossless"), std::string::npos);
    EXPECT_NE(refusal("b.exr", {.quality = 50}).find("dwaa"), std::string::npos);
    EXPECT_NE(refusal("b.jpg", {.quality = 101}).find("[1, 100]"), std::string::npos);
    EXPECT_NE(refusal("b.jpg", {.compression = "jpeg:x"}).find("quality"), std::string::npos);
    EXPECT_FALSE(fs::exists(folder / "b.exr"));
}

class WrittenPicture : public PictureFiles {};

TEST_F(WrittenPicture, TypeOfTheFormatOrTheRequestedOne) {
    const ImageBuf picture = noise_picture();
    write_image_atomically(picture, file("a.png"));
    EXPECT_EQ(read_image(file("a.png")).spec().format, TypeDesc::UINT8);
    write_image_atomically(picture, file("a.png"), TypeDesc::UINT16);
    EXPECT_EQ(read_image(file("a.png")).spec().format, TypeDesc::UINT16);
    write_image_atomically(picture, file("a.tif"), TypeDesc::UINT16);
    EXPECT_EQ(read_image(file("a.tif")).spec().format, TypeDesc::UINT16);
    write_image_atomically(picture, file("a.jpg"));
    EXPECT_EQ(read_image(file("a.jpg")).spec().format, TypeDesc::UINT8);
    write_image_atomically(picture, file("a.hdr"));
    EXPECT_EQ(read_image(file("a.hdr")).spec().format, TypeDesc::FLOAT);
    // A depth of the source does not overrule the type.
    ImageBuf tagged = picture;
    tagged.specmod().attribute("oiio:BitsPerSample", 10);
    write_image_atomically(tagged, file("a.tif"), TypeDesc::UINT16);
    EXPECT_EQ(read_image(file("a.tif")).spec().get_int_attribute("oiio:BitsPerSample", 16), 16);
}

TEST_F(WrittenPicture, FormatsWithoutProxies) {
    // SGI cannot be written to memory by OIIO 2.4: the other way through the code.
    const ImageBuf picture = noise_picture(3, TypeDesc::UINT8);
    write_image_atomically(picture, file("a.sgi"));
    EXPECT_EQ(OIIO::ImageBufAlgo::compare(picture, read_image(file("a.sgi")), 0, 0).maxerror, 0);
    EXPECT_EQ(files(), 1U);
}

TEST_F(WrittenPicture, PicturesWithMetadata) {
    // Attributes that tonemap() and cameras leave: writers make more blocks of a file then.
    ImageBuf picture(ImageSpec(16, 12, 3, TypeDesc::FLOAT));
    OIIO::ImageBufAlgo::fill(picture, {0.2F, 0.4F, 0.6F});
    picture.specmod().attribute("oiio:ColorSpace", "sRGB");
    picture.specmod().attribute("Exif:FNumber", 2.8F);
    picture.specmod().attribute("ImageDescription", "a picture");
    for (const char* name : {"a.exr", "a.png", "a.jpg", "a.tif", "a.hdr", "a.dpx", "a.tga", "a.bmp",
                             "a.ppm", "a.webp", "a.sgi"}) {
        write_image_atomically(picture, file(name));
        const ImageBuf back = read_image(file(name));
        // 8 bits, and lossy for JPEG and WebP.
        EXPECT_LE(OIIO::ImageBufAlgo::compare(picture, back, 1, 1).maxerror, 3.0 / 255) << name;
    }
}

TEST_F(WrittenPicture, ChannelsThatAFormatCannotHoldAreLeftOut) {
    ImageSpec spec(8, 8, 5, TypeDesc::FLOAT);
    spec.channelnames = {"R", "G", "B", "Z", "A"};
    spec.alpha_channel = 4;
    spec.z_channel = 3;
    ImageBuf picture(spec);
    OIIO::ImageBufAlgo::fill(picture, {0.25F, 0.5F, 0.75F, 7.0F, 1.0F});
    write_image_atomically(picture, file("a.png"));
    const ImageBuf png = read_image(file("a.png"));
    EXPECT_EQ(png.nchannels(), 4);
    EXPECT_FLOAT_EQ(png.getchannel(3, 3, 0, 3), 1);
    write_image_atomically(picture, file("a.hdr"));
    EXPECT_EQ(read_image(file("a.hdr")).nchannels(), 3);
    write_image_atomically(picture, file("a.jpg"));
    EXPECT_EQ(read_image(file("a.jpg")).nchannels(), 3);
    write_image_atomically(picture, file("a.exr"));
    EXPECT_EQ(read_image(file("a.exr")).nchannels(), 5);
}

TEST_F(WrittenPicture, FormatsWithoutDisplayWindowHoldTheDisplayWindow) {
    ImageSpec spec(10, 8, 3, TypeDesc::FLOAT);
    spec.x = -2;
    spec.y = 3;
    spec.full_x = 1;
    spec.full_y = 1;
    spec.full_width = 20;
    spec.full_height = 12;
    ImageBuf picture(spec);
    OIIO::ImageBufAlgo::fill(picture, {1.0F, 1.0F, 1.0F});
    write_image_atomically(picture, file("a.png"));
    const ImageBuf png = read_image(file("a.png"));
    EXPECT_EQ(png.roi(), OIIO::ROI(0, 20, 0, 12, 0, 1, 0, 3));
    EXPECT_EQ(png.getchannel(0, 1, 0, 0), 0);
    EXPECT_EQ(png.getchannel(0, 2, 0, 0), 1);
    EXPECT_EQ(png.getchannel(6, 2, 0, 0), 1);
    EXPECT_EQ(png.getchannel(7, 2, 0, 0), 0);
    write_image_atomically(picture, file("a.exr"));
    EXPECT_EQ(read_image(file("a.exr")).roi(), picture.roi());
    EXPECT_EQ(read_image(file("a.exr")).roi_full(), picture.roi_full());
    // Windows that differ on one side only.
    for (int side = 0; side < 4; ++side) {
        ImageSpec one(10, 8, 3, TypeDesc::FLOAT);
        one.full_x = side == 0 ? -1 : 0;
        one.full_y = side == 1 ? -1 : 0;
        one.full_width = side % 2 == 0 ? 11 : 10;
        one.full_height = side % 2 == 1 ? 9 : 8;
        ImageBuf filled(one);
        OIIO::ImageBufAlgo::fill(filled, {1.0F, 1.0F, 1.0F});
        write_image_atomically(filled, file("one.png"));
        const ImageBuf read = read_image(file("one.png"));
        EXPECT_EQ(read.roi(), OIIO::ROI(0, one.full_width, 0, one.full_height, 0, 1, 0, 3)) << side;
        EXPECT_EQ(read.getchannel(0, 0, 0, 0), side < 2 ? 0 : 1) << side;
        EXPECT_EQ(read.getchannel(one.full_width - 1, one.full_height - 1, 0, 0), side < 2 ? 1 : 0)
            << side;
    }
}

TEST_F(WrittenPicture, PngHasColorThatIsNotMultiplied) {
    ImageSpec spec(2, 1, 4, TypeDesc::FLOAT);
    spec.attribute("oiio:ColorSpace", "Gamma2.2");
    ImageBuf picture(spec);
    const std::array<float, 4> half_covered = {0.25F, 0.125F, 0.4F, 0.5F};
    const std::array<float, 4> uncovered = {0.25F, 0.125F, 0.4F, 0.0F};
    picture.setpixel(0, 0, half_covered.data());
    picture.setpixel(1, 0, uncovered.data());
    write_image_atomically(picture, file("a.png"), TypeDesc::UINT16);
    ImageSpec as_stored;
    as_stored.attribute("oiio:UnassociatedAlpha", 1);
    const ImageBuf stored(file("a.png"), 0, 0, nullptr, &as_stored);
    const std::string space = stored.spec().get_string_attribute("oiio:ColorSpace");
    EXPECT_TRUE(space == "Gamma2.2" || space == "g22_rec709_scene") << space;  // OpenImageIO 3.1
    constexpr float kStep = 1.0F / 65535;
    EXPECT_NEAR(stored.getchannel(0, 0, 0, 0), 0.5F, kStep);
    EXPECT_NEAR(stored.getchannel(0, 0, 0, 2), 0.8F, kStep);
    EXPECT_NEAR(stored.getchannel(0, 0, 0, 3), 0.5F, kStep);
    EXPECT_NEAR(stored.getchannel(1, 0, 0, 2), 0.4F, kStep);
    EXPECT_EQ(stored.getchannel(1, 0, 0, 3), 0);
    EXPECT_EQ(picture.spec().find_attribute("oiio:UnassociatedAlpha"), nullptr);
    // Straight color stays straight.
    picture.specmod().attribute("oiio:ColorSpace", "sRGB");
    write_image_atomically(picture, file("a.png"), TypeDesc::UINT16);
    EXPECT_NEAR(read_image(file("a.png")).getchannel(0, 0, 0, 0), 0.5F, 2 * kStep);
    // The type of the buffer is the type of the file, still.
    write_image_atomically(picture.copy(TypeDesc::UINT16), file("a.png"));
    EXPECT_EQ(read_image(file("a.png")).spec().format, TypeDesc::UINT16);
}

TEST_F(WrittenPicture, FailedWriteLeavesTheOldFile) {
    const ImageBuf picture = noise_picture();
    std::signal(SIGXFSZ, SIG_IGN);
    for (const char* name : {"a.exr", "a.png", "a.jpg", "a.tif", "a.hdr", "a.sgi"}) {
        const std::string path = file(name);
        const TypeDesc type = std::string(name) == "a.sgi" ? TypeDesc::UINT8 : TypeDesc::UNKNOWN;
        write_image_atomically(picture, path, type);
        const std::size_t size = read(path).size();
        write(path, "the old file");
        rlimit old{};
        ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
        // A full disk, at the middle of the file and at its last byte.
        for (const std::size_t limit : {size / 2, size - 1}) {
            rlimit small = old;
            small.rlim_cur = limit;
            ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
            const std::string message =
                message_of([&] { write_image_atomically(picture, path, type); });
            ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old), 0);
            expect_file_error(message, path, "");
            EXPECT_EQ(read(path), "the old file") << name;
            EXPECT_EQ(files(), 1U) << name;
        }
        fs::remove(path);
    }
    std::signal(SIGXFSZ, SIG_DFL);
}

TEST_F(WrittenPicture, FailedEncodingLeavesTheOldFile) {
    write(file("a.png"), "the old file");
    expect_file_error(message_of([&] { write_image_atomically(ImageBuf(), file("a.png")); }),
                      file("a.png"), "there is no picture");
    EXPECT_EQ(read(file("a.png")), "the old file");
    EXPECT_EQ(files(), 1U);
}

TEST_F(WrittenPicture, RefusesPathsThatCannotBeWritten) {
    const ImageBuf picture = noise_picture();
    const auto error = [&](const std::string& path) {
        return message_of([&] { write_image_atomically(picture, path); });
    };
    expect_file_error(error(file("missing/a.exr")), file("missing/a.exr"),
                      "No such file or directory");
    write(file("plain"), "x");
    expect_file_error(error(file("plain/a.exr")), file("plain/a.exr"), "Not a directory");
    fs::create_directory(file("folder.exr"));
    expect_file_error(error(file("folder.exr")), file("folder.exr"), "is a folder");
    expect_file_error(error(file("a.xyz")), file("a.xyz"), "xyz");
    expect_file_error(error(file("noextension")), file("noextension"), "no extension");
    expect_file_error(error("/dev/null"), "/dev/null", "is no regular file");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
