// SPDX-License-Identifier: Apache-2.0
#include "picture/row_fitter.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "unit/errors.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Alpha = WriteOptions::Alpha;

PictureSpec spec_of(int width, int height, const std::vector<std::string>& channels) {
    PictureSpec spec;
    spec.width = spec.full_width = width;
    spec.height = spec.full_height = height;
    spec.nchannels = static_cast<int>(channels.size());
    spec.channelnames = channels;
    spec.format = OIIO::TypeDesc::FLOAT;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        if (channels[c] == "A") spec.alpha_channel = static_cast<int>(c);
    }
    return spec;
}

/// The floats that a file gets.
struct Fitted {
    PictureSpec spec;
    std::vector<float> pixels;
    std::vector<int> rows;  // the first of each part
    std::string lost_cover;
    std::string cut_off;
};
Fitted fit(const PictureSpec& picture, const std::vector<float>& pixels, const char* format,
           const WriteOptions& options = {}, int batch = 1000) {
    RowFitter fitter(format, format, options);
    Fitted fitted;
    fitted.spec = fitter.open(picture);
    const auto row = static_cast<std::size_t>(picture.width * picture.nchannels);
    for (int y = 0; y < picture.height; y += batch) {
        const RowFitter::Rows rows = {
            picture.y + y, picture.y + std::min(y + batch, picture.height), OIIO::TypeDesc::FLOAT,
            reinterpret_cast<const std::byte*>(&pixels[row * static_cast<std::size_t>(y)])};
        fitter.run(rows, [&](const RowFitter::Rows& part) {
            const auto count = static_cast<std::size_t>((part.yend - part.ybegin) *
                                                        fitted.spec.width * fitted.spec.nchannels);
            const auto* const from = reinterpret_cast<const float*>(part.pixels);
            EXPECT_EQ(part.type, OIIO::TypeDesc::FLOAT);
            fitted.rows.push_back(part.ybegin);
            fitted.pixels.insert(fitted.pixels.end(), from, from + count);
        });
    }
    fitted.lost_cover = fitter.lost_cover();
    fitted.cut_off = fitter.cut_off();
    return fitted;
}

TEST(RowFitter, RowsOfPlainPicturesStay) {
    const std::vector<float> pixels = {0.1F, 0.2F, 0.3F, 4, -5, 6};
    const Fitted fitted = fit(spec_of(1, 2, {"R", "G", "B"}), pixels, "png", {}, 1);
    EXPECT_EQ(fitted.pixels, pixels);
    EXPECT_EQ(fitted.rows, (std::vector{0, 1}));
    EXPECT_EQ(fitted.cut_off, "");
}

TEST(RowFitter, StraightFormatsGetDividedColor) {
    const std::vector<float> pixels = {0.25F, 0.5F, 0,    0.5F, 0.3F, 0.2F,
                                       0.1F,  0,    0.7F, 0.8F, 0.9F, 1};
    const Fitted fitted = fit(spec_of(3, 1, {"R", "G", "B", "A"}), pixels, "png");
    EXPECT_EQ(fitted.pixels,
              (std::vector<float>{0.5F, 1, 0, 0.5F, 0.3F, 0.2F, 0.1F, 0, 0.7F, 0.8F, 0.9F, 1}));
    EXPECT_EQ(fitted.spec.get_int_attribute("oiio:UnassociatedAlpha"), 1);
    // The second pixel has light without alpha: a third of three, rounded up.
    EXPECT_NE(fitted.lost_cover.find("33.4 % of the pixels"), std::string::npos)
        << fitted.lost_cover;
    EXPECT_EQ(fit(spec_of(3, 1, {"R", "G", "B", "A"}), pixels, "openexr").pixels, pixels);
}

TEST(RowFitter, AlphaIsLeftOutFilledOrComposited) {
    const PictureSpec spec = spec_of(1, 1, {"R", "G", "B", "A"});
    const std::vector<float> pixel = {0.25F, 0.5F, 0, 0.5F};
    WriteOptions options;
    options.alpha = Alpha::ignore;
    EXPECT_EQ(fit(spec, pixel, "openexr", options).pixels, (std::vector<float>{0.25F, 0.5F, 0}));
    options.alpha = Alpha::opaque;
    EXPECT_EQ(fit(spec, pixel, "openexr", options).pixels, (std::vector<float>{0.25F, 0.5F, 0, 1}));
    options.alpha = Alpha::over;
    options.background = {1, 0.5F, 0};
    // color + (1 - alpha) background
    EXPECT_EQ(fit(spec, pixel, "openexr", options).pixels, (std::vector<float>{0.75F, 0.75F, 0}));
    EXPECT_EQ(error_of([&] {
                  (void)fit(spec_of(1, 1, {"Y", "A"}), {0.5F, 1}, "openexr", options);
              }),
              "alpha is over:1,0.5,0; expected three equal numbers, because the picture is gray");
}

TEST(RowFitter, StraightPicturesAreMultipliedWhereAFormatHoldsNone) {
    PictureSpec spec = spec_of(1, 1, {"R", "G", "B", "A"});
    spec.attribute("oiio:UnassociatedAlpha", 1);
    const std::vector<float> pixel = {0.5F, 1, 0, 0.5F};
    const Fitted fitted = fit(spec, pixel, "openexr");
    EXPECT_EQ(fitted.pixels, (std::vector<float>{0.25F, 0.5F, 0, 0.5F}));
    EXPECT_EQ(fitted.spec.find_attribute("oiio:UnassociatedAlpha"), nullptr);
    EXPECT_EQ(fit(spec, pixel, "png").pixels, pixel);
}

TEST(RowFitter, GrayBecomesColorWhereAFormatHasNone) {
    const Fitted fitted = fit(spec_of(2, 1, {"Y"}), {0.25F, 0.5F}, "hdr");
    EXPECT_EQ(fitted.spec.nchannels, 3);
    EXPECT_EQ(fitted.spec.channelnames, (std::vector<std::string>{"R", "G", "B"}));
    EXPECT_EQ(fitted.pixels, (std::vector<float>{0.25F, 0.25F, 0.25F, 0.5F, 0.5F, 0.5F}));
}

TEST(RowFitter, DataWindowsAreCutAndPadded) {
    PictureSpec spec = spec_of(2, 2, {"Y"});
    spec.x = -1;
    spec.y = 1;
    spec.full_width = 3;
    spec.full_height = 4;
    // Rows 1 and 2, columns -1 and 0, in a display of 3 x 4 pixels.
    const Fitted fitted = fit(spec, {1, 2, 3, 4}, "png", {}, 1);
    EXPECT_EQ(fitted.pixels, (std::vector<float>{0, 0, 0, 2, 0, 0, 4, 0, 0, 0, 0, 0}));
    EXPECT_EQ(fitted.spec.width, 3);
    EXPECT_EQ(fitted.spec.height, 4);
    EXPECT_EQ(fitted.cut_off.find("50 % of the data window"), 0U) << fitted.cut_off;
    const Fitted exr = fit(spec, {1, 2, 3, 4}, "openexr");
    EXPECT_EQ(exr.pixels, (std::vector<float>{1, 2, 3, 4}));
    EXPECT_EQ(exr.spec.x, -1);
    spec.full_width = 100'000;
    spec.full_height = 100'000;
    EXPECT_NE(error_of([&] {
                  (void)fit(spec, {1, 2, 3, 4}, "png");
              }).find("the display window is 100000 x 100000"),
              std::string::npos);
}

TEST(RowFitter, TypesFollowTheSourceInExrFilesAlone) {
    for (const auto& [source, file] : {std::pair(OIIO::TypeDesc::HALF, OIIO::TypeDesc::HALF),
                                       std::pair(OIIO::TypeDesc::UINT8, OIIO::TypeDesc::HALF),
                                       std::pair(OIIO::TypeDesc::UINT16, OIIO::TypeDesc::FLOAT),
                                       std::pair(OIIO::TypeDesc::FLOAT, OIIO::TypeDesc::FLOAT)}) {
        EXPECT_EQ(openexr_type(source), file);
        RowFitter exr("openexr", "openexr", {});
        exr.keep_type(source);
        EXPECT_EQ(exr.open(spec_of(1, 1, {"R", "G", "B"})).format, file);
        RowFitter png("png", "png", {});
        png.keep_type(source);
        EXPECT_EQ(png.open(spec_of(1, 1, {"R", "G", "B"})).format, OIIO::TypeDesc::FLOAT);
    }
}

TEST(RowFitter, IntegersGetTheirLargestAlpha) {
    WriteOptions options;
    options.alpha = Alpha::opaque;
    RowFitter fitter("targa", "targa", options);
    PictureSpec spec = spec_of(1, 1, {"R", "G", "B", "A"});
    spec.format = OIIO::TypeDesc::UINT8;
    spec.attribute("oiio:UnassociatedAlpha", 1);
    (void)fitter.open(spec);
    const std::vector<unsigned char> pixel = {10, 20, 30, 40};
    fitter.run({0, 1, OIIO::TypeDesc::UINT8, reinterpret_cast<const std::byte*>(pixel.data())},
               [](const RowFitter::Rows& part) {
                   std::vector<unsigned char> found(4);
                   std::memcpy(found.data(), part.pixels, 4);
                   EXPECT_EQ(found, (std::vector<unsigned char>{10, 20, 30, 255}));
               });
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
