// SPDX-License-Identifier: Apache-2.0
//
// Files go through in batches of rows. Whatever the picture, the file must be the one that reading,
// tone mapping and writing the whole of it make, to the last byte.
#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <array>
#include <csignal>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "image/picture_file.h"
#include "image/tonemap_file.h"
#include "tonewright/image_io.h"
#include "tonewright/tonemap.h"
#include "unit/folder.h"
#include "unit/image/pictures.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

constexpr int kWidth = 300;
constexpr int kHeight = 200;
constexpr std::size_t kSmallBatch = 1;  // 64 rows: the least
constexpr int kTall = 100'000;

WriteOptions written_as(TypeDesc type) {
    WriteOptions options;
    options.type = type;
    return options;
}

ImageSpec spec_of(const std::vector<std::string>& channels, TypeDesc type = TypeDesc::HALF) {
    ImageSpec spec = make_spec(kWidth, kHeight, channels, type);
    spec.attribute("DateTime", "2026:01:02 03:04:05");  // or writers put in the time
    return spec;
}

/// A file as OIIO writes it, which write_image_atomically() would change.
void put(const ImageSpec& spec, const std::string& path, float peak = 8) {
    const ImageBuf picture = make_picture(spec, peak);
    const auto out = OIIO::ImageOutput::create(path);
    ASSERT_TRUE(out && out->open(path, spec));
    ASSERT_TRUE(picture.write(out.get()) && out->close()) << out->geterror();
}

class TonemapFile : public testing::Test {
  protected:
    /// Through files in batches, with one thread and with three, and as a whole.
    void expect_same(const std::string& in, const std::string& out, const TonemapOptions& options,
                     TypeDesc type = OIIO::TypeUnknown) {
        const ImageBuf source = read_image(in);
        const std::string whole = folder_ / ("whole_" + out);
        const bool keeps_half = type == OIIO::TypeUnknown && out.ends_with(".exr") &&
                                source.spec().format == TypeDesc::HALF;
        if (keeps_half) type = TypeDesc::HALF;
        write_image_atomically(tonemap(source, options), whole, type);
        const std::string wanted = read(whole);
        ASSERT_GT(wanted.size(), 100U);
        for (const int threads : {1, 3}) {
            const std::string path = folder_ / out;
            tonemap_in_batches(Tonemapper(options), in, path, written_as(type), {}, threads,
                               kSmallBatch);
            EXPECT_TRUE(read(path) == wanted) << in << " -> " << out << ", " << threads;
            fs::remove(path);
        }
    }

    Folder folder_;
};

TEST_F(TonemapFile, BatchesAreSomeSixteenMegabytesOfWholeTiles) {
    EXPECT_EQ(rows_of_batch(1 << 14, 1, kTall), 1024);
    EXPECT_EQ(rows_of_batch(1 << 20, 1, kTall), 64);    // and never fewer
    EXPECT_EQ(rows_of_batch(1 << 14, 48, kTall), 960);  // 10 x 96
    EXPECT_EQ(rows_of_batch(1 << 20, 200, kTall), 200);
    EXPECT_EQ(rows_of_batch(1 << 10, 1, kTall, kSmallBatch), 64);
    EXPECT_EQ(rows_of_batch(std::size_t{1} << 30, 1, 1), 1);  // unless the picture has fewer
    EXPECT_EQ(rows_of_batch(1 << 10, 1 << 30, 7), 7);
}

TEST_F(TonemapFile, EqualsTheWholePicture) {
    const std::string in = folder_ / "a.exr";
    put(spec_of({"R", "G", "B"}), in);
    const TonemapOptions options = {.op = resolve_picture_operator("hable")};
    expect_same(in, "half.exr", options, TypeDesc::HALF);
    expect_same(in, "float.exr", options);
    expect_same(in, "a.png", options, TypeDesc::UINT16);
    expect_same(in, "a.tif", options, TypeDesc::UINT16);  // written without a proxy
    expect_same(in, "a.jpg", options);
    expect_same(in, "a.hdr", options);
}

TEST_F(TonemapFile, TilesAlphaAndOtherChannels) {
    ImageSpec spec = spec_of({"R", "G", "B", "A", "Z"}, TypeDesc::FLOAT);
    spec.tile_width = 64;
    spec.tile_height = 48;
    const std::string in = folder_ / "a.exr";
    put(spec, in, 1);
    const TonemapOptions options = {.op = resolve_picture_operator("reinhard")};
    expect_same(in, "half.exr", options, TypeDesc::HALF);
    expect_same(in, "a.png", options, TypeDesc::UINT8);  // no Z there; and color divided by alpha
}

TEST_F(TonemapFile, TexturesBecomePictures) {
    for (const char* kind : {"Plain Texture", "LatLong Environment"}) {
        const std::string in = folder_ / "a.exr";
        OIIO::ImageSpec config;
        config.set_format(TypeDesc::HALF);
        ASSERT_TRUE(OIIO::ImageBufAlgo::make_texture(
            kind[0] == 'P' ? OIIO::ImageBufAlgo::MakeTxTexture : OIIO::ImageBufAlgo::MakeTxEnvLatl,
            make_rgb(64, 32, TypeDesc::HALF, 4), in, config))
            << OIIO::geterror();
        expect_same(in, "half.exr", {.op = resolve_picture_operator("hable")}, TypeDesc::HALF);
        const std::string out = folder_ / "out.exr";
        tonemap_file(Tonemapper({.op = resolve_picture_operator("hable")}), in, out);
        EXPECT_EQ(read_image(out).spec().width, 64) << "all of it is in the file";
    }
}

TEST_F(TonemapFile, AnySubimage) {
    const std::string in = folder_ / "pages.tif";
    const std::unique_ptr<OIIO::ImageOutput> file = OIIO::ImageOutput::create(in);
    const std::array pages = {make_rgb(20, 10), make_rgb(30, 15, TypeDesc::FLOAT, 5)};
    ASSERT_TRUE(file->open(in, pages[0].spec()));
    ASSERT_TRUE(pages[0].write(file.get()));
    ASSERT_TRUE(file->open(in, pages[1].spec(), OIIO::ImageOutput::AppendSubimage));
    ASSERT_TRUE(pages[1].write(file.get()));
    ASSERT_TRUE(file->close());
    const std::string out = folder_ / "page.exr";
    // Also of an operator that measures its picture.
    for (const char* op : {"hable", "drago"}) {
        for (int page = 0; page < 2; ++page) {
            tonemap_file(Tonemapper({.op = resolve_picture_operator(op)}), in, out,
                         written_as(TypeDesc::FLOAT), {.subimage = std::to_string(page)}, 1);
            EXPECT_TRUE(same_bits(read_image(out), tonemap(pages.at(static_cast<std::size_t>(page)),
                                                           {.op = resolve_picture_operator(op)})))
                << op << ", " << page;
        }
    }
    EXPECT_THROW(tonemap_file(Tonemapper({.op = resolve_picture_operator("hable")}), in, out, {},
                              {.subimage = "2"}, 1),
                 FileError);
}

TEST_F(TonemapFile, RowsInFilesThatBeginAtTheBottom) {
    ImageSpec spec = spec_of({"R", "G", "B"});
    spec.attribute("openexr:lineOrder", "decreasingY");
    const std::string in = folder_ / "a.exr";
    put(spec, in);
    expect_same(in, "half.exr", {.op = resolve_picture_operator("hable")}, TypeDesc::HALF);
    expect_same(in, "a.png", {.op = resolve_picture_operator("hable")}, TypeDesc::UINT8);
}

TEST_F(TonemapFile, DisplayWindowsBeyondAndInsideThePicture) {
    for (const int offset : {-40, 40}) {
        ImageSpec spec = spec_of({"R", "G", "B"});
        spec.x = offset;
        spec.y = offset;
        spec.full_width = kWidth + offset;
        spec.full_height = kHeight + 3 * offset;
        const std::string in = folder_ / "a.exr";
        put(spec, in);
        expect_same(in, "half.exr", {.op = resolve_picture_operator("hable")}, TypeDesc::HALF);
        expect_same(in, "a.png", {.op = resolve_picture_operator("hable")}, TypeDesc::UINT8);
    }
    // Nothing of the picture is in it.
    ImageSpec spec = spec_of({"R", "G", "B"});
    spec.y = 1000;
    spec.full_height = 100;
    const std::string in = folder_ / "b.exr";
    put(spec, in);
    expect_same(in, "a.png", {.op = resolve_picture_operator("hable")}, TypeDesc::UINT8);
}

TEST_F(TonemapFile, StatisticsAreOfTheWholePicture) {
    const std::string in = folder_ / "a.exr";
    put(spec_of({"R", "G", "B"}), in, 50);
    expect_same(in, "out.exr", {.op = resolve_picture_operator("drago")});
    // Alpha that was never written: pixels count without it.
    ImageBuf bare = make_picture(spec_of({"R", "G", "B", "A"}), 50);
    OIIO::ImageBufAlgo::fill(bare, {0.0F}, OIIO::ROI(0, kWidth, 0, kHeight, 0, 1, 3, 4));
    write_image_atomically(bare, in);
    expect_same(in, "out.exr", {.op = resolve_picture_operator("drago")});
}

TEST_F(TonemapFile, OpenExrKeepsThePixelType) {
    const Tonemapper tonemapper({.op = resolve_picture_operator("hable")});
    const auto written = [&](const std::string& in, const std::string& out,
                             const ReadOptions& read = {}, WriteOptions write = {}) {
        tonemap_file(tonemapper, in, folder_ / out, write, read, 1);
        return PictureReader(folder_ / out).spec().format;
    };
    const auto made = [&](const std::string& name, TypeDesc type) {
        put(spec_of({"R", "G", "B"}, type), folder_ / name, 1);
        return std::string(folder_ / name);
    };
    const std::string half = made("half.exr", TypeDesc::HALF);
    const std::string single = made("float.exr", TypeDesc::FLOAT);
    EXPECT_EQ(written(half, "a.exr"), TypeDesc(TypeDesc::HALF));
    EXPECT_EQ(written(single, "a.exr"), TypeDesc(TypeDesc::FLOAT));
    EXPECT_EQ(written(half, "a.exr", {}, written_as(TypeDesc::FLOAT)), TypeDesc(TypeDesc::FLOAT));
    EXPECT_EQ(written(single, "a.exr", {}, written_as(TypeDesc::HALF)), TypeDesc(TypeDesc::HALF));
    // Half has 11 significant bits: enough for codes of 8 bits, not for those of 16.
    EXPECT_EQ(written(made("8.tif", TypeDesc::UINT8), "a.exr"), TypeDesc(TypeDesc::HALF));
    EXPECT_EQ(written(made("16.tif", TypeDesc::UINT16), "a.exr"), TypeDesc(TypeDesc::FLOAT));
    // Resized light is float, and pictures that are turned pass through memory.
    ReadOptions resize;
    resize.resize = "50%";
    EXPECT_EQ(written(half, "a.exr", resize), TypeDesc(TypeDesc::HALF));
    ImageSpec lying = spec_of({"R", "G", "B"}, TypeDesc::UINT8);
    lying.attribute("Orientation", 6);
    put(lying, folder_ / "lying.tif", 1);
    EXPECT_EQ(written(folder_ / "lying.tif", "a.exr"), TypeDesc(TypeDesc::HALF));
    // The widest channel decides, because depth must not lose digits.
    ImageSpec mixed = spec_of({"R", "G", "B", "Z"}, TypeDesc::FLOAT);
    mixed.channelformats = {TypeDesc::HALF, TypeDesc::HALF, TypeDesc::HALF, TypeDesc::FLOAT};
    put(mixed, folder_ / "mixed.exr", 1);
    EXPECT_EQ(written(folder_ / "mixed.exr", "a.exr"), TypeDesc(TypeDesc::FLOAT));
    // Other formats have their own defaults.
    EXPECT_EQ(written(half, "a.png"), TypeDesc(TypeDesc::UINT8));
    EXPECT_EQ(written(half, "a.tif"), TypeDesc(TypeDesc::FLOAT));
}

TEST_F(TonemapFile, ProgressCountsRows) {
    const std::string in = folder_ / "a.exr";
    put(spec_of({"R", "G", "B"}), in);
    std::vector<std::size_t> rows;
    WriteOptions write;
    write.progress = [&](std::size_t done, std::size_t total) {
        EXPECT_EQ(total, std::size_t{kHeight});
        rows.push_back(done);
    };
    tonemap_in_batches(Tonemapper({.op = resolve_picture_operator("hable")}), in, folder_ / "b.exr",
                       write, {}, 3, kSmallBatch);
    // Batches of 64 rows: 200 are three and a rest.
    EXPECT_EQ(rows, (std::vector<std::size_t>{64, 128, 192, 200}));
}

TEST_F(TonemapFile, GrayStaysGrayOrBecomesColor) {
    const std::string in = folder_ / "a.exr";
    put(spec_of({"Y"}, TypeDesc::FLOAT), in);
    const ImageSpec spec = read_image(in).spec();
    ASSERT_EQ(spec.nchannels, 1);
    for (const char* op : {"hable", "false_color"}) {
        const std::string out = folder_ / "out.exr", whole = folder_ / "whole.exr";
        tonemap_in_batches(Tonemapper({.op = resolve_picture_operator(op)}), in, out,
                           written_as(TypeDesc::HALF), {}, 2, kSmallBatch);
        write_image_atomically(tonemap(read_image(in), {.op = resolve_picture_operator(op)}), whole,
                               TypeDesc::HALF);
        EXPECT_TRUE(read(out) == read(whole)) << op;
    }
}

TEST_F(TonemapFile, OntoItself) {
    const std::string in = folder_ / "a.exr", out = folder_ / "b.exr";
    put(spec_of({"R", "G", "B"}), in);
    tonemap_file(Tonemapper({.op = resolve_picture_operator("hable")}), in, out, TypeDesc::HALF);
    tonemap_in_batches(Tonemapper({.op = resolve_picture_operator("hable")}), in, in,
                       written_as(TypeDesc::HALF), {}, 3, kSmallBatch);
    EXPECT_TRUE(read(in) == read(out));
}

std::string message_of(const std::function<void()>& function) {
    try {
        function();
    } catch (const FileError& e) {
        return std::string("file: ") + e.what();
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

TEST_F(TonemapFile, FailuresLeaveTheOldFile) {
    const std::string in = folder_ / "a.exr", out = folder_ / "out.exr";
    put(spec_of({"R", "G", "B"}), in);
    const std::string whole = read(in);
    std::ofstream(out) << "the old file";
    const auto run = [&](int threads) {
        return message_of([&] {
            tonemap_in_batches(Tonemapper({.op = resolve_picture_operator("hable")}), in, out,
                               written_as(TypeDesc::HALF), {}, threads, kSmallBatch);
        });
    };
    const auto expect_old = [&] {
        EXPECT_EQ(read(out), "the old file");
        EXPECT_EQ(std::distance(fs::directory_iterator(fs::path(out).parent_path()), {}), 2);
    };
    // In the first, a middle and the last batches, with others on their way.
    for (const std::size_t tenths : {3, 6, 9}) {
        std::ofstream(in, std::ios::binary) << whole.substr(0, whole.size() * tenths / 10);
        for (const int threads : {1, 3, 3, 3}) {
            const std::string message = run(threads);
            EXPECT_TRUE(message.starts_with("file: " + in + ": cannot read")) << message;
            expect_old();
        }
    }
    std::ofstream(in, std::ios::binary) << whole;
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit old{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
    rlimit small = old;
    small.rlim_cur = 1 << 17;
    for (const int threads : {1, 3}) {
        ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
        const std::string message = run(threads);
        ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old), 0);
        EXPECT_EQ(message, "file: " + out + ": cannot write: File too large");
        expect_old();
    }
    std::signal(SIGXFSZ, SIG_DFL);
}

TEST_F(TonemapFile, PicturesThatCannotBeToneMappedAreNamed) {
    const std::string in = folder_ / "a.exr";
    put(spec_of({"X", "Y"}), in);
    const std::string message = message_of([&] {
        tonemap_file(Tonemapper({.op = resolve_picture_operator("hable")}), in,
                     folder_ / "out.exr");
    });
    EXPECT_TRUE(message.starts_with("file: " + in + ": ")) << message;
    EXPECT_NE(message.find("2 channels (X, Y)"), std::string::npos) << message;
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
