// SPDX-License-Identifier: Apache-2.0
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <latch>
#include <string>
#include <thread>
#include <vector>

#include "image/picture_file.h"
#include "tonewright/error.h"
#include "tonewright/image_io.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap.h"
#include "tonewright/view.h"
#include "unit/folder.h"
#include "unit/image/picture_files.h"
#include "unit/image/pictures.h"

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/lsan_interface.h>

using ScopedLeaksOfOthers = __lsan::ScopedDisabler;
#else
struct ScopedLeaksOfOthers {
    ScopedLeaksOfOthers() {}  // not trivial: no warning about an unused variable
};
#endif

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

TEST(FileTags, DisplayWindowsOfEmptySpaceAreBounded) {
    const Folder folder;
    ImageBuf picture = make_rgb(8, 8);
    const auto show_in = [&](int size) {
        picture.specmod().full_width = picture.specmod().full_height = size;
    };
    show_in(1'000'000);
    try {
        write_image_atomically(picture, folder / "a.png");
        FAIL() << "no error";
    } catch (const FileError& e) {
        EXPECT_NE(std::string(e.what()).find("1000000 x 1000000"), std::string::npos) << e.what();
    }
    EXPECT_FALSE(fs::exists(folder / "a.png"));
    write_image_atomically(picture, folder / "a.exr");  // which has display windows
    show_in(20);
    WriteOptions few;
    few.max_pixels = 399;
    EXPECT_THROW(write_image_atomically(picture, folder / "a.png", few), FileError);
    few.max_pixels = 400;
    write_image_atomically(picture, folder / "a.png", few);
    // More rows than one batch of black has.
    show_in(3000);
    picture.specmod().full_height = 1000;
    picture.set_origin(0, 600);
    picture.specmod().full_y = 0;
    write_image_atomically(picture, folder / "a.png", TypeDesc::UINT8);
    const ImageBuf back = read_image(folder / "a.png");
    EXPECT_EQ(back.spec().height, 1000);
    ImageBuf wanted(ImageSpec(3000, 1000, 3, TypeDesc::FLOAT));
    OIIO::ImageBufAlgo::paste(wanted, 0, 0, 0, 0, picture);
    EXPECT_LE(OIIO::ImageBufAlgo::compare(wanted, back, 1, 1).maxerror, 0.51 / 255);
}

TEST(FileTags, FilesThatDeclareMoreThanTheyCanHoldAreRefused) {
    const Folder folder;
    const std::string path = folder / "a.ppm";
    std::ofstream(path, std::ios::binary) << "P6 60000 60000 255\n";
    try {
        (void)read_image(path);
        FAIL() << "no error";
    } catch (const FileError& e) {
        const std::string text = e.what();
        EXPECT_TRUE(text.find("declares 60000 x 60000 pixels") != std::string::npos ||
                    text.find("from a 19 byte file") != std::string::npos)  // OpenImageIO 3.1
            << text;
    }
}

/// A picture for a file with the type that its format has. OIIO 2.4 cannot read its own JPEG 2000
/// files of some 20 pixels each way.
ImageBuf picture_for(const std::string& format) {
    const bool is_depth = format == "zfile";
    return make_picture(make_spec(
        64, 48, is_depth ? std::vector<std::string>{"Z"} : std::vector<std::string>{"R", "G", "B"},
        is_depth ? TypeDesc::FLOAT : TypeDesc::UINT8));
}

TEST(FileTags, EveryFormatThatIsWrittenIsReadAndToneMapped) {
    const Folder folder;
    std::vector<std::string> formats;
    OIIO::Strutil::split(OIIO::get_string_attribute("output_format_list"), formats, ",");
    std::vector<std::string> extensions;
    OIIO::Strutil::split(OIIO::get_string_attribute("extension_list"), extensions, ";");
    int count = 0;
    for (const std::string& format : formats) {
        if (format == "null" || format == "term") continue;  // no files
        std::string extension;
        for (const std::string& row : extensions) {
            if (row.starts_with(format + ":"))
                extension = row.substr(format.size() + 1, row.find(',') - format.size() - 1);
        }
        const std::string path = folder / ("a." + extension);
        const std::string out = folder / ("out." + extension);
        const ImageBuf picture = picture_for(format);
        ASSERT_TRUE(picture.write(path)) << format << ": " << picture.geterror();
        const ImageBuf back = read_image(path);
        EXPECT_EQ(static_cast<int>(back.spec().channelnames.size()), back.nchannels()) << format;
        const Tonemapper tonemapper(
            {.op = resolve_picture_operator("hable"), .input = "lin_rec709"});
        tonemap_file(tonemapper, path, folder / "shown.exr");
        EXPECT_EQ(read_image(folder / "shown.exr").spec().width, 64) << format;
        // The library, with OIIO's own reader.
        const ImageBuf lazy(path);
        EXPECT_FALSE(tonemap(lazy, {.op = resolve_picture_operator("hable"), .input = "lin_rec709"})
                         .has_error())
            << format;
        tonemap_file(tonemapper, path, out);
        EXPECT_EQ(read_image(out).spec().height, 48) << format;
        ++count;
    }
    EXPECT_GE(count, 10);
}

TEST(FileTags, TruncatedDpxFilesAreErrors) {
    const Folder folder;
    const std::string path = folder / "a.dpx";
    for (const int bits : {8, 10, 12, 16}) {
        for (const char* packing : {"Packed", "Filled, method A", "Filled, method B"}) {
            ImageBuf picture = make_rgb(23, 17, bits == 8 ? TypeDesc::UINT8 : TypeDesc::UINT16);
            picture.specmod().attribute("oiio:BitsPerSample", bits);
            picture.specmod().attribute("dpx:Packing", packing);
            ASSERT_TRUE(picture.write(path)) << picture.geterror();
            const std::string whole = read(path);
            EXPECT_NO_THROW((void)read_image(path)) << bits << " " << packing;
            for (const std::size_t lost : {40, 600}) {
                std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() - lost);
                EXPECT_THROW((void)read_image(path), FileError) << bits << " " << packing;
            }
        }
    }
}

class ReadPicture : public PictureFiles {};

TEST_F(ReadPicture, TruncatedFilesAreErrors) {
    // ImageBuf::read() finds nothing wrong with a truncated TIFF or JPEG file.
    const ImageBuf picture = noise_picture();
    for (const char* name :
         {"a.exr", "a.hdr", "a.png", "a.tif", "a.jpg", "a.ppm", "a.dpx", "a.tga", "a.sgi"}) {
        const std::string path = file(name);
        const TypeDesc type = std::string(name) == "a.sgi" ? TypeDesc::UINT8 : TypeDesc::UNKNOWN;
        write_image_atomically(picture, path, type);
        const std::string whole = read(path);
        ASSERT_NO_THROW((void)read_image(path)) << name;
        for (const double part : {0.9, 0.5, 0.1, 0.001}) {
            write(path, whole.substr(
                            0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
            // OIIO 2.4's PNG reader loses a string when libpng jumps out of it.
            const ScopedLeaksOfOthers ignored;
            expect_file_error(message_of([&] { (void)read_image(path); }), path, "");
        }
    }
}

TEST_F(ReadPicture, RefusesFilesThatAreNotPictures) {
    const auto read = [&](const std::string& path) {
        return message_of([&] { (void)read_image(path); });
    };
    expect_file_error(read(file("missing.exr")), file("missing.exr"), "No such file or directory");
    expect_file_error(read(folder_.path()), folder_.path(), "is a folder");
    write(file("empty.exr"), "");
    expect_file_error(read(file("empty.exr")), file("empty.exr"), "the file is empty");
    write(file("text.exr"), "certainly no picture, and long enough to have a header of some kind");
    expect_file_error(read(file("text.exr")), file("text.exr"), "");
    write(file("text.txt"), "certainly no picture");
    expect_file_error(read(file("text.txt")), file("text.txt"), "");
}

TEST_F(ReadPicture, DeepPicturesAreRefused) {
    ImageSpec spec(2, 2, 5, TypeDesc::FLOAT);
    spec.channelnames = {"R", "G", "B", "A", "Z"};
    spec.deep = true;
    const ImageBuf deep(spec);
    ASSERT_TRUE(deep.write(file("deep.exr"))) << deep.geterror();
    expect_file_error(message_of([&] { (void)read_image(file("deep.exr")); }), file("deep.exr"),
                      "the picture is deep; expected flat pixels");
    expect_file_error(message_of([&] { write_image_atomically(deep, file("a.exr")); }),
                      file("a.exr"), "deep");
}

TEST_F(ReadPicture, ReadsAChangedFileAgain) {
    ImageBuf picture(ImageSpec(4, 4, 3, TypeDesc::FLOAT));
    for (const float value : {0.25F, 0.75F}) {
        OIIO::ImageBufAlgo::fill(picture, {value, value, value});
        write_image_atomically(picture, file("a.exr"));
        const ImageBuf read = read_image(file("a.exr"));
        EXPECT_EQ(read.getchannel(1, 1, 0, 0), value);
        EXPECT_FALSE(read.cachedpixels());
        // Nor does the shared cache serve the old one.
        EXPECT_EQ(ImageBuf(file("a.exr")).getchannel(1, 1, 0, 0), value);
    }
}

/// A profile of no colors, with private tags (ICC.1:2022, 7.3), whose names no other profile has.
std::string profile_with_tags(int count, int first) {
    const auto u32 = [](std::size_t value) {
        std::string bytes;
        for (const int shift : {24, 16, 8, 0})
            bytes += static_cast<char>(value >> shift & 255U);
        return bytes;
    };
    const std::size_t table = 132 + 12 * static_cast<std::size_t>(count);
    std::string profile(128, '\0');
    profile.replace(0, 4, u32(table + 12));
    profile.replace(8, 4, u32(0x04300000));
    profile.replace(12, 12, "mntrRGB XYZ ");
    profile.replace(36, 4, "acsp");
    profile += u32(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i)
        profile += fmt::format("{:04x}", first + i) + u32(table) + u32(12);
    return profile + std::string("text\0\0\0\0tag", 12);
}

// OpenImageIO 2.4 notes names of tags that it does not know in a static table, while it decodes a
// profile: without our lock, most runs end in a crash.
TEST(PictureReader, ThreadsOpenPicturesWithProfiles) {
    const Folder folder;
    constexpr int kThreads = 4;
    constexpr int kFiles = 40;  // for each thread
    constexpr int kTags = 100;
    const auto name = [&](int i) { return folder / (std::to_string(i) + ".tif"); };
    for (int i = 0; i < kThreads * kFiles; ++i) {
        const std::string profile = profile_with_tags(kTags, kTags * i);
        OIIO::ImageSpec spec(4, 3, 3, OIIO::TypeDesc::UINT8);
        spec.attribute("ICCProfile",
                       OIIO::TypeDesc(OIIO::TypeDesc::UINT8, static_cast<int>(profile.size())),
                       profile.data());
        OIIO::ImageBuf picture(spec);
        OIIO::ImageBufAlgo::zero(picture);
        ASSERT_TRUE(picture.write(name(i)));
    }
    std::vector<std::jthread> threads;
    std::latch start(kThreads);
    std::atomic<int> read = 0;
    for (int t = 0; t < kThreads; ++t) {
        threads.emplace_back([&, t] {
            start.arrive_and_wait();
            for (int i = t * kFiles; i < (t + 1) * kFiles; ++i) {
                const PictureReader reader(name(i), 1);
                if (reader.spec().find_attribute("ICCProfile")) ++read;
            }
        });
    }
    threads.clear();
    EXPECT_EQ(read, kThreads * kFiles);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
