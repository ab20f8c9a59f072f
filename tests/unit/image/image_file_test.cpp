// SPDX-License-Identifier: Apache-2.0
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <thread>

#include "tonewright/error.h"
#include "tonewright/image_io.h"

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

class ImageFile : public testing::Test {
  protected:
    void SetUp() override {
        folder_ =
            fs::temp_directory_path() / ("tonewright_file_test_" + std::to_string(::getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }

    [[nodiscard]] std::string file(const std::string& name) const {
        return (folder_ / name).string();
    }
    [[nodiscard]] std::size_t files() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), {}));
    }

    static std::string bytes_of(const std::string& path) {
        std::ifstream in(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    static void put(const std::string& path, const std::string& bytes) {
        std::ofstream(path, std::ios::binary) << bytes;
    }

    fs::path folder_;
};

/// Large enough that a file has several blocks; not compressible to nothing.
ImageBuf make_picture(int channels = 3, TypeDesc type = TypeDesc::FLOAT) {
    ImageBuf picture(ImageSpec(160, 120, channels, type));
    OIIO::ImageBufAlgo::noise(picture, "uniform", 0.0F, 1.0F, false, 7);
    return picture;
}

template <class Function>
std::string message_of(Function&& function) {
    try {
        function();
    } catch (const FileError& e) {
        return e.what();
    } catch (const std::exception& e) {
        return std::string("not a FileError: ") + e.what();
    }
    return "no error";
}

void expect_file_error(const std::string& message, const std::string& path,
                       const std::string& reason) {
    EXPECT_TRUE(message.starts_with(path + ": cannot ")) << message;
    EXPECT_NE(message.find(reason), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

/// OpenImageIO 2.4 keeps what a reader reported by its address and thread. A reader that another
/// thread destroys leaves it behind, for the next reader at that address.
TEST_F(ImageFile, ErrorsOfOtherReadersAreNotThisOnes) {
    write_image_atomically(make_picture(3, TypeDesc::UINT8), file("good.sgi"), WriteOptions{});
    put(file("bad.sgi"), "no picture");
    for (int i = 0; i < 50; ++i) {
        std::unique_ptr<OIIO::ImageInput> bad = OIIO::ImageInput::create("sgi");
        ImageSpec spec;
        ASSERT_FALSE(bad->open(file("bad.sgi"), spec));
        std::thread([&] { bad.reset(); }).join();
        EXPECT_EQ(message_of([&] { (void)read_image(file("good.sgi")); }), "no error");
    }
}

TEST_F(ImageFile, RoundTrip) {
    const ImageBuf picture = make_picture(4);
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

TEST_F(ImageFile, TypeOfTheFormatOrTheRequestedOne) {
    const ImageBuf picture = make_picture();
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

TEST_F(ImageFile, FormatsWithoutProxies) {
    // SGI cannot be written to memory by OIIO 2.4: the other way through the code.
    const ImageBuf picture = make_picture(3, TypeDesc::UINT8);
    write_image_atomically(picture, file("a.sgi"));
    EXPECT_EQ(OIIO::ImageBufAlgo::compare(picture, read_image(file("a.sgi")), 0, 0).maxerror, 0);
    EXPECT_EQ(files(), 1U);
}

TEST_F(ImageFile, PicturesWithMetadata) {
    // As tonemap() leaves them, and as cameras do: writers make more blocks of a file then.
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

TEST_F(ImageFile, ChannelsThatAFormatCannotHoldAreLeftOut) {
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

TEST_F(ImageFile, FormatsWithoutDisplayWindowHoldTheDisplayWindow) {
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

TEST_F(ImageFile, PngHasColorThatIsNotMultiplied) {
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

TEST_F(ImageFile, FailedWriteLeavesTheOldFile) {
    const ImageBuf picture = make_picture();
    std::signal(SIGXFSZ, SIG_IGN);
    for (const char* name : {"a.exr", "a.png", "a.jpg", "a.tif", "a.hdr", "a.sgi"}) {
        const std::string path = file(name);
        const TypeDesc type = std::string(name) == "a.sgi" ? TypeDesc::UINT8 : TypeDesc::UNKNOWN;
        write_image_atomically(picture, path, type);
        const std::size_t size = bytes_of(path).size();
        put(path, "the old file");
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
            EXPECT_EQ(bytes_of(path), "the old file") << name;
            EXPECT_EQ(files(), 1U) << name;
        }
        fs::remove(path);
    }
    std::signal(SIGXFSZ, SIG_DFL);
}

TEST_F(ImageFile, FailedEncodingLeavesTheOldFile) {
    put(file("a.png"), "the old file");
    expect_file_error(message_of([&] { write_image_atomically(ImageBuf(), file("a.png")); }),
                      file("a.png"), "there is no picture");
    EXPECT_EQ(bytes_of(file("a.png")), "the old file");
    EXPECT_EQ(files(), 1U);
}

TEST_F(ImageFile, RefusesPathsThatCannotBeWritten) {
    const ImageBuf picture = make_picture();
    const auto write = [&](const std::string& path) {
        return message_of([&] { write_image_atomically(picture, path); });
    };
    expect_file_error(write(file("missing/a.exr")), file("missing/a.exr"),
                      "No such file or directory");
    put(file("plain"), "x");
    expect_file_error(write(file("plain/a.exr")), file("plain/a.exr"), "Not a directory");
    fs::create_directory(file("folder.exr"));
    expect_file_error(write(file("folder.exr")), file("folder.exr"), "is a folder");
    expect_file_error(write(file("a.xyz")), file("a.xyz"), "xyz");
    expect_file_error(write(file("noextension")), file("noextension"), "no extension");
    expect_file_error(write("/dev/null"), "/dev/null", "is no regular file");
}

TEST_F(ImageFile, FolderWithoutPermission) {
    if (::geteuid() == 0) GTEST_SKIP() << "root may write into any folder";
    fs::create_directory(file("locked"));
    fs::permissions(file("locked"), fs::perms::owner_read | fs::perms::owner_exec);
    const std::string path = file("locked/a.exr");
    expect_file_error(message_of([&] { write_image_atomically(make_picture(), path); }), path,
                      "Permission denied");
}

TEST_F(ImageFile, LinksAndPermissionsStay) {
    const ImageBuf picture = make_picture();
    put(file("target.png"), "old");
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
    write_image_atomically(make_picture(), file(name));
    EXPECT_EQ(read_image(file(name)).spec().height, 120);
}

TEST_F(ImageFile, TruncatedFilesAreErrors) {
    // ImageBuf::read() finds nothing wrong with a truncated TIFF or JPEG file.
    const ImageBuf picture = make_picture();
    for (const char* name :
         {"a.exr", "a.hdr", "a.png", "a.tif", "a.jpg", "a.ppm", "a.dpx", "a.tga", "a.sgi"}) {
        const std::string path = file(name);
        const TypeDesc type = std::string(name) == "a.sgi" ? TypeDesc::UINT8 : TypeDesc::UNKNOWN;
        write_image_atomically(picture, path, type);
        const std::string whole = bytes_of(path);
        ASSERT_NO_THROW((void)read_image(path)) << name;
        for (const double part : {0.9, 0.5, 0.1, 0.001}) {
            put(path, whole.substr(
                          0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
            // OIIO 2.4's PNG reader loses a string when libpng jumps out of it.
            const ScopedLeaksOfOthers ignored;
            expect_file_error(message_of([&] { (void)read_image(path); }), path, "");
        }
    }
}

TEST_F(ImageFile, RefusesFilesThatAreNotPictures) {
    const auto read = [&](const std::string& path) {
        return message_of([&] { (void)read_image(path); });
    };
    expect_file_error(read(file("missing.exr")), file("missing.exr"), "No such file or directory");
    expect_file_error(read(folder_.string()), folder_.string(), "is a folder");
    put(file("empty.exr"), "");
    expect_file_error(read(file("empty.exr")), file("empty.exr"), "the file is empty");
    put(file("text.exr"), "certainly no picture, and long enough to have a header of some kind");
    expect_file_error(read(file("text.exr")), file("text.exr"), "");
    put(file("text.txt"), "certainly no picture");
    expect_file_error(read(file("text.txt")), file("text.txt"), "");
}

TEST_F(ImageFile, DeepPicturesAreRefused) {
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

TEST_F(ImageFile, ReadsAChangedFileAgain) {
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

}  // namespace
TONEWRIGHT_NAMESPACE_END
