// SPDX-License-Identifier: Apache-2.0
#include "tonewright/meter.h"

#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "tonewright/tonemap.h"
#include "unit/folder.h"
#include "unit/image/pictures.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;
using OIIO::TypeDesc;
using Method = ExposureRule::Method;

const float kInf = std::numeric_limits<float>::infinity();
const float kNan = std::numeric_limits<float>::quiet_NaN();

/// One row of grays of doubles: 0.01 and 0.1 are no floats.
ImageBuf grays(const std::vector<double>& values) {
    ImageBuf picture(make_spec(static_cast<int>(values.size()), 1, {"Y"}, TypeDesc::DOUBLE));
    EXPECT_TRUE(picture.set_pixels(picture.roi(), TypeDesc::DOUBLE, values.data()));
    return picture;
}

ImageBuf colors(const std::vector<std::vector<float>>& pixels) {
    std::vector<std::string> names = {"R", "G", "B"};
    if (pixels.front().size() == 4) names.emplace_back("A");
    ImageBuf picture(make_spec(static_cast<int>(pixels.size()), 1, names, TypeDesc::FLOAT));
    for (std::size_t x = 0; x < pixels.size(); ++x)
        set(picture, static_cast<int>(x), 0, pixels[x]);
    return picture;
}

/// A few roundings of double, and those of a sum of logarithms.
void expect_near(double actual, double expected, double relative = 2e-15) {
    EXPECT_NEAR(actual, expected, relative * std::fabs(expected));
}

/// Every figure, bit by bit.
bool same(const Metering& a, const Metering& b) {
    const auto figures = [](const Metering& m) {
        const SceneStatistics& s = m.scene;
        return std::tuple(m.counted, m.black, m.nan, m.infinite, m.uncovered, m.log_average,
                          m.geometric_mean, m.mean, m.minimum, m.maximum, m.histogram,
                          m.histogram_average, m.percentiles, s.log_average, s.mean_luminance,
                          s.minimum_luminance, s.maximum_luminance, s.mean_rgb, s.maximum_rgb,
                          m.scene_count, m.scene_lit_count);
    };
    return figures(a) == figures(b);
}

/// Luminances of a float picture by the definition.
std::vector<double> luminances(const ImageBuf& picture) {
    std::vector<double> all;
    for (ImageBuf::ConstIterator<float> p(picture); !p.done(); ++p)
        all.push_back(0.2126 * static_cast<double>(p[0]) + 0.7152 * static_cast<double>(p[1]) +
                      0.0722 * static_cast<double>(p[2]));
    return all;
}

// ---------------------------------------------------------------------------------------------
// Figures

// The dossier's figures of L = 0.01, 0.1, 1, 10, printed with 9 and 12 digits.
TEST(Meter, LogAverageOfPublishedFigures) {
    const ImageBuf picture = grays({0.01, 0.1, 1, 10});
    MeterOptions options;
    const Metering m = meter(picture, options);
    expect_near(m.geometric_mean, 0.316227766, 1e-9);
    expect_near(m.log_average, 0.324749051222, 1e-12);
    const double stops =
        suggested_exposure(metered_luminance(m, Method::log_average), ExposureRule{});
    expect_near(std::exp2(stops), 0.554274136668, 1e-12);
    options.delta = 1e-4;
    expect_near(meter(picture, options).log_average, 0.317103332, 1e-9);
}

TEST(Meter, HistogramOfPublishedFigures) {
    const Metering m = meter(grays({0.01, 0.1, 1, 10}));
    expect_near(m.histogram_average, 0.311206668979, 1e-12);
    ExposureRule rule;
    rule.method = Method::histogram;
    rule.calibration = ExposureRule::Calibration::saturation;
    expect_near(std::exp2(suggested_exposure(m.histogram_average, rule)), 0.33471861965, 1e-11);
    // floor(clamp((log2 L + 8)/11.5) 254 + 1): 30.96, 104.32, 177.70, 250.08.
    for (const std::size_t bin : {30U, 104U, 177U, 251U})
        EXPECT_EQ(m.histogram[bin], 1U) << bin;
}

TEST(Meter, MeanAndMaximumAndEv100) {
    const Metering m = meter(colors({{1, 0, 0}, {0, 2, 0}, {0, 0, 4}, {-1, 0, 0}}));
    expect_near(m.mean, (0.2126 + 1.4304 + 0.2888) / 4);
    expect_near(m.maximum, 1.4304);
    expect_near(m.minimum, 0.2126);
    EXPECT_EQ(m.black, 1U);
    EXPECT_EQ(ev100(1), 3);  // log2(100/12.5)
    EXPECT_EQ(ev100(0.125), 0);
}

TEST(Meter, BlackIsMeteredAsDelta) {
    const Metering m = meter(grays({0, 0, 0}));
    EXPECT_EQ(m.counted, 3U);
    EXPECT_EQ(m.black, 3U);
    EXPECT_EQ(m.histogram[0], 3U);
    EXPECT_TRUE(m.percentiles.empty());
    expect_near(m.log_average, 1e-3);
    EXPECT_EQ(m.geometric_mean, 0);
    EXPECT_EQ(m.maximum, 0);
    // 2^(-1/254 11.5 - 8), as the source has it.
    expect_near(m.histogram_average, 0.0037856, 1e-5);
    for (const Method method : {Method::log_average, Method::mean, Method::maximum})
        expect_near(metered_luminance(m, method), 1e-3);
    // 0.18/0.001 = 180.
    expect_near(std::exp2(suggested_exposure(1e-3, {})), 180, 1e-14);
}

TEST(Meter, OnePixel) {
    const Metering m = meter(colors({{0.25F, 0.25F, 0.25F}}));
    EXPECT_EQ(m.counted, 1U);
    expect_near(m.log_average, 0.251);
    expect_near(m.geometric_mean, 0.25);
    expect_near(m.maximum, 0.25);
    ASSERT_EQ(m.percentiles.size(), 7U);
    // Within its bin: 11.5/254 stops.
    for (const double luminance : m.percentiles)
        EXPECT_NEAR(std::log2(luminance), -2, 11.5 / 254);
}

TEST(Meter, TinyLight) {
    // The smallest double and others far below what four of them may be together.
    const double tiny = 5e-324;
    const Metering m = meter(grays({tiny, tiny, 0x1p-1000, 0x1p-600, 0}));
    EXPECT_NEAR(std::log2(m.geometric_mean), (-1074 - 1074 - 1000 - 600) / 4.0, 1e-12);
    EXPECT_EQ(m.minimum, tiny);
    EXPECT_EQ(m.histogram[0], 5U);
}

TEST(Meter, EqualsItsDefinition) {
    const ImageBuf picture = make_rgb(1500, 40, TypeDesc::FLOAT, 30);
    const std::vector<double> all = luminances(picture);
    long double logs = 0;
    long double sum = 0;
    std::vector<std::uint64_t> histogram(256);
    for (const double L : all) {
        logs += std::log(1e-3L + static_cast<long double>(L));
        sum += static_cast<long double>(L);
        const double t = std::clamp((std::log2(L) + 8) / 11.5, 0.0, 1.0);
        ++histogram[L < 1e-6 ? 0 : static_cast<std::size_t>(t * 254 + 1)];
    }
    const auto n = static_cast<long double>(all.size());
    MeterOptions options;
    options.grows_histogram = false;
    const Metering m = meter(picture, options);
    expect_near(m.log_average, static_cast<double>(std::exp(logs / n)));
    expect_near(m.mean, static_cast<double>(sum / n));
    EXPECT_EQ(m.histogram, histogram);
}

TEST(Meter, NarrowAndOddHistograms) {
    ImageBuf picture = make_rgb(300, 40, TypeDesc::FLOAT, 2);
    // About black, where bins end that begin below it.
    for (int x = 0; x < 300; ++x) {
        const float gray = 0.9e-6F + static_cast<float>(x) * 1e-9F;
        set(picture, x, 7, {gray, gray, gray});
    }
    const std::vector<double> all = luminances(picture);
    struct Shape {
        double min, max;
        int bins;
    };
    // More bins than steps of the table; limits that nothing is within; three bins; many bins that
    // are black.
    for (const Shape& shape : {Shape{-1, 0.5, 4096}, Shape{15, 16, 200}, Shape{-64, -63, 10},
                               Shape{-64, 16, 3}, Shape{-64, 1, 700}}) {
        MeterOptions options;
        options.histogram_min = shape.min;
        options.histogram_max = shape.max;
        options.grows_histogram = false;
        options.bins = shape.bins;
        std::vector<std::uint64_t> histogram(static_cast<std::size_t>(shape.bins));
        for (const double L : all) {
            const double t =
                std::clamp((std::log2(L) - shape.min) / (shape.max - shape.min), 0.0, 1.0);
            ++histogram[L < 1e-6 ? 0 : static_cast<std::size_t>(t * (shape.bins - 2) + 1)];
        }
        EXPECT_EQ(meter(picture, options).histogram, histogram) << shape.min << " " << shape.bins;
    }
}

/// Grays of a scene: from `from` to `to`, in log2 of luminance, and one in `every` of `other`.
std::vector<double> scene_of(double from, double to, int every = 0, double other = 0) {
    constexpr int kCount = 4000;
    std::vector<double> values;
    for (int i = 0; i < kCount; ++i) {
        const bool is_other = every > 0 && i % every == 0;
        values.push_back(std::exp2(is_other ? other : from + (to - from) * i / kCount));
    }
    return values;
}

// By the definition: bins of 11.5/254 stops, added at either end until 0.05 % lie beyond it.
TEST(Meter, HistogramGrowsToHoldThePicture) {
    struct Case {
        std::vector<double> values;
        double least, most;  // of the limits
    };
    const double bin = 11.5 / 254;
    for (const Case& one : {Case{scene_of(-7, 3), -8, 3.5}, Case{scene_of(11, 12.3), -8, 12.3},
                            Case{scene_of(-14, -3), -14, 3.5}, Case{scene_of(-19, 40), -19, 40},
                            Case{scene_of(-3, 3, 50, 18.2), -8, 18.2},
                            // One pixel of 4000 is 0.025 %.
                            Case{scene_of(-3, 3, 4000, 18.2), -8, 3.5}}) {
        const Metering m = meter(grays(one.values));
        EXPECT_NEAR(m.histogram_min, one.least, bin);
        EXPECT_NEAR(m.histogram_max, one.most, bin);
        EXPECT_LE(m.share_outside(), 1e-3);
        EXPECT_EQ(std::accumulate(m.histogram.begin(), m.histogram.end(), std::uint64_t{0}), 4000U);
        EXPECT_EQ(m.histogram.size(), std::lround((m.histogram_max - m.histogram_min) / bin) + 2);
        double mean = 0;
        for (const double x : one.values)
            mean += std::log2(x) / 4000;
        // A bin counts as its lower end; 0.025 % of 15 stops.
        EXPECT_NEAR(std::log2(m.histogram_average), mean - bin / 2, bin / 2 + 0.004);
        MeterOptions fixed;
        fixed.grows_histogram = false;
        const Metering narrow = meter(grays(one.values), fixed);
        EXPECT_EQ(narrow.histogram.size(), 256U);
        EXPECT_EQ(narrow.histogram_max, 3.5);
        std::uint64_t outside = 0;
        for (const double x : one.values)
            outside += std::log2(x) < -8 || std::log2(x) >= 3.5 ? 1 : 0;
        EXPECT_EQ(narrow.below_histogram + narrow.above_histogram, outside);
    }
}

TEST(Meter, GrowingChangesNoFigureOfAPictureWithinTheLimits) {
    const ImageBuf picture = grays(scene_of(-7.9, 3.4, 3, -30));
    MeterOptions fixed;
    fixed.grows_histogram = false;
    EXPECT_TRUE(same(meter(picture), meter(picture, fixed)));
}

// Frames of a shot that gets brighter, step by step, from below the limits through them: each frame
// is brighter by as much, but for the width of a bin, also where its histogram begins to grow.
TEST(Meter, HistogramsOfAShotDoNotJump) {
    const double bin = 11.5 / 254;
    constexpr double kStep = 0.05;
    for (const int every : {0, 7, 99, 101, 1999}) {  // suns of 0 to 14 %, also about 1 and 0.05 %
        double before = 0;
        for (double stops = -20; stops < 30; stops += kStep) {
            const Metering m = meter(grays(scene_of(stops - 4, stops, every, stops + 9)));
            const double here = std::log2(m.histogram_average);
            // Black below 1e-6 is not in the mean; the darkest frames lose pixels to it.
            if (stops - 4 > -19.9 && before != 0) {
                EXPECT_GE(here, before) << stops << " " << every;
                EXPECT_NEAR(here - before, kStep, bin) << stops << " " << every;
            }
            before = here;
        }
    }
}

TEST(Meter, SeesTheWholeRangeOfFloats) {
    const double most = static_cast<double>(std::numeric_limits<float>::max());
    EXPECT_EQ(meter(colors({{3e5F, 3e5F, 3e5F}})).maximum, 3e5);
    const Metering m = meter(colors({{3e38F, 1e38F, 1}, {1, 2, 3}}));
    expect_near(m.maximum,
                0.2126 * static_cast<double>(3e38F) + 0.7152 * static_cast<double>(1e38F) + 0.0722);
    expect_near(meter(grays({1e300})).maximum, most);
    ExposureRule rule;
    rule.min_stops = -40;
    const double stops = suggested_exposure(meter(grays({3e5, 3e5})).mean, rule);
    EXPECT_NEAR(stops, std::log2(0.18 / 3e5), 1e-12);
}

TEST(Meter, AbsoluteLuminanceIsDividedByTheReferenceWhite) {
    MeterOptions options;
    options.input_units = InputUnits::luminance;
    expect_near(meter(grays({406, 406}), options).mean, 4.06);
    options.reference_white = 203;
    expect_near(meter(grays({406, 406}), options).mean, 2);
    // SMPTE ST 2084 of 203 cd/m2.
    options.input = "rec2100_pq";
    EXPECT_NEAR(meter(grays({0.580688881042, 0.580688881042}), options).mean, 1, 1e-10);
    options.reference_white = 49;
    EXPECT_THROW(check_meter_options(options), Error);
}

TEST(Meter, PercentilesAreTrimmed) {
    // Ten grays, one stop apart: of what is between 20 and 75 %, the third to the seventh and half
    // of the eighth: exponents (2 + 3 + 4 + 5 + 6 + 7/2)/5.5.
    std::vector<double> values;
    for (int i = 0; i < 10; ++i)
        values.push_back(std::exp2(i));
    values.push_back(0);  // black is not among them
    std::reverse(values.begin(), values.end());
    MeterOptions options;
    options.low_percentile = 20;
    options.high_percentile = 75;
    options.histogram_max = 12;
    options.exact = true;
    expect_near(meter(grays(values), options).histogram_average, std::exp2(23.5 / 5.5), 1e-14);
    // 1 to 1024 lies on edges of these bins, which are 20/320 of a stop wide.
    options.exact = false;
    options.bins = 322;
    expect_near(meter(grays(values), options).histogram_average, std::exp2(23.5 / 5.5), 1e-14);
}

TEST(Meter, ExactPercentilesAreThoseOfSortedLuminances) {
    const ImageBuf picture = make_rgb(311, 37, TypeDesc::FLOAT, 5);
    std::vector<double> all = luminances(picture);
    std::sort(all.begin(), all.end());
    MeterOptions options;
    options.exact = true;
    options.low_percentile = 10;
    options.high_percentile = 95;
    const Metering m = meter(picture, options);
    ASSERT_EQ(m.percentiles.size(), std::size(Metering::kPercents));
    for (std::size_t i = 0; i < m.percentiles.size(); ++i) {
        const double rank = Metering::kPercents[i] / 100 * static_cast<double>(all.size());
        EXPECT_DOUBLE_EQ(m.percentiles[i], all[static_cast<std::size_t>(rank)]);
    }
    const double low = 0.1 * static_cast<double>(all.size());
    const double high = 0.95 * static_cast<double>(all.size());
    long double sum = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const double part =
            std::min(static_cast<double>(i) + 1, high) - std::max(static_cast<double>(i), low);
        if (part > 0)
            sum += static_cast<long double>(part) * std::log2(static_cast<long double>(all[i]));
    }
    expect_near(m.histogram_average, std::exp2(static_cast<double>(sum) / (high - low)), 1e-13);
    // By bins, within a bin.
    options.exact = false;
    const Metering binned = meter(picture, options);
    for (std::size_t i = 0; i < m.percentiles.size(); ++i) {
        EXPECT_NEAR(std::log2(binned.percentiles[i]), std::log2(m.percentiles[i]), 11.5 / 254)
            << Metering::kPercents[i];
    }
}

// ---------------------------------------------------------------------------------------------
// Which pixels

TEST(Meter, NanAndInfinitiesAreIgnoredAndCounted) {
    const ImageBuf picture =
        colors({{kNan, 1, 1}, {1, kInf, 1}, {-kInf, kNan, 1}, {0.5F, 0.5F, 0.5F}, {1, 1, -kInf}});
    const Metering m = meter(picture);
    EXPECT_EQ(m.nan, 2U);
    EXPECT_EQ(m.infinite, 2U);
    EXPECT_EQ(m.counted, 1U);
    expect_near(m.maximum, 0.5);
    expect_near(m.log_average, 0.501);
    // Statistics of the scene have their own rule, and are those of measure_scene().
    const SceneStatistics scene = measure_scene(picture);
    EXPECT_EQ(m.scene.maximum_luminance, scene.maximum_luminance);
    EXPECT_EQ(m.scene.log_average, scene.log_average);
    EXPECT_EQ(m.scene_count, 5U);
    expect_near(scene.maximum_luminance, 0.7152 * 65504 + 0.2126 + 0.0722);
}

TEST(Meter, ColorIsUnpremultipliedAndZeroAlphaIsLeftOut) {
    ImageBuf picture = colors(
        {{0.5F, 0.5F, 0.5F, 0.25F}, {8, 8, 8, 1}, {100, 100, 100, 0}, {100, kNan, 100, kNan}});
    Metering m = meter(picture);
    EXPECT_EQ(m.counted, 2U);
    EXPECT_EQ(m.uncovered, 2U);
    EXPECT_EQ(m.nan, 0U);
    expect_near(m.geometric_mean, 4);
    expect_near(m.mean, 5);
    MeterOptions options;
    options.unpremult = TonemapOptions::Unpremult::no;
    m = meter(picture, options);
    EXPECT_EQ(m.counted, 3U);
    EXPECT_EQ(m.uncovered, 0U);
    EXPECT_EQ(m.nan, 1U);
    expect_near(m.mean, 108.5 / 3);
    // Without any cover, as it is.
    m = meter(colors({{2, 2, 2, 0}, {8, 8, 8, 0}}));
    EXPECT_EQ(m.counted, 2U);
    EXPECT_EQ(m.uncovered, 0U);
    expect_near(m.geometric_mean, 4);
}

TEST(Meter, PackedFloatsAreReadAsAnyOthers) {
    // Odd widths, alpha of all kinds; doubles take the other way in.
    const ImageBuf floats =
        make_picture(make_spec(1237, 5, {"R", "G", "B", "A"}, TypeDesc::FLOAT), 3);
    EXPECT_TRUE(same(meter(floats), meter(floats.copy(TypeDesc::DOUBLE))));
    const ImageBuf rgb = make_rgb(1023, 3, TypeDesc::FLOAT, 7);
    EXPECT_TRUE(same(meter(rgb), meter(rgb.copy(TypeDesc::DOUBLE))));
    MeterOptions options;
    options.input = "lin_ap1";
    EXPECT_TRUE(same(meter(rgb, options), meter(rgb.copy(TypeDesc::DOUBLE), options)));
    // Opaque but for a few.
    ImageBuf opaque = make_picture(make_spec(1237, 7, {"R", "G", "B", "A"}, TypeDesc::FLOAT), 3);
    for (ImageBuf::Iterator<float> p(opaque); !p.done(); ++p)
        p[3] = 1;
    set(opaque, 1200, 1, {0.5F, 0.25F, 0.125F, 0.5F});
    set(opaque, 1236, 2, {1, 1, 1, kNan});
    set(opaque, 1235, 3, {1, 1, -kInf, 1});
    set(opaque, 0, 4, {1, kNan, 1, 1});
    set(opaque, 513, 5, {-1, 0, 1e9F, 1});
    const Metering expected = meter(opaque.copy(TypeDesc::DOUBLE));
    EXPECT_EQ(expected.uncovered + expected.nan + expected.infinite, 3U);
    EXPECT_TRUE(same(meter(opaque), expected));
    // Halves, and a fourth channel that is no alpha.
    ImageBuf depth = make_picture(make_spec(1237, 3, {"R", "G", "B", "Z"}, TypeDesc::HALF), 3);
    set(depth, 64, 1, {1, 1, 1, kInf});
    EXPECT_TRUE(same(meter(depth), meter(depth.copy(TypeDesc::DOUBLE))));
    EXPECT_EQ(meter(depth).counted, 1237U * 3);
}

TEST(Meter, DoesNotDependOnThreads) {
    ImageBuf picture =
        make_picture(make_spec(1031, 499, {"R", "G", "B", "A"}, TypeDesc::FLOAT), 40);
    set(picture, 700, 300, {kNan, 1, 1, 1});
    set(picture, 3, 17, {1, 1, 1, 0});
    MeterOptions options;
    options.input = "lin_ap1";
    options.exact = true;
    const Metering one = meter(picture, options, 1);
    for (const int threads : {0, 2, 3, 7, 16})
        EXPECT_TRUE(same(meter(picture, options, threads), one)) << threads;
}

TEST(Meter, ARegionAlone) {
    ImageSpec spec = make_spec(700, 90, {"R", "G", "B"}, TypeDesc::FLOAT);
    spec.x = 100;
    spec.y = -20;
    const ImageBuf picture = make_picture(spec, 9);
    MeterOptions options;
    options.region = ROI(110, 655, -10, 55, 0, 1);
    const Metering m = meter(picture, options);
    EXPECT_EQ(m.counted, 545U * 65U);
    EXPECT_TRUE(
        same(m, meter(OIIO::ImageBufAlgo::crop(picture, ROI(110, 655, -10, 55, 0, 1, 0, 3)))));
    options.region = ROI(0, 50, 0, 10);
    EXPECT_THROW((void)meter(picture, options), Error);

    // The same of a file, whose rows are read in batches and in tiles.
    const Folder folder;
    ImageBuf large = make_picture(make_spec(300, 2000, {"R", "G", "B"}, TypeDesc::FLOAT), 9);
    options.region = ROI(11, 205, 130, 1777, 0, 1);
    for (const bool tiled : {false, true}) {
        const std::string path = folder / (tiled ? "tiled.exr" : "rows.exr");
        if (tiled) large.set_write_tiles(64, 48);
        ASSERT_TRUE(large.write(path)) << large.geterror();
        EXPECT_TRUE(same(meter_file(path, options), meter(large, options)));
        EXPECT_TRUE(same(meter_file(path), meter(large)));
    }
}

TEST(Meter, OfASequenceAsOfOnePicture) {
    const ImageBuf a = make_rgb(64, 20, TypeDesc::FLOAT, 3);
    const ImageBuf b = colors({{0, 0, 0}, {9, 1, 5}});
    ImageBuf both(make_spec(64 * 20 + 2, 1, {"R", "G", "B"}, TypeDesc::FLOAT));
    for (int i = 0; i < 64 * 20; ++i)
        set(both, i, 0, pixel(a, i % 64, i / 64));
    set(both, 64 * 20, 0, pixel(b, 0, 0));
    set(both, 64 * 20 + 1, 0, pixel(b, 1, 0));
    const SceneStatistics expected = measure_scene(both);
    const SceneStatistics actual =
        statistics_of_sequence({meter(a), meter(b), meter(grays({0})), meter(grays({0}))});
    // The two black pixels more count in means alone.
    const double share = (64.0 * 20 + 2) / (64.0 * 20 + 4);
    expect_near(actual.log_average, expected.log_average, 1e-14);
    expect_near(actual.mean_luminance, expected.mean_luminance * share, 1e-14);
    expect_near(actual.mean_rgb[2], expected.mean_rgb[2] * share, 1e-14);
    EXPECT_EQ(actual.maximum_rgb, expected.maximum_rgb);
    EXPECT_EQ(actual.minimum_luminance, expected.minimum_luminance);
    EXPECT_EQ(statistics_of_sequence({meter(grays({0}))}).mean_luminance, 0);
}

// ---------------------------------------------------------------------------------------------
// Exposure

TEST(ExposureRule, KeysLimitsAndCompensation) {
    ExposureRule rule;
    expect_near(suggested_exposure(0.18 / 4, rule), 2);
    rule.key = 0.36;
    expect_near(suggested_exposure(0.18, rule), 1);
    rule.method = Method::maximum;
    rule.key = {};
    EXPECT_EQ(suggested_exposure(8, rule), -3);  // the brightest becomes 1
    rule.max_stops = 2;
    rule.min_stops = -2;
    rule.compensation = 0.5;
    EXPECT_EQ(suggested_exposure(8, rule), -1.5) << "compensation after the limits";
    EXPECT_EQ(suggested_exposure(1.0 / 64, rule), 2.5);
    rule = {};
    rule.auto_key = true;  // 1.03 - 2/(2 + log10(9 + 1)) = 1.03 - 2/3
    expect_near(std::exp2(suggested_exposure(9, rule)), (1.03 - 2.0 / 3) / 9, 1e-14);
}

// ---------------------------------------------------------------------------------------------
// Adaptation

TEST(Adaptation, IsTheClosedForm) {
    // Light jumps by three stops and stays: A(t) = T + (A0 - T) e^(-tau t).
    const std::vector<int> frames = {10, 11, 12, 13, 20, 100};
    for (const double jump : {-3.0, 3.0}) {
        Adaptation adaptation;
        adaptation.up = 2.5;
        adaptation.down = 0.7;
        adaptation.fps = 30;
        const std::vector<double> stops =
            adapted_exposures(frames, {0, jump, jump, jump, jump, jump}, adaptation);
        const double target = std::exp2(-jump);
        const double tau = target > 1 ? 2.5 : 0.7;
        for (std::size_t i = 0; i < frames.size(); ++i) {
            const double seconds = (frames[i] - 10) / 30.0;
            EXPECT_NEAR(stops[i], -std::log2(target + (1 - target) * std::exp(-tau * seconds)),
                        1e-14);
        }
    }
}

TEST(Adaptation, OtherFormAndItsDirection) {
    // The dossier: from 0.4 to 0.8, 1/60 s: 0.40402, not 0.79598.
    Adaptation adaptation;
    adaptation.form = Adaptation::Form::power_098;
    adaptation.fps = 60;
    adaptation.start = -std::log2(0.4);
    const double target = -std::log2(0.8);
    const auto stops = adapted_exposures({1, 2, 1000000}, {target, target, target}, adaptation);
    EXPECT_NEAR(std::exp2(-stops[0]), 0.4, 1e-15);
    EXPECT_NEAR(std::exp2(-stops[1]), 0.40402, 5e-6);
    EXPECT_NEAR(std::exp2(-stops[1]), 0.4 + 0.4 * (1 - std::pow(0.98, 0.5)), 1e-15);
    EXPECT_NEAR(stops[2], target, 1e-15) << "no memory after a long time";
    // 1 - e^(-1.1/60) = 0.018166300.
    adaptation.form = Adaptation::Form::exponential;
    const auto exponential = adapted_exposures({1, 2}, {target, target}, adaptation);
    EXPECT_NEAR(std::exp2(-exponential[1]), 0.4 + 0.4 * 0.018166300, 1e-9);
}

TEST(Adaptation, SpeedZeroStaysAndEmptyShotsAreEmpty) {
    Adaptation adaptation;
    adaptation.up = adaptation.down = 0;
    EXPECT_EQ(adapted_exposures({1, 2}, {1, 5}, adaptation), (std::vector<double>{1, 1}));
    EXPECT_TRUE(adapted_exposures({}, {}, adaptation).empty());
}

// ---------------------------------------------------------------------------------------------
// Errors

TEST(Meter, ErrorsNameTheOption) {
    const auto error_of = [](MeterOptions options) {
        try {
            (void)meter(grays({1}), options);
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string("no error");
    };
    MeterOptions options;
    options.delta = 0;
    EXPECT_EQ(error_of(options), "delta is 0; expected [1e-10, 1]");
    options = {};
    options.delta = std::nan("");
    EXPECT_NE(error_of(options).find("delta is"), std::string::npos);
    options = {};
    options.bins = 2;
    EXPECT_EQ(error_of(options), "bins is 2; expected [3, 4096]");
    options = {};
    options.low_percentile = options.high_percentile = 50;
    EXPECT_NE(error_of(options).find("low percentile is 50"), std::string::npos);
    options = {};
    options.histogram_min = 5;
    EXPECT_NE(error_of(options).find("histogram min is 5"), std::string::npos);
    options = {};
    options.region = ROI(5, 9, 0, 1, 0, 1);
    EXPECT_EQ(error_of(options),
              "region is 5,0,4,1 (x, y, width, height); expected some pixels of the "
              "picture, which is 0,0,1,1");
    options = {};
    options.input = "lin_rec708";
    EXPECT_NE(error_of(options).find("did you mean lin_rec709?"), std::string::npos);
    EXPECT_THROW((void)meter(ImageBuf()), Error);
    EXPECT_THROW((void)meter_file("/nonexistent/a.exr"), FileError);
    EXPECT_THROW((void)parse_meter_method("log-averag"), Error);
}

TEST(ExposureRule, IntervalsAreClosed) {
    EXPECT_NO_THROW(check_exposure_rule({}));
    EXPECT_NO_THROW(
        check_exposure_rule({.key = 1e-3, .min_stops = -40, .max_stops = 40, .compensation = 20}));
    EXPECT_NO_THROW(
        check_exposure_rule({.key = 16, .min_stops = 2, .max_stops = 2, .compensation = -20}));
    const double nan = std::nan("");
    for (const ExposureRule& rule : std::vector<ExposureRule>{{.key = 9e-4},
                                                              {.key = 16.1},
                                                              {.key = nan},
                                                              {.min_stops = -41},
                                                              {.max_stops = 41},
                                                              {.min_stops = 1, .max_stops = 0},
                                                              {.compensation = 20.1},
                                                              {.compensation = nan}})
        EXPECT_THROW(check_exposure_rule(rule), Error);
}

TEST(Adaptation, IntervalsAreClosed) {
    EXPECT_NO_THROW(check_adaptation({}));
    EXPECT_NO_THROW(check_adaptation({.up = 0, .down = 1000, .fps = 0.01, .start = -40}));
    for (const Adaptation& adaptation : std::vector<Adaptation>{{.up = -1},
                                                                {.down = 1001},
                                                                {.fps = 0},
                                                                {.fps = std::nan("")},
                                                                {.start = 41},
                                                                {.start = kInfinity}})
        EXPECT_THROW(check_adaptation(adaptation), Error);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
