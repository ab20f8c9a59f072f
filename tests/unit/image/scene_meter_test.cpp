// SPDX-License-Identifier: Apache-2.0
#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "tonewright/tonemap.h"
#include "unit/folder.h"
#include "unit/image/pictures.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;
using OIIO::TypeDesc;
using Unpremult = TonemapOptions::Unpremult;

const float kInf = std::numeric_limits<float>::infinity();
const float kNan = std::numeric_limits<float>::quiet_NaN();

/// One row of colors.
ImageBuf row_of(const std::vector<std::vector<float>>& pixels) {
    const std::size_t channels = pixels.front().size();
    std::vector<std::string> names = {"Y"};
    if (channels == 2) names = {"Y", "A"};
    if (channels >= 3) names = {"R", "G", "B"};
    if (channels == 4) names.emplace_back("A");
    ImageBuf picture(make_spec(static_cast<int>(pixels.size()), 1, names, TypeDesc::FLOAT));
    for (std::size_t x = 0; x < pixels.size(); ++x)
        set(picture, static_cast<int>(x), 0, pixels[x]);
    return picture;
}

bool same_statistics(const SceneStatistics& a, const SceneStatistics& b) {
    return a.log_average == b.log_average && a.mean_luminance == b.mean_luminance &&
           a.minimum_luminance == b.minimum_luminance &&
           a.maximum_luminance == b.maximum_luminance && a.mean_rgb == b.mean_rgb &&
           a.maximum_rgb == b.maximum_rgb;
}

/// `relative` of each figure: 1e-15 covers a few roundings of double.
void expect_statistics(const SceneStatistics& actual, const SceneStatistics& expected,
                       double relative = 1e-15) {
    const auto near = [&](double a, double b, const char* what) {
        EXPECT_NEAR(a, b, relative * std::fabs(b)) << what;
    };
    near(actual.log_average, expected.log_average, "log average");
    near(actual.mean_luminance, expected.mean_luminance, "mean luminance");
    near(actual.minimum_luminance, expected.minimum_luminance, "minimum");
    near(actual.maximum_luminance, expected.maximum_luminance, "maximum");
    for (std::size_t c = 0; c < 3; ++c) {
        near(actual.mean_rgb[c], expected.mean_rgb[c], "mean of a channel");
        near(actual.maximum_rgb[c], expected.maximum_rgb[c], "maximum of a channel");
    }
}

/// By the definition, pixel by pixel in long double.
SceneStatistics by_definition(const ImageBuf& picture) {
    long double log_sum = 0;
    long double sum = 0;
    std::array<long double, 3> rgb_sum{};
    std::size_t count = 0;
    std::size_t lit = 0;
    SceneStatistics s;
    s.minimum_luminance = kInfinity;
    const int channels = picture.nchannels();
    std::vector<float> values(picture.spec().image_pixels() * static_cast<std::size_t>(channels));
    EXPECT_TRUE(picture.get_pixels(picture.roi(), TypeDesc::FLOAT, values.data()));
    for (std::size_t at = 0; at < values.size();
         at += static_cast<std::size_t>(channels), ++count) {
        long double L = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            // Negatives of signed types count as 0.
            const double x = std::max(static_cast<double>(values[at + c]), 0.0);
            L += static_cast<long double>(kRec709Weights[c]) * x;
            rgb_sum[c] += x;
            s.maximum_rgb[c] = std::max(s.maximum_rgb[c], x);
        }
        sum += L;
        const auto luminance = static_cast<double>(L);
        s.maximum_luminance = std::max(s.maximum_luminance, luminance);
        if (L <= 0) continue;
        ++lit;
        log_sum += std::log(L);
        s.minimum_luminance = std::min(s.minimum_luminance, luminance);
    }
    const auto n = static_cast<long double>(count);
    s.log_average = static_cast<double>(std::exp(log_sum / static_cast<long double>(lit)));
    s.mean_luminance = static_cast<double>(sum / n);
    for (std::size_t c = 0; c < 3; ++c)
        s.mean_rgb[c] = static_cast<double>(rgb_sum[c] / n);
    return s;
}

TEST(SceneStatistics, OfGraysByHand) {
    // Powers of 2, whose logarithms cancel: the geometric mean of 1/4, 1/2, 4 and 8 is 2^0.5.
    const double mean = 12.75 / 4;
    expect_statistics(measure_scene(row_of({{0.25F}, {0.5F}, {4}, {8}})),
                      {std::sqrt(2.0), mean, 0.25, 8, {mean, mean, mean}, {8, 8, 8}});
}

TEST(SceneStatistics, OfColorsByHand) {
    // L = 0.2126 R + 0.7152 G + 0.0722 B: 0.2126, 1.4304 and 0.2888.
    expect_statistics(measure_scene(row_of({{1, 0, 0}, {0, 2, 0}, {0, 0, 4}})),
                      {std::cbrt(0.2126 * 1.4304 * 0.2888),
                       (0.2126 + 1.4304 + 0.2888) / 3,
                       0.2126,
                       1.4304,
                       {1.0 / 3, 2.0 / 3, 4.0 / 3},
                       {1, 2, 4}});
}

TEST(SceneStatistics, BlackCountsInMeansAlone) {
    expect_statistics(measure_scene(row_of({{0, 0, 0}, {2, 2, 2}, {8, 8, 8}, {0, 0, 0}})),
                      {4, 2.5, 2, 8, {2.5, 2.5, 2.5}, {8, 8, 8}});
}

TEST(SceneStatistics, WithoutLightTheyAreZero) {
    for (const auto& picture :
         {row_of({{0, 0, 0}, {0, 0, 0}}), row_of({{kNan, -1, -kInf}}), row_of({{0}})}) {
        EXPECT_TRUE(same_statistics(measure_scene(picture), SceneStatistics{}));
    }
}

TEST(SceneStatistics, EveryPixelIsSanitized) {
    // NaN is 0, infinity the largest half float, a negative 0: channel by channel.
    expect_statistics(measure_scene(row_of({{kNan, 1, -7}, {-kInf, 0, kInf}})),
                      {std::sqrt(0.7152 * 0.0722 * 65504),
                       (0.7152 + 0.0722 * 65504) / 2,
                       0.7152,
                       0.0722 * 65504,
                       {0, 0.5, 32752},
                       {0, 1, 65504}});
    // All other floats are what they are, also beyond halves.
    expect_statistics(measure_scene(row_of({{kNan, 1, -7}, {-kInf, 0, 0x1p100F}})),
                      {std::sqrt(0.7152 * 0.0722 * 0x1p100),
                       0.0722 * 0x1p99,
                       0.7152,
                       0.0722 * 0x1p100,
                       {0, 0.5, 0x1p99},
                       {0, 1, 0x1p100}},
                      1e-14);  // exp(34.7) has 35 times the rounding of its argument
}

TEST(SceneStatistics, AreOfRec709Light) {
    // ACEScg -> Rec.709 (Bradford) in the ten digits of python_check/operators, rgb_to_rgb, of
    // (0.6, 0.3, 0.1): half a unit of the tenth digit, three times.
    const Vector3 rgb = {1.7050509927 * 0.6 - 0.6217921207 * 0.3 - 0.0832588720 * 0.1,
                         -0.1302564175 * 0.6 + 1.1408047366 * 0.3 - 0.0105483191 * 0.1,
                         -0.0240033568 * 0.6 - 0.1289689761 * 0.3 + 1.1529723329 * 0.1};
    const double L = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    const SceneStatistics s = measure_scene(row_of({{0.6F, 0.3F, 0.1F}}), "ACEScg");
    expect_statistics(s, {L, L, L, L, rgb, rgb}, 1e-6);  // 0.6, 0.3, 0.1 are floats
    // Pure green of AP1 has negative red and blue in Rec.709: they count as 0.
    const SceneStatistics green = measure_scene(row_of({{0, 1, 0}}), "lin_ap1");
    EXPECT_EQ(green.maximum_rgb[0], 0);
    EXPECT_EQ(green.mean_rgb[2], 0);
    EXPECT_NEAR(green.mean_luminance, 0.7152 * 1.1408047366, 1e-10);
    // Grays are grays in every space, within the rounding of the matrix.
    const SceneStatistics gray = measure_scene(row_of({{3}}), "lin_ap0");
    expect_statistics(gray, {3, 3, 3, 3, {3, 3, 3}, {3, 3, 3}}, 1e-14);
    // The limit of half floats comes after the exposure, which statistics are before.
    EXPECT_NEAR(measure_scene(row_of({{65504, 0, 0}}), "lin_ap1").maximum_rgb[0],
                65504 * 1.7050509927, 65504 * 1e-10);
}

TEST(SceneStatistics, SumsLoseNothing) {
    // A large value first: added to it one by one, ten thousands of small ones would be lost.
    ImageBuf picture(make_spec(30000, 2, {"Y"}, TypeDesc::DOUBLE));
    OIIO::ImageBufAlgo::fill(picture, {std::exp2f(-40)});
    set(picture, 0, 0, {32768});
    const double mean = (32768 + 59999 * std::exp2(-40)) / 60000;
    EXPECT_DOUBLE_EQ(measure_scene(picture).mean_luminance, mean);
    const double log2_average = (15 - 40 * 59999.0) / 60000;
    EXPECT_NEAR(std::log2(measure_scene(picture).log_average), log2_average, 1e-14 * 40);
}

TEST(SceneStatistics, EqualTheirDefinition) {
    const ImageBuf picture = make_rgb(1500, 40, TypeDesc::FLOAT, 30);
    // 60000 terms in long double, whose own rounding is 2^-64 each.
    expect_statistics(measure_scene(picture), by_definition(picture), 4e-15);
}

TEST(SceneStatistics, DoNotDependOnThreads) {
    const ImageBuf picture =
        make_picture(make_spec(211, 997, {"R", "G", "B", "A"}, TypeDesc::HALF), 40);
    const SceneStatistics one = measure_scene(picture, "lin_ap1", Unpremult::automatic, {}, 1);
    for (const int threads : {0, 2, 3, 7, 16}) {
        EXPECT_TRUE(same_statistics(
            measure_scene(picture, "lin_ap1", Unpremult::automatic, {}, threads), one))
            << threads;
    }
}

TEST(SceneStatistics, AnyPixelType) {
    for (const auto type :
         {TypeDesc::UINT8, TypeDesc::INT8, TypeDesc::UINT16, TypeDesc::INT16, TypeDesc::UINT32,
          TypeDesc::INT32, TypeDesc::HALF, TypeDesc::FLOAT, TypeDesc::DOUBLE}) {
        const ImageBuf picture = make_rgb(37, 5, type);
        // OIIO's own conversion is to float.
        expect_statistics(measure_scene(picture), by_definition(picture), 1e-7);
    }
}

TEST(SceneStatistics, CachedAndTiledPictures) {
    const Folder folder;
    const std::string path = folder / "tiled.exr";
    ImageSpec spec = make_spec(150, 90, {"R", "G", "B", "A", "Z"}, TypeDesc::HALF);
    spec.x = -7;
    spec.y = 11;
    ImageBuf local = make_picture(spec, 5);
    local.set_write_tiles(32, 32);
    ASSERT_TRUE(local.write(path)) << local.geterror();
    const ImageBuf cached = cached_picture(path);
    const SceneStatistics s = measure_scene(cached, "lin_rec709", Unpremult::automatic, {}, 4);
    EXPECT_TRUE(cached.cachedpixels());
    EXPECT_TRUE(same_statistics(s, measure_scene(local)));
}

TEST(SceneStatistics, OfARegion) {
    ImageSpec spec = make_spec(20, 10, {"R", "G", "B"}, TypeDesc::FLOAT);
    spec.x = 100;
    const ImageBuf picture = make_picture(spec);
    const auto of = [&](const ROI& roi) {
        return measure_scene(picture, "lin_rec709", Unpremult::automatic, roi);
    };
    const SceneStatistics all = of({});
    EXPECT_TRUE(same_statistics(of(ROI(100, 120, 0, 10)), all));
    EXPECT_TRUE(same_statistics(of(ROI(0, 1000, -5, 50)), all)) << "the data window ends it";
    const ROI part(103, 111, 4, 9, 0, 1, 0, 3);
    EXPECT_TRUE(same_statistics(of(part), measure_scene(OIIO::ImageBufAlgo::crop(picture, part))));
    EXPECT_FALSE(same_statistics(of(part), all));
    EXPECT_TRUE(same_statistics(of(ROI(0, 50, 0, 10)), SceneStatistics{})) << "beside it";
    EXPECT_TRUE(same_statistics(of(ROI(103, 111, 4, 9, 0, 1, 1, 2)), of(part)))
        << "channels of a region are not read";
}

TEST(SceneStatistics, OfVolumes) {
    ImageSpec spec = make_spec(5, 4, {"R", "G", "B"}, TypeDesc::FLOAT);
    spec.depth = spec.full_depth = 3;
    const ImageBuf picture = make_picture(spec);
    expect_statistics(measure_scene(picture), by_definition(picture));
}

TEST(SceneStatistics, AssociatedColorIsUnpremultipliedAndZeroAlphaIsLeftOut) {
    ImageBuf picture = row_of(
        {{0.5F, 0.5F, 0.5F, 0.25F}, {8, 8, 8, 1}, {100, 100, 100, 0}, {100, 100, 100, kNan}});
    const SceneStatistics covered = {4, 5, 2, 8, {5, 5, 5}, {8, 8, 8}};  // of 2 and 8
    const double mean = 208.5 / 4;
    const SceneStatistics as_is = {std::sqrt(200),     mean,           0.5, 100,
                                   {mean, mean, mean}, {100, 100, 100}};  // (0.5 8 100^2)^(1/4)
    expect_statistics(measure_scene(picture), covered);
    expect_statistics(measure_scene(picture, "lin_rec709", Unpremult::yes), covered);
    expect_statistics(measure_scene(picture, "lin_rec709", Unpremult::no), as_is);

    // The same picture with its alpha stored the other way has the same statistics.
    set(picture, 0, 0, {2, 2, 2, 0.25F});
    picture.specmod().attribute("oiio:UnassociatedAlpha", 1);
    expect_statistics(measure_scene(picture), covered);
}

TEST(SceneStatistics, PicturesOfZeroAlphaAreMeasuredAsTheyAre) {
    const double mean = 5;
    expect_statistics(measure_scene(row_of({{2, 2, 2, 0}, {8, 8, 8, 0}})),
                      {4, mean, 2, 8, {mean, mean, mean}, {8, 8, 8}});
}

TEST(SceneStatistics, GrayAndAlpha) {
    expect_statistics(measure_scene(row_of({{0.5F, 0.25F}, {8, 1}, {100, 0}})),
                      {4, 5, 2, 8, {5, 5, 5}, {8, 8, 8}});
}

TEST(SceneStatistics, ErrorsAreThrown) {
    const auto error_of = [](const ImageBuf& picture, std::string_view input = "lin_rec709") {
        try {
            (void)measure_scene(picture, input);
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string("no error");
    };
    EXPECT_EQ(error_of(ImageBuf()), "source is not initialized; expected a picture");
    EXPECT_NE(error_of(ImageBuf("/nonexistent/a.exr")).find("/nonexistent/a.exr"),
              std::string::npos);
    EXPECT_NE(error_of(row_of({{1}}), "lin_rec708").find("did you mean lin_rec709?"),
              std::string::npos);
    EXPECT_NE(error_of(make_picture(make_spec(2, 2, {"R", "G"}, TypeDesc::FLOAT)))
                  .find("picture has 2 channels (R, G)"),
              std::string::npos);
    ImageSpec deep = make_spec(2, 2, {"R", "G", "B", "A", "Z"}, TypeDesc::FLOAT);
    deep.deep = true;
    EXPECT_EQ(error_of(ImageBuf(deep)),
              "source is deep; expected flat pixels (oiiotool --flatten)");

    const Folder folder;
    const std::string path = folder / "cut.exr";
    write_truncated(path);
    EXPECT_NE(error_of(ImageBuf(path)).find("cut.exr"), std::string::npos);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
