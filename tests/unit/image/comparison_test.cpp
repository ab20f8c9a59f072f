// SPDX-License-Identifier: Apache-2.0
#include "image/comparison.h"
#include "tonewright/error.h"

#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>
#include "unit/image/pictures.h"

#include <cmath>
#include <limits>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

/// Every pixel and channel different.
ImageBuf counted(int width, int height, int channels, float from) {
    ImageBuf picture(ImageSpec(width, height, channels, TypeDesc::FLOAT));
    auto* pixels = static_cast<float*>(picture.localpixels());
    for (int i = 0; i < width * height * channels; ++i)
        pixels[i] = from + static_cast<float>(i) / 16384;
    return picture;
}

float at(const ImageBuf& picture, int x, int y, int c) { return picture.getchannel(x, y, 0, c); }

/// Number of columns (or rows) from the first that are of `a`, and of those at the end that are of
/// `b`, bit for bit; the line is between them. -1: there are other pixels.
std::pair<int, int> sides(const ImageBuf& split, const ImageBuf& a, const ImageBuf& b,
                          bool is_horizontal, int left, int top) {
    const int width = a.spec().width;
    const int height = a.spec().height;
    const int length = is_horizontal ? height : width;
    const int across = is_horizontal ? width : height;
    const auto is_of = [&](const ImageBuf& picture, int i) {
        for (int j = 0; j < across; ++j) {
            const int x = is_horizontal ? j : i;
            const int y = is_horizontal ? i : j;
            for (int c = 0; c < 3; ++c) {
                if (at(split, left + x, top + y, c) != at(picture, x, y, c)) return false;
            }
        }
        return true;
    };
    int first = 0;
    while (first < length && is_of(a, first))
        ++first;
    int second = 0;
    while (second < length && is_of(b, length - 1 - second))
        ++second;
    return {first, second};
}

TEST(Split, PixelsAreThoseOfTheTwoPictures) {
    const ImageBuf a = counted(64, 40, 3, 0.1F);
    const ImageBuf b = counted(64, 40, 3, 0.5F);
    for (const bool is_horizontal : {false, true}) {
        const int length = is_horizontal ? 40 : 64;
        for (const double position : {0.0, 0.01, 0.25, 0.5, 0.99, 1.0}) {
            SplitOptions options;
            options.position = position;
            options.is_horizontal = is_horizontal;
            options.has_labels = false;
            const ImageBuf split = make_split(a, b, options);
            EXPECT_EQ(split.spec().width, 64);
            EXPECT_EQ(split.spec().height, 40);
            const int edge = static_cast<int>(std::lround(position * length));
            EXPECT_EQ(sides(split, a, b, is_horizontal, 0, 0), std::make_pair(edge, length - edge))
                << position;
        }
    }
}

TEST(Split, TheLineCoversThreePixelsAndLabelsNone) {
    const ImageBuf a = counted(400, 60, 3, 0.1F);
    const ImageBuf b = counted(400, 60, 3, 0.3F);
    SplitOptions options;
    options.before = {"Before", "before:preset"};
    options.after = {"After", "after"};
    const ImageBuf split = make_split(a, b, options);
    EXPECT_EQ(split.spec().width, 400);
    EXPECT_GT(split.spec().height, 60);
    EXPECT_EQ(sides(split, a, b, false, 0, 0), std::make_pair(199, 198));
    EXPECT_GT(at(split, 200, 30, 0), 0.9F);
    EXPECT_LT(at(split, 199, 30, 0), 0.1F);
    EXPECT_LT(at(split, 201, 30, 0), 0.1F);
    options.is_horizontal = true;
    const ImageBuf above = make_split(a, b, options);
    const int band = (above.spec().height - 60) / 2;
    EXPECT_EQ(sides(above, a, b, true, 0, band), std::make_pair(29, 28));
    for (const double position : {0.0, 1.0}) {  // one picture, no line
        options.position = position;
        const auto [first, second] = sides(make_split(a, b, options), a, b, true, 0, band);
        EXPECT_EQ(first, position == 1 ? 60 : 0);
        EXPECT_EQ(second, position == 1 ? 0 : 60);
    }
}

TEST(Split, SmallPicturesKeepTheirPixelsAndGetRoomForWords) {
    const ImageBuf a = counted(16, 16, 3, 0.2F);
    const ImageBuf b = counted(16, 16, 1, 0.6F);  // gray is shown as gray
    SplitOptions options;
    options.before = {"A", "a"};
    options.position = 1;
    const ImageBuf split = make_split(a, b, options);
    ASSERT_EQ(split.spec().width, 320);
    EXPECT_EQ(sides(split, a, a, false, 152, 0).first, 16);
    options.position = 0;
    const ImageBuf gray = make_split(a, b, options);
    EXPECT_EQ(at(gray, 152 + 3, 5, 2), at(b, 3, 5, 0));
}

TEST(Split, BadArguments) {
    const ImageBuf a = counted(8, 8, 3, 0);
    SplitOptions options;
    EXPECT_THROW((void)make_split(a, counted(8, 9, 3, 0), options), Error);
    for (const double position : {-0.1, 1.1, std::nan("")}) {
        options.position = position;
        EXPECT_THROW((void)make_split(a, a, options), Error) << position;
    }
}

TEST(Difference, OfCodeValuesTimesTheGain) {
    ImageBuf a(ImageSpec(2, 1, 3, TypeDesc::FLOAT));
    ImageBuf b(ImageSpec(2, 1, 3, TypeDesc::FLOAT));
    const float red[] = {0.5F, 0.25F, 1};
    const float other[] = {0.25F, 0.5F, 0};
    a.setpixel(0, 0, red);
    b.setpixel(0, 0, other);
    a.setpixel(1, 0, red);
    b.setpixel(1, 0, red);
    const PictureDifference difference = difference_of(a, b, 2);
    EXPECT_EQ(at(difference.picture, 0, 0, 0), 0.5F);
    EXPECT_EQ(at(difference.picture, 0, 0, 1), 0.5F);
    EXPECT_EQ(at(difference.picture, 0, 0, 2), 1);  // 2, which is white
    EXPECT_EQ(at(difference.picture, 1, 0, 2), 0);
    EXPECT_EQ(difference.largest, 1);
    EXPECT_EQ(difference.mean, 1.5 / 6);
}

TEST(ResizeScene, LeavesAPictureOfThatSizeAlone) {
    const ImageBuf picture = counted(30, 20, 4, -2);
    const ImageBuf scene = resize_scene(picture, 30);
    ASSERT_EQ(scene.nchannels(), 4);
    EXPECT_EQ(scene.spec().alpha_channel, 3);
    for (int y = 0; y < 20; ++y) {
        for (int c = 0; c < 4; ++c)
            EXPECT_EQ(at(scene, 29, y, c), at(picture, 29, y, c));
    }
}

TEST(ResizeScene, IsAMeanOfLight) {
    ImageBuf checker(ImageSpec(200, 100, 3, TypeDesc::FLOAT));
    OIIO::ImageBufAlgo::checker(checker, 1, 1, 1, {0.0F, 0.5F, -1.0F}, {64.0F, 0.5F, 3.0F});
    const ImageBuf scene = resize_scene(checker, 50);
    EXPECT_EQ(scene.spec().height, 25);
    EXPECT_NEAR(at(scene, 25, 12, 0), 32, 0.5);  // what the filter leaves of the pattern
    EXPECT_NEAR(at(scene, 25, 12, 1), 0.5, 1e-6);
    EXPECT_NEAR(at(scene, 25, 12, 2), 1, 0.05);
}

TEST(ResizeScene, ASunKeepsItsColor) {
    ImageBuf picture = counted(64, 64, 3, 1);
    for (int y = 16; y < 48; ++y) {
        for (int x = 16; x < 48; ++x) {
            const float sun[] = {3e5F, 2e5F, 8e4F};
            picture.setpixel(x, y, sun);
        }
    }
    const ImageBuf small = resize_scene(picture, 16);
    // The filter's weights, whose sum is 1, have a few roundings.
    EXPECT_NEAR(at(small, 8, 8, 0), 3e5, 1);
    EXPECT_NEAR(at(small, 8, 8, 1), 2e5, 1);
    EXPECT_NEAR(at(small, 8, 8, 2), 8e4, 1);
}

TEST(ResizeScene, OneBadPixelDoesNotSpoilItsNeighbors) {
    ImageBuf picture = counted(64, 64, 3, 1);
    const float bad[] = {std::numeric_limits<float>::quiet_NaN(),
                         std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity()};
    picture.setpixel(20, 20, bad);
    const ImageBuf same = resize_scene(picture, 64);
    EXPECT_EQ(at(same, 20, 20, 0), 0);
    EXPECT_EQ(at(same, 20, 20, 1), 65504);
    EXPECT_EQ(at(same, 20, 20, 2), -65504);
    const ImageBuf small = resize_scene(picture, 16);
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 16; ++x) {
            for (int c = 0; c < 3; ++c)
                EXPECT_TRUE(std::isfinite(at(small, x, y, c)));
        }
    }
    EXPECT_NEAR(at(small, 12, 12, 1), 1.5, 0.5);
}

TEST(ResizeScene, RepeatsPixelsAndKeepsShapes) {
    const ImageBuf tiny = counted(2, 2, 3, 0);
    const ImageBuf large = resize_scene(tiny, 64);
    ASSERT_EQ(large.spec().height, 64);
    EXPECT_EQ(at(large, 31, 31, 1), at(tiny, 0, 0, 1));
    EXPECT_EQ(at(large, 32, 31, 1), at(tiny, 1, 0, 1));
    EXPECT_EQ(at(large, 31, 32, 1), at(tiny, 0, 1, 1));
    // Data window smaller than the display window, pixels twice as wide as high, more channels.
    ImageBuf odd = counted(20, 20, 6, 1);
    odd.set_full(-20, 20, 0, 20, 0, 1);
    odd.specmod().attribute("PixelAspectRatio", 2.0F);
    const ImageBuf scene = resize_scene(odd, 80);
    EXPECT_EQ(scene.spec().height, 20);
    EXPECT_EQ(scene.nchannels(), 4);
    EXPECT_EQ(at(scene, 39, 10, 0), 0);
    EXPECT_EQ(at(scene, 41, 10, 2), at(odd, 0, 10, 2));
    ImageSpec deep(4, 4, 3, TypeDesc::FLOAT);
    deep.deep = true;
    EXPECT_THROW((void)resize_scene(ImageBuf(deep), 64), Error);
}

TEST(ResizeScene, OfASmallPictureInALargeWindowTakesTheDataAlone) {
    // The filter takes black for pixels outside the data window.
    ImageBuf picture = make_rgb(30, 20);
    picture.set_origin(200, 333);
    OIIO::ImageSpec& spec = picture.specmod();
    spec.full_x = spec.full_y = 0;
    spec.full_width = 1000;
    spec.full_height = 700;
    ImageBuf filled(OIIO::ImageSpec(1000, 700, 3, OIIO::TypeDesc::FLOAT));
    OIIO::ImageBufAlgo::paste(filled, 0, 0, 0, 0, picture);
    const ImageBuf small = resize_scene(picture, 100);
    EXPECT_LE(OIIO::ImageBufAlgo::compare(small, resize_scene(filled, 100), 1, 1).maxerror, 1e-6);
    EXPECT_GT(OIIO::ImageBufAlgo::computePixelStats(small).max[1], 0.1F);
    spec.full_width = spec.full_height = 30'000;  // 11 GB of floats
    EXPECT_EQ(resize_scene(picture, 480).spec().height, 480);
    spec.full_width = spec.full_height = 1'000'000;
    EXPECT_THROW((void)resize_scene(picture, 480), FileError);
}

TEST(ResizeScene, ThinPicturesAreRefused) {
    EXPECT_THROW((void)resize_scene(make_rgb(1, 5000), 480), FileError);
    EXPECT_EQ(resize_scene(make_rgb(1, 50), 16).spec().height, 800);
}

TEST(ChooseColumns, GivesScreenShapeAndFullRows) {
    EXPECT_EQ(choose_columns(1, 480, 270), 1);
    EXPECT_EQ(choose_columns(2, 480, 270), 2);
    EXPECT_EQ(choose_columns(12, 480, 270), 4);  // 4 x 3
    EXPECT_EQ(choose_columns(12, 480, 720), 6);  // portraits
    EXPECT_EQ(choose_columns(12, 480, 160), 3);  // panoramas
    for (int count = 1; count < 60; ++count) {
        const int columns = choose_columns(count, 480, 300);
        EXPECT_GE(columns, 1);
        EXPECT_LE(columns, count);
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
