// SPDX-License-Identifier: Apache-2.0
//
// What files say of their colors, and what writers say of files.
#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "image/color_tags.h"
#include "image/png_chunks.h"
#include "lut/icc.h"
#include "tonewright/engine.h"
#include "tonewright/image_io.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap.h"
#include "tonewright/view.h"
#include "unit/image/pictures.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

std::string bytes_of(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Writes a picture, and returns what the writer warned of.
std::vector<std::string> warnings_of(const ImageBuf& picture, const std::string& path,
                                     WriteOptions options = {}) {
    std::vector<std::string> warnings;
    options.warn = [&](const std::string& text) { warnings.push_back(text); };
    write_image_atomically(picture, path, options);
    return warnings;
}

ImageBuf shown_on(const std::string& display, int channels = 3) {
    const ImageBuf scene =
        channels == 3 ? make_rgb(24, 17) : make_picture(make_spec(24, 17, {"Y"}, TypeDesc::FLOAT));
    return tonemap(scene, {.op = resolve_picture_operator("clamp"), .display = display});
}

std::string icc_of(const std::string& path) {
    const ImageBuf file = read_image(path);
    const OIIO::ParamValue* icc = file.spec().find_attribute("ICCProfile");
    if (!icc) return {};
    return {static_cast<const char*>(icc->data()), static_cast<std::size_t>(icc->datasize())};
}

TEST(PngChunks, HaveLengthTypeDataAndChecksum) {
    // The last chunk of every PNG file.
    EXPECT_EQ(png_chunk("IEND", ""), std::string("\0\0\0\0IEND\xAE\x42\x60\x82", 12));
    // Checksums by zlib. Code points: H.273, BT.2020 is 9, P3-D65 is 12, PQ is 16, HLG is 18.
    EXPECT_EQ(cicp_chunk({9, 16}), std::string("\0\0\0\4cICP\x09\x10\x00\x01\x4D\x23\x23\xFE", 16));
    EXPECT_EQ(cicp_chunk({9, 18}), std::string("\0\0\0\4cICP\x09\x12\x00\x01\x4E\xA7\xF7\x90", 16));
    EXPECT_EQ(cicp_chunk({12, 16}),
              std::string("\0\0\0\4cICP\x0C\x10\x00\x01\x7A\xFD\xD3\xCC", 16));
}

TEST(FileTags, PngOfAnHdrDisplayHasItsCodePoints) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.png");
    const std::vector<std::pair<std::string, std::string>> displays = {
        {"rec2100_pq", cicp_chunk({9, 16})},
        {"rec2100_hlg", cicp_chunk({9, 18})},
        {"p3d65_pq", cicp_chunk({12, 16})}};
    for (const auto& [display, chunk] : displays) {
        for (const int channels : {1, 3}) {
            const ImageBuf picture = shown_on(display, channels);
            EXPECT_TRUE(warnings_of(picture, path).empty()) << display;
            const std::string bytes = bytes_of(path);
            EXPECT_EQ(bytes.substr(kAfterPngHeader, chunk.size()), chunk) << display;
            EXPECT_EQ(bytes.substr(12, 4), "IHDR");
            EXPECT_EQ(bytes.find("sRGB"), std::string::npos);
            const ImageBuf back = read_image(path);
            EXPECT_EQ(back.spec().format, TypeDesc::UINT16) << "8 bits show bands";
            EXPECT_LE(OIIO::ImageBufAlgo::compare(picture, back, 1, 1).maxerror, 1.0 / 65535);
            write_image_atomically(picture, path);
            EXPECT_EQ(bytes_of(path), bytes) << "the same on every run";
        }
    }
    EXPECT_EQ(warnings_of(shown_on("rec2100_pq"), path, {.type = TypeDesc::UINT8}),
              std::vector<std::string>{"gradients in 8 bits show bands"});
}

TEST(FileTags, SdrDisplaysHaveTheirProfile) {
    if (!has_icc()) GTEST_SKIP() << "built without Little CMS";
    const TemporaryFolder folder;
    const IccCurve srgb = {2.4, true};
    struct Case {
        const char* display;
        Primaries primaries;
        IccCurve curve;
        const char* name;
    };
    const std::vector<Case> cases = {
        {"srgb", kRec709, srgb, "sRGB"},          {"display_p3", kP3D65, srgb, "Display P3"},
        {"rec1886", kRec709, {2.4}, "Gamma 2.4"}, {"rec2020", kRec2020, {2.4}, "Rec.2020"},
        {"g22", kRec709, {2.2}, "Gamma 2.2"},     {"linear", kRec709, {1}, "linear light"}};
    for (const Case& c : cases) {
        for (const int channels : {1, 3}) {
            const ImageBuf picture = shown_on(c.display, channels);
            for (const char* name : {"a.png", "a.jpg", "a.tif"}) {
                const std::string path = folder.file(name);
                EXPECT_TRUE(warnings_of(picture, path).empty()) << c.display << " " << name;
                const bool has_chunk =
                    std::string(c.display) == "srgb" && std::string(name) == "a.png";
                const std::string wanted =
                    has_chunk ? "" : write_display_icc(c.primaries, c.curve, c.name, channels == 1);
                EXPECT_TRUE(icc_of(path) == wanted) << c.display << " " << name << " " << channels;
                if (has_chunk) {
                    EXPECT_NE(bytes_of(path).find("sRGB"), std::string::npos);
                }
            }
        }
    }
    // A picture that says nothing of its colors gets nothing.
    const std::string path = folder.file("a.tif");
    write_image_atomically(make_rgb(4, 4), path);
    EXPECT_EQ(icc_of(path), "");
}

TEST(FileTags, EveryDisplayIsDescribed) {
    const std::vector<double> codes = {0, 0.02, 0.1, 0.35, 0.7, 1};
    for (const Display& display : all_displays()) {
        ImageSpec spec(1, 1, 3, TypeDesc::FLOAT);
        tag_as_result_of(make_view(resolve_operator("clamp"), "lin_rec709", 0, display.id), spec);
        const std::optional<TaggedColor> color = tagged_color(spec);
        ASSERT_TRUE(color) << display.id;
        EXPECT_EQ(color->code_points.has_value(), display.is_hdr);
        EXPECT_EQ(color->primaries, display.primaries);
        if (!color->curve) continue;
        // The curve is that of the display, whose formula stands elsewhere.
        const ReferenceEngine decode(display.decode);
        for (const double code : codes) {
            const auto in = static_cast<float>(code);
            const std::array<float, 3> rgb = {in, in, in};
            std::array<double, 3> light{};
            decode.run_rgb(rgb.data(), light.data(), 1);
            const double x = static_cast<double>(in);
            const IccCurve& curve = *color->curve;
            const double said = curve.is_srgb && x <= 0.04045 ? x / 12.92
                                : curve.is_srgb ? std::pow((x + 0.055) / 1.055, curve.exponent)
                                                : std::pow(x, curve.exponent);
            EXPECT_NEAR(said, light[0], 1e-7) << display.id;
        }
    }
}

TEST(FileTags, FormatsWithoutColorTagsWarn) {
    const TemporaryFolder folder;
    const auto warning = [&](const char* display, const char* name) {
        const std::vector<std::string> all = warnings_of(shown_on(display), folder.file(name));
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
    EXPECT_EQ(warnings_of(shown_on("srgb"), folder.file("a.jpg"), {.type = TypeDesc::UINT16}),
              std::vector<std::string>{"pixels are 8 bits, not 16 bits"});
}

TEST(FileTags, AWarningThatThrowsLeavesNothing) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.jpg");
    WriteOptions options;
    options.warn = [](const std::string& text) { throw std::runtime_error(text); };
    EXPECT_THROW(write_image_atomically(shown_on("rec2100_pq"), path, options), std::runtime_error);
    EXPECT_FALSE(std::filesystem::exists(path));
    EXPECT_EQ(
        std::distance(
            std::filesystem::directory_iterator(std::filesystem::path(path).parent_path()), {}),
        0);
}

TEST(FileTags, AvifThatHoldsHevcIsAWarning) {
    if (!OIIO::ImageOutput::create("a.avif")) GTEST_SKIP() << "OpenImageIO without HEIF";
    const TemporaryFolder folder;
    const std::string path = folder.file("a.avif");
    const std::vector<std::string> warnings = warnings_of(shown_on("srgb"), path);
    // ISO/IEC 23000-22: AV1 has the brand avif, HEVC has heic.
    const bool is_avif = bytes_of(path).substr(8, 4) == "avif";
    EXPECT_EQ(warnings.size(), is_avif ? 0U : 1U);
    EXPECT_TRUE(warnings_of(shown_on("srgb"), folder.file("a.heic")).empty());
}

// ---------------------------------------------------------------------------------------------
// Alpha

ImageBuf with_alpha(float alpha) {
    ImageBuf picture = make_picture(make_spec(6, 5, {"R", "G", "B", "A"}, TypeDesc::FLOAT));
    OIIO::ImageBufAlgo::fill(picture, {0.2F, 0.4F, 0.6F, alpha});
    return picture;
}

TEST(FileTags, AlphaThatIsZeroEverywhereIsAWarning) {
    const TemporaryFolder folder;
    ImageBuf blank = with_alpha(0);
    for (const char* name : {"a.png", "a.tif"}) {
        const std::vector<std::string> warnings = warnings_of(blank, folder.file(name));
        ASSERT_EQ(warnings.size(), 1U) << name;
        EXPECT_TRUE(warnings[0].starts_with("alpha is 0 everywhere")) << warnings[0];
    }
    EXPECT_TRUE(warnings_of(blank, folder.file("a.jpg")).empty()) << "it has no alpha";
    EXPECT_TRUE(warnings_of(blank, folder.file("a.exr")).empty()) << "light without cover";
    OIIO::ImageBufAlgo::fill(blank, {0.0F, 0.0F, 0.0F, 0.0F});
    set(blank, 5, 4, {0.002F, 0.004F, 0.006F, 0.01F});
    EXPECT_TRUE(warnings_of(blank, folder.file("a.png")).empty());
}

TEST(FileTags, AlphaIsLeftOutOrMadeOpaque) {
    const TemporaryFolder folder;
    using Alpha = WriteOptions::Alpha;
    for (const float alpha : {0.0F, 0.5F}) {
        const ImageBuf picture = with_alpha(alpha);
        for (const char* name : {"a.png", "a.tif", "a.exr"}) {
            const std::string path = folder.file(name);
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

// ---------------------------------------------------------------------------------------------
// Compression

TEST(FileTags, CompressionIsThatOfTheFormat) {
    const TemporaryFolder folder;
    const ImageBuf picture = make_rgb(64, 64, TypeDesc::HALF);
    for (const char* name : {"none", "zip", "piz", "dwaa"}) {
        write_image_atomically(picture, folder.file("a.exr"), {.compression = name});
        EXPECT_EQ(read_image(folder.file("a.exr")).spec().get_string_attribute("compression"),
                  name);
    }
    const auto size_of = [&](const char* name, const WriteOptions& options) {
        write_image_atomically(picture, folder.file(name), options);
        return bytes_of(folder.file(name)).size();
    };
    EXPECT_LT(size_of("a.jpg", {.quality = 20}), size_of("a.jpg", {.quality = 95}));
    EXPECT_LT(size_of("a.jpg", {.compression = "jpeg:20"}),
              size_of("a.jpg", {.compression = "jpeg:95"}));
    EXPECT_LT(size_of("a.exr", {.compression = "dwaa:500"}),
              size_of("a.exr", {.compression = "dwaa:5"}));
    const auto refusal = [&](const char* name, const WriteOptions& options) {
        try {
            write_image_atomically(picture, folder.file(name), options);
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
    EXPECT_FALSE(std::filesystem::exists(folder.file("b.exr")));
}

// ---------------------------------------------------------------------------------------------
// Windows and sizes

TEST(FileTags, DisplayWindowsOfEmptySpaceAreBounded) {
    const TemporaryFolder folder;
    ImageBuf picture = make_rgb(8, 8);
    const auto show_in = [&](int size) {
        picture.specmod().full_width = picture.specmod().full_height = size;
    };
    show_in(1'000'000);
    try {
        write_image_atomically(picture, folder.file("a.png"));
        FAIL() << "no error";
    } catch (const FileError& e) {
        EXPECT_NE(std::string(e.what()).find("1000000 x 1000000"), std::string::npos) << e.what();
    }
    EXPECT_FALSE(std::filesystem::exists(folder.file("a.png")));
    write_image_atomically(picture, folder.file("a.exr"));  // which has display windows
    show_in(20);
    WriteOptions few;
    few.max_pixels = 399;
    EXPECT_THROW(write_image_atomically(picture, folder.file("a.png"), few), FileError);
    few.max_pixels = 400;
    write_image_atomically(picture, folder.file("a.png"), few);
    // More rows than one batch of black has.
    show_in(3000);
    picture.specmod().full_height = 1000;
    picture.set_origin(0, 600);
    picture.specmod().full_y = 0;
    write_image_atomically(picture, folder.file("a.png"), TypeDesc::UINT8);
    const ImageBuf back = read_image(folder.file("a.png"));
    EXPECT_EQ(back.spec().height, 1000);
    ImageBuf wanted(ImageSpec(3000, 1000, 3, TypeDesc::FLOAT));
    OIIO::ImageBufAlgo::paste(wanted, 0, 0, 0, 0, picture);
    EXPECT_LE(OIIO::ImageBufAlgo::compare(wanted, back, 1, 1).maxerror, 0.51 / 255);
}

TEST(FileTags, FilesThatDeclareMoreThanTheyCanHoldAreRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.ppm");
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

/// Of a file with the type that its format has. OIIO 2.4 cannot read its own JPEG 2000 files of
/// some 20 pixels each way.
ImageBuf picture_for(const std::string& format) {
    const bool is_depth = format == "zfile";
    return make_picture(make_spec(
        64, 48, is_depth ? std::vector<std::string>{"Z"} : std::vector<std::string>{"R", "G", "B"},
        is_depth ? TypeDesc::FLOAT : TypeDesc::UINT8));
}

TEST(FileTags, EveryFormatThatIsWrittenIsReadAndToneMapped) {
    const TemporaryFolder folder;
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
        const std::string path = folder.file("a." + extension);
        const std::string out = folder.file("out." + extension);
        const ImageBuf picture = picture_for(format);
        ASSERT_TRUE(picture.write(path)) << format << ": " << picture.geterror();
        const ImageBuf back = read_image(path);
        EXPECT_EQ(static_cast<int>(back.spec().channelnames.size()), back.nchannels()) << format;
        const Tonemapper tonemapper(
            {.op = resolve_picture_operator("hable"), .input = "lin_rec709"});
        tonemap_file(tonemapper, path, folder.file("shown.exr"));
        EXPECT_EQ(read_image(folder.file("shown.exr")).spec().width, 64) << format;
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
    const TemporaryFolder folder;
    const std::string path = folder.file("a.dpx");
    for (const int bits : {8, 10, 12, 16}) {
        for (const char* packing : {"Packed", "Filled, method A", "Filled, method B"}) {
            ImageBuf picture = make_rgb(23, 17, bits == 8 ? TypeDesc::UINT8 : TypeDesc::UINT16);
            picture.specmod().attribute("oiio:BitsPerSample", bits);
            picture.specmod().attribute("dpx:Packing", packing);
            ASSERT_TRUE(picture.write(path)) << picture.geterror();
            const std::string whole = bytes_of(path);
            EXPECT_NO_THROW((void)read_image(path)) << bits << " " << packing;
            for (const std::size_t lost : {40, 600}) {
                std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() - lost);
                EXPECT_THROW((void)read_image(path), FileError) << bits << " " << packing;
            }
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
