// SPDX-License-Identifier: Apache-2.0
//
// Files that the test writes with libheif. Expected codes: ITU-T H.273, ITU-R BT.2100-2.
#include "image/heif_reader.h"

#include <gtest/gtest.h>
#include <libheif/heif.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "image/picture_file.h"
#include "tonewright/color.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 64;

using Points = std::array<int, 4>;  // primaries, transfer, matrix, full range
using Codes = std::vector<unsigned>;

struct Picture {
    int bits = 10;
    heif_colorspace space = heif_colorspace_RGB;
    Points points = {9, 16, 0, 1};
    /// Codes of one pixel at x, y: R, G, B or Y, Cb, Cr or Y; then alpha.
    std::function<Codes(int, int)> at;
    bool has_alpha = false;
    bool is_premultiplied = false;
    std::string icc;
    std::string exif;
    int orientation = 1;
    bool has_code_points = true;
};

void require(const heif_error& error) { ASSERT_EQ(error.code, heif_error_Ok) << error.message; }

class HeifReader : public ::testing::Test {
  protected:
    void SetUp() override {
        for (const auto codec : {heif_compression_AV1, heif_compression_HEVC}) {
            if (!heif_have_encoder_for_format(codec))
                GTEST_SKIP() << "libheif has no encoder of HEVC or AV1";
        }
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    /// @returns  its path
    std::string write(const Picture& p, const std::string& name = "x.avif") {
        heif_context* context = heif_context_alloc();
        heif_encoder* encoder = nullptr;
        // libheif 1.15 has libaom end the process for more than 8 bits.
        require(heif_context_get_encoder_for_format(
            context, p.bits > 8 ? heif_compression_HEVC : heif_compression_AV1, &encoder));
        heif_encoder_set_lossless(encoder, 1);
        heif_encoder_set_parameter_string(encoder, "chroma", "444");
        heif_encoder_set_parameter(encoder, p.bits > 8 ? "preset" : "speed",
                                   p.bits > 8 ? "ultrafast" : "9");
        heif_image* image = nullptr;
        const bool is_gray = p.space == heif_colorspace_monochrome;
        require(heif_image_create(kWidth, kHeight, p.space,
                                  is_gray ? heif_chroma_monochrome : heif_chroma_444, &image));
        std::vector<heif_channel> channels = {heif_channel_Y};
        if (p.space == heif_colorspace_RGB)
            channels = {heif_channel_R, heif_channel_G, heif_channel_B};
        if (p.space == heif_colorspace_YCbCr)
            channels = {heif_channel_Y, heif_channel_Cb, heif_channel_Cr};
        if (p.has_alpha) channels.push_back(heif_channel_Alpha);
        for (std::size_t c = 0; c < channels.size(); ++c) {
            require(heif_image_add_plane(image, channels[c], kWidth, kHeight, p.bits));
            int stride = 0;
            std::uint8_t* plane = heif_image_get_plane(image, channels[c], &stride);
            for (int y = 0; y < kHeight; ++y) {
                for (int x = 0; x < kWidth; ++x) {
                    const auto code = static_cast<std::uint16_t>(p.at(x, y)[c]);
                    std::uint8_t* row = plane + y * stride;
                    if (p.bits > 8) {
                        std::memcpy(row + 2 * x, &code, 2);
                    } else {
                        row[x] = static_cast<std::uint8_t>(code);
                    }
                }
            }
        }
        if (p.is_premultiplied) heif_image_set_premultiplied_alpha(image, 1);
        heif_color_profile_nclx* nclx = heif_nclx_color_profile_alloc();
        nclx->color_primaries = static_cast<heif_color_primaries>(p.points[0]);
        nclx->transfer_characteristics = static_cast<heif_transfer_characteristics>(p.points[1]);
        nclx->matrix_coefficients = static_cast<heif_matrix_coefficients>(p.points[2]);
        nclx->full_range_flag = static_cast<std::uint8_t>(p.points[3]);
        require(heif_image_set_nclx_color_profile(image, nclx));
        if (!p.icc.empty())
            require(heif_image_set_raw_color_profile(image, "prof", p.icc.data(), p.icc.size()));
        heif_encoding_options* options = heif_encoding_options_alloc();
        options->output_nclx_profile = nclx;
        options->macOS_compatibility_workaround_no_nclx_profile = p.has_code_points ? 0 : 1;
        options->save_two_colr_boxes_when_ICC_and_nclx_available = p.has_code_points ? 1 : 0;
        options->image_orientation = static_cast<heif_orientation>(p.orientation);
        heif_image_handle* handle = nullptr;
        require(heif_context_encode_image(context, image, encoder, options, &handle));
        if (!p.exif.empty())
            require(heif_context_add_exif_metadata(context, handle, p.exif.data(),
                                                   static_cast<int>(p.exif.size())));
        std::string path = (folder_ / name).string();
        require(heif_context_write_to_file(context, path.c_str()));
        heif_image_handle_release(handle);
        heif_encoding_options_free(options);
        heif_nclx_color_profile_free(nclx);
        heif_image_release(image);
        heif_encoder_release(encoder);
        heif_context_free(context);
        return path;
    }

    std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("tonewright_heif." + std::to_string(getpid()));
};

/// A ramp, with all codes of 8 and 10 bits somewhere.
Codes ramp(int x, int y, int bits) {
    const unsigned i = static_cast<unsigned>(y * kWidth + x);
    const unsigned largest = (1U << bits) - 1;
    return {i & largest, (i * 7) & largest, largest - (i & largest), (i * 3) & largest};
}

std::vector<std::uint16_t> pixels_of(OIIO::ImageInput& in) {
    const OIIO::ImageSpec& s = in.spec();
    std::vector<std::uint16_t> pixels(s.image_pixels() * static_cast<std::size_t>(s.nchannels));
    EXPECT_TRUE(in.read_image(0, 0, 0, s.nchannels, OIIO::TypeDesc::UINT16, pixels.data()))
        << in.geterror();
    return pixels;
}

Points code_points_of(const OIIO::ImageSpec& spec) {
    const OIIO::ParamValue* value =
        spec.find_attribute("CICP", OIIO::TypeDesc(OIIO::TypeDesc::INT, 4));
    Points points = {-1, -1, -1, -1};
    if (value) std::memcpy(points.data(), value->data(), sizeof(points));
    return points;
}

TEST_F(HeifReader, DeliversAllBits) {
    for (const int bits : {8, 10, 12}) {
        SCOPED_TRACE(bits);
        Picture p;
        p.bits = bits;
        p.at = [bits](int x, int y) { return ramp(x, y, bits); };
        const std::string path = write(p);
        EXPECT_TRUE(is_heif(path));
        const auto in = open_heif(path, 1e6);
        EXPECT_STREQ(in->format_name(), "heif");
        EXPECT_EQ(in->spec().format, bits == 8 ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16);
        EXPECT_EQ(in->spec().get_int_attribute("oiio:BitsPerSample"), bits);
        EXPECT_EQ(in->spec().nchannels, 3);
        EXPECT_EQ(code_points_of(in->spec()), p.points);
        const std::vector<std::uint16_t> got = pixels_of(*in);
        const double largest = (1 << bits) - 1;
        std::size_t i = 0;
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                for (std::size_t c = 0; c < 3; ++c)
                    ASSERT_EQ(got[i++], std::lround(p.at(x, y)[c] * 65535 / largest));
            }
        }
    }
}

// ITU-R BT.2100-2, table 9, and the matrix of table 6.
TEST_F(HeifReader, ConvertsYCbCrOfFullAndLimitedRange) {
    const Vector3 rgb = {0.7, 0.4, 0.2};
    const double luma = 0.2627 * rgb[0] + 0.6780 * rgb[1] + 0.0593 * rgb[2];
    const double blue = (rgb[2] - luma) / 1.8814;
    const double red = (rgb[0] - luma) / 1.4746;
    for (const int is_full : {0, 1}) {
        for (const int bits : {8, 10, 12}) {
            SCOPED_TRACE(std::to_string(is_full) + " " + std::to_string(bits));
            const double unit = 1 << (bits - 8);
            const double largest = (1 << bits) - 1;
            const double span = is_full ? largest : 219 * unit;
            const double chroma_span = is_full ? largest : 224 * unit;
            const auto code = [](double v) { return static_cast<unsigned>(std::lround(v)); };
            Picture p;
            p.bits = bits;
            p.space = heif_colorspace_YCbCr;
            p.points = {9, 16, 9, is_full};
            const Codes codes = {code(luma * span + (is_full ? 0 : 16 * unit)),
                                 code(blue * chroma_span + 128 * unit),
                                 code(red * chroma_span + 128 * unit)};
            p.at = [&](int, int) { return codes; };
            const auto in = open_heif(write(p), 1e6);
            EXPECT_EQ(code_points_of(in->spec()), p.points);
            const std::vector<std::uint16_t> got = pixels_of(*in);
            // Half a code of luma and of both chroma channels, and half a code of libheif's result.
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(got[c] / 65535.0, rgb[c], 2.2 / span);
        }
    }
}

TEST_F(HeifReader, PqWhiteOf203IsThatLuminance) {
    // SMPTE ST 2084: 203 cd/m2 is 0.5806889, of 10 bits in limited range code 573 (BT.2408: 58 %).
    Picture p;
    p.space = heif_colorspace_YCbCr;
    p.points = {9, 16, 9, 0};
    p.at = [](int, int) { return Codes{573, 512, 512}; };
    const auto in = open_heif(write(p), 1e6);
    const std::vector<std::uint16_t> got = pixels_of(*in);
    for (std::size_t c = 0; c < 3; ++c) {
        // A code of 10 bits is 1 % here.
        EXPECT_NEAR(evaluate(pq_decode_nits(Expr::input()), got[c] / 65535.0), 203, 2);
    }
}

TEST_F(HeifReader, GivesTheCodePointsOfTheFile) {
    for (const Points& points :
         {Points{1, 13, 0, 1}, Points{12, 13, 0, 1}, Points{9, 18, 0, 1}, Points{1, 1, 0, 1}}) {
        Picture p;
        p.points = points;
        p.at = [](int x, int y) { return ramp(x, y, 10); };
        EXPECT_EQ(code_points_of(open_heif(write(p), 1e6)->spec()), points);
    }
}

// libheif 1.15 narrows such pixels twice: an error is better than wrong colors.
TEST_F(HeifReader, RefusesRgbOfLimitedRange) {
    Picture p;
    p.points = {9, 16, 0, 0};
    p.at = [](int x, int y) { return ramp(x, y, 10); };
    try {
        (void)open_heif(write(p), 1e6);
        ADD_FAILURE() << "no error";
    } catch (const FileError& e) {
        EXPECT_NE(std::string(e.what()).find("limited range"), std::string::npos) << e.what();
    }
}

TEST_F(HeifReader, MonochromeHasOneChannel) {
    for (const int is_full : {0, 1}) {
        SCOPED_TRACE(is_full);
        Picture p;
        p.space = heif_colorspace_monochrome;
        p.points = {1, 13, 1, is_full};
        p.at = [](int x, int y) { return Codes{ramp(x, y, 10)[0]}; };
        const auto in = open_heif(write(p), 1e6);
        ASSERT_EQ(in->spec().nchannels, 1);
        const std::vector<std::uint16_t> got = pixels_of(*in);
        for (std::size_t i = 0; i < got.size(); ++i) {
            const auto code = static_cast<double>(i % 1024);
            const double value = is_full ? code / 1023 : (code - 64) / 876;
            ASSERT_EQ(got[i], std::lround(65535 * std::min(std::max(value, 0.0), 1.0)));
        }
    }
}

TEST_F(HeifReader, AlphaIsStraightOrPremultiplied) {
    for (const bool is_premultiplied : {false, true}) {
        Picture p;
        p.bits = 8;
        p.points = {1, 13, 0, 1};
        p.has_alpha = true;
        p.is_premultiplied = is_premultiplied;
        p.at = [](int x, int y) { return ramp(x, y, 8); };
        const auto in = open_heif(write(p), 1e6);
        const OIIO::ImageSpec& s = in->spec();
        ASSERT_EQ(s.nchannels, 4);
        EXPECT_EQ(s.alpha_channel, 3);
        EXPECT_EQ(s.get_int_attribute("oiio:UnassociatedAlpha", 0), is_premultiplied ? 0 : 1);
        // Unchanged numbers, also where alpha is small.
        const std::vector<std::uint16_t> got = pixels_of(*in);
        for (std::size_t i = 0; i < 400; ++i) {
            const Codes codes = ramp(static_cast<int>(i % kWidth), static_cast<int>(i / kWidth), 8);
            for (std::size_t c = 0; c < 4; ++c)
                ASSERT_EQ(got[4 * i + c], codes[c] * 257);
        }
    }
}

TEST_F(HeifReader, GivesProfilesAndExif) {
    Picture p;
    p.at = [](int x, int y) { return ramp(x, y, 10); };
    p.icc = std::string(300, 'p');
    // A TIFF header, one entry: orientation 6, which does not count in HEIF.
    p.exif = std::string("Exif\0\0", 6) + std::string(
                                              "II*\0\x8\0\0\0\1\0\x12\1\3\0\1\0\0\0\6\0\0\0"
                                              "\0\0\0\0",
                                              26);
    const auto in = open_heif(write(p), 1e6);
    const OIIO::ImageSpec& s = in->spec();
    const OIIO::ParamValue* icc = s.find_attribute("ICCProfile");
    ASSERT_NE(icc, nullptr);
    EXPECT_EQ(std::string(static_cast<const char*>(icc->data()), icc->type().size()), p.icc);
    EXPECT_EQ(s.get_int_attribute("Orientation", 0), 1);
    EXPECT_EQ(s.get_int_attribute("heif:ExifOrientation", 0), 6);
    EXPECT_EQ(s.width, kWidth);
}

// The item of a gain map stands beside the picture, and libheif 1.15 does not list it.
TEST_F(HeifReader, NamesAGainMap) {
    Picture p;
    p.at = [](int x, int y) { return ramp(x, y, 10); };
    p.exif = std::string("Exif\0\0nothing", 13);
    const std::string path = write(p);
    EXPECT_EQ(open_heif(path, 1e6)->spec().get_string_attribute("heif:GainMap"), "");
    std::ifstream file(path, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(file), {}};
    const std::size_t type = bytes.find("Exif", bytes.find("iinf"));
    ASSERT_LT(type, bytes.find("iprp"));
    bytes.replace(type, 4, "tmap");
    std::ofstream(path, std::ios::binary) << bytes;
    EXPECT_EQ(open_heif(path, 1e6)->spec().get_string_attribute("heif:GainMap"),
              "tmap (ISO 21496-1)");
}

// irot and imir: as for Exif, 6 shows the first row at the right.
TEST_F(HeifReader, PixelsAreUpright) {
    for (const int orientation : {1, 2, 3, 4, 5, 6, 7, 8}) {
        SCOPED_TRACE(orientation);
        Picture p;
        p.bits = 8;
        p.points = {1, 13, 0, 1};
        p.orientation = orientation;
        p.at = [](int x, int y) {
            return Codes{x < kWidth / 2 ? 10U : 200U, y < kHeight / 2 ? 20U : 150U, 0};
        };
        const auto in = open_heif(write(p), 1e6);
        EXPECT_EQ(in->spec().get_int_attribute("Orientation", 0), 1);
        const std::vector<std::uint16_t> got = pixels_of(*in);
        // Exif 2.32, 4.6.4 A: where the first row and the first column are shown.
        const bool swaps = orientation >= 5;
        const bool flips_x =
            orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
        const bool flips_y =
            orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
        for (const auto& [x, y] : {std::pair(8, 8), std::pair(56, 8), std::pair(8, 56)}) {
            int from_x = swaps ? y : x;
            int from_y = swaps ? x : y;
            if (flips_x) from_x = kWidth - 1 - from_x;
            if (flips_y) from_y = kHeight - 1 - from_y;
            const Codes expected = p.at(from_x, from_y);
            const auto i = 3 * static_cast<std::size_t>(y * kWidth + x);
            EXPECT_EQ(got[i] / 257, expected[0]) << x << " " << y;
            EXPECT_EQ(got[i + 1] / 257, expected[1]) << x << " " << y;
        }
    }
}

void expect_error(const std::string& path, double max_pixels, const std::string& text) {
    try {
        (void)open_heif(path, max_pixels);
        ADD_FAILURE() << "no error; expected " << text;
    } catch (const FileError& e) {
        const std::string message = e.what();
        EXPECT_EQ(message.rfind(path + ": cannot read: ", 0), 0U) << message;
        EXPECT_NE(message.find(text), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

TEST_F(HeifReader, DamagedFilesAreErrorsOfOneLine) {
    Picture p;
    p.at = [](int x, int y) { return ramp(x, y, 10); };
    const std::string path = write(p);
    expect_error(path, 4095, "it declares 64 x 64 pixels; expected at most 4095");
    EXPECT_NE(open_heif(path, 4096), nullptr);
    EXPECT_NE(open_picture(path), nullptr);
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    const std::string part = (folder_ / "part.avif").string();
    for (std::size_t size = 40; size < bytes.size(); size += bytes.size() / 60 + 1) {
        std::ofstream(part, std::ios::binary) << bytes.substr(0, size);
        EXPECT_TRUE(is_heif(part));
        expect_error(part, 1e6, "");
    }
    // Code points that libheif does not know, and forgets.
    const std::size_t colr = bytes.find("colrnclx");
    ASSERT_NE(colr, std::string::npos);
    std::string unknown = bytes;
    unknown.replace(colr + 8, 4, std::string("\0\x63\0\x10", 4));
    std::ofstream(part, std::ios::binary) << unknown;
    EXPECT_EQ(code_points_of(open_heif(part, 1e6)->spec()), (Points{99, 16, 0, 1}));
}

TEST_F(HeifReader, KnowsItsFilesByTheirContents) {
    const std::string path = (folder_ / "x.avif").string();
    const auto is_known = [&](const std::string& bytes) {
        std::ofstream(path, std::ios::binary) << bytes;
        return is_heif(path);
    };
    EXPECT_TRUE(
        is_known(std::string("\0\0\0\x1c"
                             "ftypabcd\0\0\0\0miafisomheix",
                             28)));
    EXPECT_FALSE(
        is_known(std::string("\0\0\0\x18"
                             "ftypisomheicmp42mp41",
                             24)));
    EXPECT_FALSE(is_known("\x89PNG\r\n\x1a\n"));
    EXPECT_FALSE(is_known(""));
    EXPECT_FALSE(is_heif((folder_ / "missing.heic").string()));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
