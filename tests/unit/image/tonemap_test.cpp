// SPDX-License-Identifier: Apache-2.0
#include "tonewright/tonemap.h"

#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/format_number.h"
#include "engine/simd_program.h"
#include "full_counts.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"
#include "unit/folder.h"
#include "unit/image/pictures.h"
#include "unit/image/tonemapped.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;
using OIIO::TypeDesc;
using Unpremult = TonemapOptions::Unpremult;

TEST(Tonemap, EqualsTheReferenceEngine) {
    const float inf = std::numeric_limits<float>::infinity();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    ImageBuf src = make_rgb(40, 30, TypeDesc::FLOAT, 20);
    set(src, 0, 0, {nan, 1, 0});
    set(src, 1, 0, {inf, -inf, 0.5F});
    set(src, 2, 0, {-0.1F, 0.18F, -7});
    set(src, 3, 0, {1e30F, 1e-30F, 0});
    const TonemapOptions options = {
        .op = resolve_picture_operator("hable"), .exposure_stops = 1.5, .input = "lin_ap1"};
    const ReferenceEngine expected = reference(options);
    const ImageBuf result = tonemap(src, options);
    ASSERT_FALSE(result.has_error()) << result.geterror();
    EXPECT_EQ(result.spec().format, TypeDesc::FLOAT);
    for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 40; ++x) {
            const std::vector<float> in = pixel(src, x, y);
            const std::vector<float> out = pixel(result, x, y);
            const Vector3 want = expected(Vector3{in[0], in[1], in[2]});
            for (std::size_t c = 0; c < 3; ++c) {
                ASSERT_NEAR(out[c], want[c], kTolerance) << x << ", " << y << " channel " << c;
            }
        }
    }
}

TEST(Tonemap, AnySourceType) {
    const ReferenceEngine expected = reference(hable());
    for (const auto type :
         {TypeDesc::UINT8, TypeDesc::INT8, TypeDesc::UINT16, TypeDesc::INT16, TypeDesc::UINT32,
          TypeDesc::INT32, TypeDesc::HALF, TypeDesc::FLOAT, TypeDesc::DOUBLE}) {
        const ImageBuf src = make_rgb(9, 5, type);
        const ImageBuf result = tonemap(src, hable());
        ASSERT_FALSE(result.has_error()) << result.geterror();
        EXPECT_EQ(result.spec().format, TypeDesc::FLOAT);
        for (int y = 0; y < 5; ++y) {
            for (int x = 0; x < 9; ++x) {
                const std::vector<float> in = pixel(src, x, y);  // converted by OIIO itself
                const Vector3 want = expected(Vector3{in[0], in[1], in[2]});
                for (std::size_t c = 0; c < 3; ++c) {
                    ASSERT_NEAR(pixel(result, x, y)[c], want[c], kTolerance)
                        << TypeDesc(type).c_str();
                }
            }
        }
    }
}

TEST(Tonemap, AnyDestinationTypeIsKeptAndRounded) {
    struct Case {
        TypeDesc::BASETYPE type;
        double half_step;  // of values in [0, 1]
    };
    // Half: 11 significant bits below 1.
    constexpr std::array<Case, 9> kCases = {{{TypeDesc::UINT8, 0.5 / 255},
                                             {TypeDesc::INT8, 0.5 / 127},
                                             {TypeDesc::UINT16, 0.5 / 65535},
                                             {TypeDesc::INT16, 0.5 / 32767},
                                             {TypeDesc::UINT32, 1e-9},
                                             {TypeDesc::INT32, 1e-9},
                                             {TypeDesc::HALF, 0x1p-12},
                                             {TypeDesc::FLOAT, 0},
                                             {TypeDesc::DOUBLE, 0}}};
    const ImageBuf src = make_rgb(20, 20, TypeDesc::FLOAT, 8);
    const ReferenceEngine expected = reference(hable());
    for (const Case& c : kCases) {
        ImageBuf dst(make_spec(20, 20, {"R", "G", "B"}, c.type));
        ASSERT_TRUE(tonemap(dst, src, hable())) << dst.geterror();
        EXPECT_EQ(dst.spec().format, c.type);
        for (int i = 0; i < 20; ++i) {
            const std::vector<float> in = pixel(src, i, i);
            const Vector3 want = expected(Vector3{in[0], in[1], in[2]});
            for (std::size_t k = 0; k < 3; ++k) {
                ASSERT_NEAR(pixel(dst, i, i)[k], want[k], c.half_step + kTolerance)
                    << TypeDesc(c.type).c_str();
            }
        }
    }
}

TEST(Tonemap, IntegersAreClampedWhereTheResultExceedsThem) {
    // Display-linear, unclamped: hable goes up to 1.287.
    const TonemapOptions options = {.op = resolve_picture_operator("hable"), .display = "linear"};
    ImageBuf src(make_spec(1, 1, {"R", "G", "B"}, TypeDesc::FLOAT));
    set(src, 0, 0, {5000, 0, 5000});
    ImageBuf dst(make_spec(1, 1, {"R", "G", "B"}, TypeDesc::UINT8));
    ASSERT_TRUE(tonemap(dst, src, options));
    EXPECT_EQ(pixel(dst, 0, 0), (std::vector<float>{1, 0, 1}));
    EXPECT_GT(pixel(tonemap(src, options), 0, 0)[0], 1.2F);
}

TEST(Tonemap, RowsOfAnyLength) {
    // The engine works on spans of 1024 pixels.
    for (const int width : {1, 7, 1023, 1024, 1025, 2500}) {
        const ImageBuf src = make_rgb(width, 2, TypeDesc::HALF, 4);
        const ImageBuf result = tonemap(src, hable());
        for (const int x : {0, width / 2, width - 1}) {
            const std::vector<float> in = pixel(src, x, 1);
            const Vector3 want = reference(hable())(Vector3{in[0], in[1], in[2]});
            EXPECT_NEAR(pixel(result, x, 1)[2], want[2], kTolerance) << width << ": " << x;
        }
    }
}

TEST(Tonemap, ResultDoesNotDependOnThreads) {
    const ImageBuf src =
        make_picture(make_spec(331, 257, {"R", "G", "B", "A"}, TypeDesc::FLOAT), 9);
    const ImageBuf one = tonemap(src, hable(), {}, 1);
    const ImageBuf four = tonemap(src, hable(), {}, 4);
    EXPECT_TRUE(same_bits(one, four));
    EXPECT_TRUE(same_bits(one, tonemap(src, hable())));
}

TEST(Tonemap, OneTonemapperServesManyPictures) {
    const Tonemapper tonemapper(hable());
    for (const int size : {3, 70}) {
        const ImageBuf src = make_rgb(size, size);
        ImageBuf dst;
        ASSERT_TRUE(tonemapper(dst, src));
        EXPECT_TRUE(same_bits(dst, tonemap(src, hable())));
    }
    EXPECT_THROW(Tonemapper(TonemapOptions{}), Error);
}

/// Programs are shared between exposures; the pixels are those of a tonemapper made for it.
TEST(Tonemap, AnotherExposureIsThatOfATonemapperMadeForIt) {
    const ImageBuf src = make_rgb(61, 7, TypeDesc::FLOAT, 9);
    for (const Operator& op : all_operators()) {
        const TonemapOptions options = {.op = resolve_picture_operator(op.id),
                                        .exposure_stops = 0.5};
        const Tonemapper tonemapper(options);
        for (const double stops : takes_full_counts() || op.id == "hable"
                                      ? std::vector<double>{0.5, 0, -2.3, 5, 16, 20}
                                      : std::vector<double>{-2.3}) {
            TonemapOptions at = options;
            at.exposure_stops = stops;
            ImageBuf got, expected;
            const Tonemapper with = tonemapper.with_exposure(stops);
            ASSERT_TRUE(with(got, src)) << op.id << ": " << got.geterror();
            ASSERT_TRUE(Tonemapper(at)(expected, src)) << op.id;
            EXPECT_TRUE(same_bits(got, expected)) << op.id << " at " << stops << " stops";
            EXPECT_EQ(with.options().exposure_stops, stops);
        }
    }
    EXPECT_THROW((void)Tonemapper(hable()).with_exposure(65), Error);
    EXPECT_THROW((void)Tonemapper(hable()).with_exposure(std::nan("")), Error);
}

/// A metered sequence compiles a view once. Compiling takes a hundred times as long.
TEST(Tonemap, AnotherExposureCompilesNothing) {
    const ImageBuf src = make_rgb(2, 1);
    const Tonemapper tonemapper({.op = resolve_picture_operator("aces_20"), .exposure_stops = 1});
    ImageBuf dst;
    const auto seconds = [&](double stops) {
        const auto begin = std::chrono::steady_clock::now();
        EXPECT_TRUE(tonemapper.with_exposure(stops)(dst, src, {}, 1));
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    };
    const double first = seconds(1);
    double least = first;  // of several: the machine may be busy
    for (int i = 0; i < 20; ++i)
        least = std::min(least, seconds(-2 + 0.1 * i));
    EXPECT_LT(least, 0.05 * first);
}

TEST(Tonemap, ThreadsShareATonemapperOfPicturesInManySpaces) {
    // Every thread asks for the engine of a space while another one compiles it; there are more
    // spaces than the tonemapper keeps engines for.
    const std::vector<std::string> spaces = {"Linear",   "sRGB",    "Gamma1.8", "Gamma2.0",
                                             "Gamma2.2", "ACEScg",  "Gamma2.4", "Gamma2.6",
                                             "Gamma1.5", "Gamma3.0"};
    std::vector<ImageBuf> sources, expected;
    for (const std::string& space : spaces) {
        sources.push_back(make_rgb(40, 3));
        sources.back().specmod().attribute("oiio:ColorSpace", space);
        expected.push_back(tonemap(sources.back(), hable(), {}, 1));
        ASSERT_FALSE(expected.back().has_error()) << expected.back().geterror();
    }
    const Tonemapper tonemapper(hable());
    std::atomic<int> differences = 0;
    {
        std::vector<std::jthread> threads;
        for (std::size_t t = 0; t < 4; ++t) {
            threads.emplace_back([&, t] {
                for (std::size_t i = 0; i < 2 * spaces.size(); ++i) {
                    const std::size_t k = (i + t / 2) % spaces.size();
                    ImageBuf dst;
                    if (!tonemapper(dst, sources[k], {}, 1) || !same_bits(dst, expected[k]))
                        ++differences;
                }
            });
        }
    }
    EXPECT_EQ(differences, 0);
}

using Statistics = TonemapOptions::Statistics;

/// The result of tonemap() is that of the operator's settings given by hand.
void expect_same_picture(const ImageBuf& picture, const TonemapOptions& options,
                         const ImageBuf& src, const ResolvedOperator& op) {
    TonemapOptions fixed = options;
    fixed.op = op;
    fixed.statistics = Statistics::defaults;
    const ImageBuf expected = tonemap(src, fixed);
    ASSERT_FALSE(picture.has_error()) << picture.geterror();
    ASSERT_FALSE(expected.has_error()) << expected.geterror();
    // Each keeps to the engine's bound: multiplied by a number that a curve with constants
    // contains.
    ASSERT_EQ(picture.spec().image_pixels(), expected.spec().image_pixels());
    for (OIIO::ImageBuf::ConstIterator<float> a(picture), b(expected); !a.done(); ++a, ++b) {
        for (int c = 0; c < picture.nchannels(); ++c)
            ASSERT_NEAR(a[c], b[c], kTolerance);
    }
}

std::vector<ImageBuf> frames_of_rising_light() {
    std::vector<ImageBuf> frames;
    for (const float peak : {0.02F, 0.4F, 3.0F, 60.0F, 5000.0F})
        frames.push_back(make_rgb(24, 16, TypeDesc::FLOAT, peak));
    return frames;
}

/// A sequence compiles a view once, whatever the exposures and statistics of its frames.
TEST(Tonemap, StatisticsOfFramesCompileNothing) {
    const std::vector<ImageBuf> frames = frames_of_rising_light();
    std::size_t tested = 0;
    for (const Operator& op : all_operators()) {
        const Tonemapper tonemapper(
            {.op = resolve_picture_operator(op.id), .exposure_stops = 0.25});
        if (!tonemapper.takes_statistics()) continue;
        ++tested;
        const std::size_t before = simd::compilations();
        double stops = 0.25;
        for (const ImageBuf& frame : frames) {
            ImageBuf dst;
            ASSERT_TRUE(tonemapper.with_exposure(stops)(dst, frame)) << op.id << dst.geterror();
            ImageBuf bound;
            ASSERT_TRUE(
                tonemapper.with_exposure(stops).with_statistics(measure_scene(frame))(bound, frame))
                << op.id;
            EXPECT_TRUE(same_bits(dst, bound)) << op.id;
            stops += 0.5;
        }
        EXPECT_EQ(simd::compilations() - before, 1) << op.id;
    }
    EXPECT_EQ(tested, 16);
}

/// A program that is compiled for all frames shows each of them as a Tonemapper with that frame's
/// numbers does.
TEST(Tonemap, LiveStatisticsGiveThePictureOfFixedOnes) {
    for (const Operator& op : all_operators()) {
        const TonemapOptions options = {.op = resolve_picture_operator(op.id)};
        const Tonemapper tonemapper(options);
        if (!tonemapper.takes_statistics()) continue;
        for (const ImageBuf& frame : frames_of_rising_light()) {
            SCOPED_TRACE(op.id);
            ImageBuf dst;
            ASSERT_TRUE(tonemapper(dst, frame)) << dst.geterror();
            expect_same_picture(dst, options, frame,
                                resolve_for_picture(resolve_operator(op.id), measure_scene(frame)));
        }
    }
}

/// The defaults are constants, and a tonemapper for them serves statistics, too.
TEST(Tonemap, StatisticsAfterDefaults) {
    const ImageBuf src = make_rgb(24, 16, TypeDesc::FLOAT, 20);
    const TonemapOptions options = {.op = resolve_picture_operator("exponential"),
                                    .statistics = Statistics::defaults};
    const Tonemapper defaults(options);
    ImageBuf dst, with;
    ASSERT_TRUE(defaults(dst, src));
    ASSERT_TRUE(defaults.with_statistics(measure_scene(src))(with, src));
    expect_same_picture(dst, options, src, options.op);
    expect_same_picture(with, options, src,
                        resolve_for_picture(resolve_operator("exponential"), measure_scene(src)));
}

TEST(Tonemap, TakesStatisticsFromThePicture) {
    // One color and its luminance: exponential is 1 - exp(-L/mean), 1 - 1/e of a uniform picture.
    ImageBuf uniform(make_spec(5, 4, {"R", "G", "B"}, TypeDesc::FLOAT));
    OIIO::ImageBufAlgo::fill(uniform, {7.0F, 7.0F, 7.0F});
    const TonemapOptions linear = {.op = resolve_picture_operator("exponential"),
                                   .display = "linear"};
    EXPECT_NEAR(pixel(tonemap(uniform, linear), 2, 2)[1], 1 - std::exp(-1), kTolerance);
    TonemapOptions with_defaults = linear;
    with_defaults.statistics = Statistics::defaults;
    EXPECT_NEAR(pixel(tonemap(uniform, with_defaults), 2, 2)[1], 1 - std::exp(-7), kTolerance);

    const ImageBuf src = make_rgb(40, 30, TypeDesc::HALF, 20);
    for (const char* op : {"exponential", "linear", "drago", "reinhard_devlin"}) {
        for (const char* input : {"lin_rec709", "lin_ap1"}) {
            const TonemapOptions options = {.op = resolve_picture_operator(op), .input = input};
            const ResolvedOperator measured =
                resolve_for_picture(options.op, measure_scene(src, input));
            EXPECT_FALSE(measured.settings.empty());
            expect_same_picture(tonemap(src, options), options, src, measured);
        }
    }
}

TEST(Tonemap, WhatTheUserSetsWinsOverStatistics) {
    const ImageBuf src = make_rgb(40, 30, TypeDesc::FLOAT, 20);
    // One of two.
    const TonemapOptions options = {.op = resolve_picture_operator("drago", {{"maximum", "50"}})};
    const std::string average = shortest(measure_scene(src).log_average);
    expect_same_picture(tonemap(src, options), options, src,
                        resolve_operator("drago", {{"maximum", "50"}, {"log_average", average}}));
    // All.
    const TonemapOptions all = {.op = resolve_picture_operator("exponential", {{"average", "2"}})};
    expect_same_picture(tonemap(src, all), all, src, all.op);
}

TEST(Tonemap, ExposureComesOnTopOfStatistics) {
    // The mean is that of the picture before exposure: a stop more light is a brighter picture.
    ImageBuf src(make_spec(4, 4, {"R", "G", "B"}, TypeDesc::FLOAT));
    OIIO::ImageBufAlgo::fill(src, {3.0F, 3.0F, 3.0F});
    const TonemapOptions options = {
        .op = resolve_picture_operator("exponential"), .exposure_stops = 1, .display = "linear"};
    EXPECT_NEAR(pixel(tonemap(src, options), 0, 0)[0], 1 - std::exp(-2), kTolerance);
}

TEST(Tonemap, StatisticsAreOfTheWholePictureWhateverTheRegion) {
    const ImageBuf src = make_rgb(64, 48, TypeDesc::FLOAT, 20);
    const TonemapOptions options = {.op = resolve_picture_operator("drago")};
    const ImageBuf whole = tonemap(src, options);
    ImageBuf tiled(whole.spec());
    for (int y = 0; y < 48; y += 16) {
        for (int x = 0; x < 64; x += 16)
            ASSERT_TRUE(tonemap(tiled, src, options, ROI(x, x + 16, y, y + 16)));
    }
    EXPECT_TRUE(same_bits(tiled, whole));
    // In place, too, when all is done at once.
    ImageBuf in_place = src;
    ASSERT_TRUE(tonemap(in_place, in_place, options));
    EXPECT_TRUE(same_bits(in_place, whole));
}

TEST(Tonemap, OneTonemapperMeasuresEachPicture) {
    const TonemapOptions options = {.op = resolve_picture_operator("exponential")};
    const Tonemapper tonemapper(options);
    for (const float peak : {0.5F, 40.0F}) {
        const ImageBuf src = make_rgb(20, 20, TypeDesc::FLOAT, peak);
        ImageBuf dst;
        ASSERT_TRUE(tonemapper(dst, src)) << dst.geterror();
        EXPECT_TRUE(same_bits(dst, tonemap(src, options)));
        expect_same_picture(dst, options, src, resolve_for_picture(options.op, measure_scene(src)));
    }
}

TEST(Tonemap, StatisticsAreOfTheColorThatIsToneMapped) {
    ImageBuf src(make_spec(2, 1, {"R", "G", "B", "A"}, TypeDesc::FLOAT));
    set(src, 0, 0, {0.5F, 0.5F, 0.5F, 0.25F});  // 2 where it covers
    set(src, 1, 0, {90, 90, 90, 0});
    TonemapOptions options = {.op = resolve_picture_operator("exponential"), .display = "linear"};
    EXPECT_NEAR(pixel(tonemap(src, options), 0, 0)[0], 0.25 * (1 - std::exp(-1)), kTolerance);
    options.unpremult = Unpremult::no;
    EXPECT_NEAR(pixel(tonemap(src, options), 0, 0)[0], 1 - std::exp(-0.5 / 45.25), kTolerance);
}

TEST(Tonemap, PicturesWithoutLightAreNoError) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const Operator& op : all_operators()) {
        // Law.SimdIsTotalAndWithinItsBound has those that take nothing from the picture.
        const bool takes_statistics =
            std::any_of(op.parameters.begin(), op.parameters.end(),
                        [](const ParameterSpec& p) { return !p.statistic.empty(); });
        if (!takes_statistics && !takes_full_counts()) continue;
        // An engine is compiled for each.
        const std::vector<float> values = takes_full_counts()
                                              ? std::vector<float>{0, nan, 0.18F, 65504}
                                              : std::vector<float>{0, nan};
        for (const float value : values) {
            ImageBuf src(make_spec(2, 2, {"R", "G", "B"}, TypeDesc::FLOAT));
            OIIO::ImageBufAlgo::fill(src, {value, value, value});
            const ImageBuf result = tonemap(src, {.op = resolve_picture_operator(op.id)});
            ASSERT_FALSE(result.has_error()) << op.id << ": " << result.geterror();
            EXPECT_TRUE(std::isfinite(pixel(result, 1, 1)[2])) << op.id;
        }
    }
}

TEST(Tonemap, WrongNamesAreToldBeforeThePictureIsMeasured) {
    EXPECT_THROW(Tonemapper({.op = resolve_picture_operator("drago"), .input = "lin_rec708"}),
                 Error);
    EXPECT_THROW(Tonemapper({.op = resolve_picture_operator("drago"), .display = "srbg"}), Error);
    EXPECT_THROW(Tonemapper({.op = resolve_picture_operator("drago"), .exposure_stops = 65}),
                 Error);
}

TEST(Tonemap, InPlaceEqualsOutOfPlace) {
    for (const auto type : {TypeDesc::UINT8, TypeDesc::UINT16, TypeDesc::HALF, TypeDesc::FLOAT}) {
        const ImageBuf src = make_picture(make_spec(50, 40, {"R", "G", "B", "A", "Z"}, type));
        ImageBuf out(src.spec());
        ASSERT_TRUE(tonemap(out, src, hable()));
        ImageBuf in_place = src;
        ASSERT_TRUE(tonemap(in_place, in_place, hable()));
        EXPECT_TRUE(same_bits(out, in_place)) << TypeDesc(type).c_str();
        EXPECT_FALSE(same_bits(out, src));
    }
}

TEST(Tonemap, RegionOfAnExistingDestination) {
    const ImageBuf src = make_rgb(16, 12);
    for (const auto type : {TypeDesc::UINT16, TypeDesc::FLOAT}) {
        ImageBuf dst(make_spec(16, 12, {"R", "G", "B"}, type));
        OIIO::ImageBufAlgo::fill(dst, {0.25F, 0.5F, 0.75F});
        const ImageBuf before = dst;
        const ROI roi(3, 10, 2, 7);
        ASSERT_TRUE(tonemap(dst, src, hable(), roi));
        const ImageBuf all = [&] {
            ImageBuf image(dst.spec());
            EXPECT_TRUE(tonemap(image, src, hable()));
            return image;
        }();
        for (int y = 0; y < 12; ++y) {
            for (int x = 0; x < 16; ++x) {
                const ImageBuf& expected = roi.contains(x, y) ? all : before;
                ASSERT_EQ(pixel(dst, x, y), pixel(expected, x, y)) << x << ", " << y;
            }
        }
    }
}

TEST(Tonemap, NewDestinationHasTheSizeOfTheRegion) {
    const ImageBuf src = make_rgb(16, 12);
    const ImageBuf part = tonemap(src, hable(), ROI(3, 10, 2, 7));
    ASSERT_FALSE(part.has_error()) << part.geterror();
    EXPECT_EQ(part.roi(), ROI(3, 10, 2, 7, 0, 1, 0, 3));
    EXPECT_EQ(pixel(part, 5, 5), pixel(tonemap(src, hable()), 5, 5));
}

TEST(Tonemap, RegionBesideTheDestinationWritesNothing) {
    const ImageBuf src = make_rgb(8, 8);
    ImageBuf dst = make_rgb(8, 8);
    const ImageBuf before = dst;
    EXPECT_TRUE(tonemap(dst, src, hable(), ROI(100, 110, 0, 8)));
    EXPECT_TRUE(same_bits(dst, before));
}

TEST(Tonemap, OutsideItsDataWindowTheSourceIsBlack) {
    for (const bool cached : {false, true}) {
        ImageSpec spec = make_spec(4, 4, {"R", "G", "B", "Z"}, TypeDesc::HALF);
        spec.x = 2;
        spec.y = 3;
        ImageBuf src = make_picture(spec);
        const Folder folder;
        if (cached) {
            ASSERT_TRUE(src.write(folder / "window.exr"));
            src.reset(folder / "window.exr", 0, 0, OIIO::ImageCache::create());
            src.init_spec(src.name(), 0, 0);
            ASSERT_TRUE(src.cachedpixels());
        }
        ImageBuf dst(make_spec(10, 10, {"R", "G", "B", "Z"}, TypeDesc::FLOAT));
        OIIO::ImageBufAlgo::fill(dst, {0.5F, 0.5F, 0.5F, 0.5F});
        ASSERT_TRUE(tonemap(dst, src, hable())) << dst.geterror();
        EXPECT_EQ(pixel(dst, 1, 4), (std::vector<float>{0, 0, 0, 0}));
        EXPECT_EQ(pixel(dst, 6, 4), (std::vector<float>{0, 0, 0, 0}));
        EXPECT_EQ(pixel(dst, 3, 9), (std::vector<float>{0, 0, 0, 0}));
        EXPECT_EQ(pixel(dst, 3, 4), pixel(tonemap(src, hable()), 3, 4));
    }
}

TEST(Tonemap, Volumes) {
    ImageSpec spec = make_spec(5, 4, {"R", "G", "B"}, TypeDesc::FLOAT);
    spec.depth = spec.full_depth = 3;
    const ImageBuf src = make_picture(spec);
    const ImageBuf result = tonemap(src, hable());
    ASSERT_FALSE(result.has_error()) << result.geterror();
    const Vector3 want = reference(hable())(Vector3{
        src.getchannel(1, 2, 2, 0), src.getchannel(1, 2, 2, 1), src.getchannel(1, 2, 2, 2)});
    EXPECT_NEAR(result.getchannel(1, 2, 2, 1), want[1], kTolerance);
}

TEST(Tonemap, MemoryOfTheCaller) {
    // Rows with a gap, pixels that are not aligned to their type.
    constexpr int kWidth = 6;
    constexpr std::size_t kPixel = 3 * sizeof(float) + 1;
    std::vector<char> memory(3 + 4 * (kWidth * kPixel + 5));
    const ImageSpec spec = make_spec(kWidth, 4, {"R", "G", "B"}, TypeDesc::FLOAT);
    ImageBuf wrapped(spec, memory.data() + 3, kPixel, kWidth * kPixel + 5);
    const ImageBuf src = make_rgb(kWidth, 4);
    ASSERT_TRUE(tonemap(wrapped, src, hable())) << wrapped.geterror();
    const ImageBuf expected = tonemap(src, hable());
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < kWidth; ++x)
            EXPECT_EQ(pixel(wrapped, x, y), pixel(expected, x, y));
    }
}

TEST(Tonemap, ChannelRange) {
    const ImageBuf src = make_picture(make_spec(4, 4, {"R", "G", "B", "A", "Z"}, TypeDesc::FLOAT));
    ImageBuf dst(src.spec());
    OIIO::ImageBufAlgo::fill(dst, {9.0F, 9.0F, 9.0F, 9.0F, 9.0F});
    ASSERT_TRUE(tonemap(dst, src, hable(), ROI(0, 4, 0, 4, 0, 1, 0, 4)));
    const ImageBuf all = tonemap(src, hable());
    // Alpha is in the range, Z is not.
    std::vector<float> expected = pixel(all, 1, 1);
    expected[4] = 9;
    EXPECT_EQ(pixel(dst, 1, 1), expected);
    // Alpha not in the range: divided by, not written.
    OIIO::ImageBufAlgo::fill(dst, {9.0F, 9.0F, 9.0F, 9.0F, 9.0F});
    ASSERT_TRUE(tonemap(dst, src, hable(), ROI(0, 4, 0, 4, 0, 1, 0, 3)));
    expected[3] = 9;
    EXPECT_EQ(pixel(dst, 1, 1), expected);

    expect_error(dst, tonemap(dst, src, hable(), ROI(0, 4, 0, 4, 0, 1, 1, 4)),
                 "channel range is [1, 4)");
    expect_error(dst, tonemap(dst, src, hable(), ROI(0, 4, 0, 4, 0, 1, 0, 2)),
                 "channel range is [0, 2)");
}

TEST(Tonemap, OtherChannelsAreCopied) {
    ImageBuf src(make_spec(2, 1, {"R", "G", "B", "A", "Z", "id"}, TypeDesc::FLOAT));
    set(src, 0, 0, {0.18F, 0.18F, 0.18F, 1, 7, 1e9F});
    set(src, 1, 0, {0.18F, 0.18F, 0.18F, 0.5F, -3, std::numeric_limits<float>::quiet_NaN()});
    const ImageBuf result = tonemap(src, hable());
    // OIIO's own color functions make 70.5 of a Z of 7.
    EXPECT_EQ(pixel(result, 0, 0)[4], 7);
    EXPECT_EQ(pixel(result, 0, 0)[5], 1e9F);
    EXPECT_EQ(pixel(result, 1, 0)[3], 0.5F);
    EXPECT_TRUE(std::isnan(pixel(result, 1, 0)[5]));
    EXPECT_EQ(result.spec().channelnames, src.spec().channelnames);
    EXPECT_EQ(result.spec().alpha_channel, 3);
    EXPECT_EQ(result.spec().z_channel, 4);
}

template <class Pixel>
void expect_extra_channel_bits(TypeDesc type, const std::vector<Pixel>& values) {
    const int width = static_cast<int>(values.size());
    ImageBuf src(make_spec(width, 1, {"R", "G", "B", "extra"}, type));
    for (int x = 0; x < width; ++x) {
        std::memcpy(src.pixeladdr(x, 0, 0, 3), &values[static_cast<std::size_t>(x)], sizeof(Pixel));
    }
    ImageBuf other(src.spec());
    ASSERT_TRUE(tonemap(other, src, hable()));
    ASSERT_TRUE(tonemap(src, src, hable()));
    for (int x = 0; x < width; ++x) {
        const Pixel expected = values[static_cast<std::size_t>(x)];
        EXPECT_EQ(std::memcmp(other.pixeladdr(x, 0, 0, 3), &expected, sizeof(Pixel)), 0)
            << type.c_str();
        EXPECT_EQ(std::memcmp(src.pixeladdr(x, 0, 0, 3), &expected, sizeof(Pixel)), 0)
            << type.c_str();
    }
}

TEST(Tonemap, OtherChannelsAreCopiedBitForBit) {
    // Half bits: a denormal, a NaN with a payload, infinity, -0.
    expect_extra_channel_bits<std::uint16_t>(TypeDesc::HALF,
                                             {0x0001, 0x7e55, 0x7c00, 0x8000, 0x3c01});
    expect_extra_channel_bits<std::uint16_t>(TypeDesc::UINT16, {0, 1, 40001, 65535});
    expect_extra_channel_bits<std::uint32_t>(TypeDesc::UINT32, {1, 0xfffffffe, 123456789});
    expect_extra_channel_bits<std::int32_t>(TypeDesc::INT32, {-1, 2147483647, -123456789});
    expect_extra_channel_bits<double>(TypeDesc::DOUBLE, {0.1, 1e300, -1e-300});
    expect_extra_channel_bits<std::uint8_t>(TypeDesc::UINT8, {0, 1, 77, 255});
}

TEST(Tonemap, OtherChannelsAreConvertedWhereTypesDiffer) {
    ImageBuf src(make_spec(1, 1, {"R", "G", "B", "id"}, TypeDesc::UINT32));
    const std::uint32_t id = 0xfffffffe;
    std::memcpy(src.pixeladdr(0, 0, 0, 3), &id, sizeof id);
    ImageBuf dst(make_spec(1, 1, {"R", "G", "B", "id"}, TypeDesc::DOUBLE));
    ASSERT_TRUE(tonemap(dst, src, hable()));
    double value = 0;
    std::memcpy(&value, dst.pixeladdr(0, 0, 0, 3), sizeof value);
    EXPECT_DOUBLE_EQ(value, 4294967294.0 / 4294967295.0);
}

TEST(Tonemap, AssociatedColorIsDividedByAlpha) {
    ImageBuf src(make_spec(1, 1, {"R", "G", "B", "A"}, TypeDesc::FLOAT));
    set(src, 0, 0, {0.09F, 0.5F, 2, 0.5F});
    const ReferenceEngine engine = reference(hable());
    const Vector3 divided = engine(Vector3{0.18, 1, 4});
    const Vector3 as_is = engine(Vector3{0.09F, 0.5, 2});
    const auto expect = [&](Unpremult unpremult, const Vector3& want, double factor) {
        TonemapOptions options = hable();
        options.unpremult = unpremult;
        const std::vector<float> out = pixel(tonemap(src, options), 0, 0);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(out[c], factor * want[c], kTolerance);
        EXPECT_EQ(out[3], 0.5F);
    };
    expect(Unpremult::automatic, divided, 0.5);
    expect(Unpremult::yes, divided, 0.5);
    expect(Unpremult::no, as_is, 1);
    src.specmod().attribute("oiio:UnassociatedAlpha", 1);
    expect(Unpremult::automatic, as_is, 1);
    expect(Unpremult::yes, divided, 0.5);
}

/// The rule of tonemap.h, point 3, in double.
double divisor_of_emission(double alpha, double most, double stops) {
    const double surface = 16 * std::exp2(-stops) * alpha;
    return most <= surface || alpha >= 1 ? alpha : alpha + (1 - alpha) * (1 - surface / most);
}

TEST(Tonemap, EmissionAboveSmallAlphaIsNotDivided) {
    const Vector3 flame = {3, 1, 0.25};
    for (const double stops : {0.0, 2.0, -3.0}) {
        TonemapOptions options = hable();
        options.exposure_stops = stops;
        const ReferenceEngine engine = reference(options);
        for (const double alpha : {1e-30, 1e-6, 1e-3, 0.03, 0.1, 3.0 / 16, 0.2, 0.5, 0.75, 2.0}) {
            options.unpremult = Unpremult::automatic;
            ImageBuf src(make_spec(1, 1, {"R", "G", "B", "A"}, TypeDesc::FLOAT));
            set(src, 0, 0, {3, 1, 0.25F, static_cast<float>(alpha)});
            const double d = divisor_of_emission(static_cast<float>(alpha), 3, stops);
            const Vector3 want = engine(Vector3{flame[0] / d, flame[1] / d, flame[2] / d});
            const std::vector<float> out = pixel(tonemap(src, options), 0, 0);
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(out[c], d * want[c], kTolerance) << alpha << " " << stops;
            EXPECT_EQ(out[3], static_cast<float>(alpha));
            // Plain division on request.
            options.unpremult = Unpremult::yes;
            if (alpha < 1e-10) continue;  // beyond what a channel may be
            const Vector3 divided =
                engine(Vector3{flame[0] / alpha, flame[1] / alpha, flame[2] / alpha});
            EXPECT_NEAR(pixel(tonemap(src, options), 0, 0)[0], alpha * divided[0], kTolerance);
        }
    }
}

TEST(Tonemap, EmissionIsContinuousInAlpha) {
    // 1024 alphas from 0 to where the flame is a surface, whose result is a pixel each.
    constexpr int kSteps = 1024;
    ImageBuf src(make_spec(kSteps + 1, 1, {"R", "G", "B", "A"}, TypeDesc::FLOAT));
    for (int i = 0; i <= kSteps; ++i)
        set(src, i, 0, {3, 1, 0.25F, 0.25F * static_cast<float>(i) / kSteps});
    const ImageBuf result = tonemap(src, hable());
    for (int i = 1; i <= kSteps; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            // The divisor changes by at most 16/3 a unit of alpha, and the result by no more than
            // the divisor times the slope of the curve, which is below 4 code values a unit.
            EXPECT_NEAR(pixel(result, i, 0)[c], pixel(result, i - 1, 0)[c],
                        4 * 16.0 / 3 * 0.25 / kSteps)
                << i;
        }
    }
}

TEST(Tonemap, EmissionIsMeteredAsItIsToneMapped) {
    for (const bool has_nan : {false, true}) {  // which takes another way through the meter
        ImageBuf src(make_spec(3, 1, {"R", "G", "B", "A"}, TypeDesc::FLOAT));
        set(src, 0, 0, {3, 3, 3, 1e-3F});
        set(src, 1, 0, {0.5F, 0.5F, 0.5F, 0.25F});
        set(src, 2, 0, {1, has_nan ? std::numeric_limits<float>::quiet_NaN() : 1, 1, 1});
        const double flame = 3 / divisor_of_emission(1e-3F, 3, 0);
        EXPECT_NEAR(measure_scene(src).maximum_luminance, flame, 1e-6 * flame);
        EXPECT_NEAR(measure_scene(src, "auto", Unpremult::yes).maximum_luminance, 3000, 1e-3);
    }
}

TEST(Tonemap, ColorWithoutUsableAlphaIsTakenAsItIs) {
    const float inf = std::numeric_limits<float>::infinity();
    ImageBuf src(make_spec(4, 1, {"R", "G", "B", "A"}, TypeDesc::FLOAT));
    set(src, 0, 0, {3, 1, 0.2F, 0});  // a flame: light that covers nothing
    set(src, 1, 0, {3, 1, 0.2F, inf});
    set(src, 2, 0, {3, 1, 0.2F, std::numeric_limits<float>::quiet_NaN()});
    set(src, 3, 0, {3, 1, 0.2F, 1e-40F});  // divided: beyond float
    const Vector3 want = reference(hable())(Vector3{3, 1, 0.2F});
    const ImageBuf result = tonemap(src, hable());
    for (int x = 0; x < 4; ++x) {
        for (std::size_t c = 0; c < 3; ++c) {
            const float out = pixel(result, x, 0)[c];
            EXPECT_TRUE(std::isfinite(out));
            if (x < 3) {
                EXPECT_NEAR(out, want[c], kTolerance) << x;
            }
        }
    }
    EXPECT_EQ(pixel(result, 0, 0)[3], 0);
}

TEST(Tonemap, ErrorsAreOnTheDestination) {
    const ImageBuf src = make_rgb(2, 2);
    ImageBuf dst;
    expect_error(dst, tonemap(dst, src, TonemapOptions{}), "op is missing");
    expect_error(dst,
                 tonemap(dst, src, {.op = resolve_picture_operator("hable"), .exposure_stops = 99}),
                 "exposure is 99");
    expect_error(
        dst, tonemap(dst, src, {.op = resolve_picture_operator("hable"), .input = "lin_rec708"}),
        "input is lin_rec708");
    expect_error(dst,
                 tonemap(dst, src, {.op = resolve_picture_operator("hable"), .display = "srbg"}),
                 "display is srbg");
    expect_error(dst, tonemap(dst, ImageBuf(), hable()), "source is not initialized");
    expect_error(dst, tonemap(dst, ImageBuf("/nonexistent/a.exr"), hable()), "/nonexistent/a.exr");
    const ImageBuf value = tonemap(src, TonemapOptions{});
    EXPECT_TRUE(value.has_error());

    ImageBuf gray(make_spec(2, 2, {"Y"}, TypeDesc::FLOAT));
    expect_error(gray, tonemap(gray, src, hable()),
                 "destination has 1 channel; expected 3 or more");
}

TEST(Tonemap, DeepPicturesAreRefused) {
    ImageSpec spec = make_spec(2, 2, {"R", "G", "B", "A", "Z"}, TypeDesc::FLOAT);
    spec.deep = true;
    const ImageBuf src(spec);
    ImageBuf dst;
    expect_error(dst, tonemap(dst, src, hable()), "source is deep; expected flat pixels");
    ImageBuf deep(spec);
    expect_error(deep, tonemap(deep, make_rgb(2, 2), hable()), "destination is deep");
}

TEST(Tonemap, CachedAndTiledSources) {
    const Folder folder;
    const std::string path = folder / "tiled.exr";
    ImageBuf local = make_picture(make_spec(150, 90, {"R", "G", "B", "A", "Z"}, TypeDesc::HALF), 5);
    local.set_write_tiles(32, 32);
    ASSERT_TRUE(local.write(path)) << local.geterror();
    const ImageBuf cached = cached_picture(path);
    const ImageBuf result = tonemap(cached, hable(), {}, 4);
    ASSERT_FALSE(result.has_error()) << result.geterror();
    EXPECT_TRUE(cached.cachedpixels());
    EXPECT_EQ(result.spec().tile_width, 0);
    EXPECT_TRUE(same_bits(result, tonemap(local, hable(), {}, 1)));
    // In place, a cached picture becomes a local one.
    ImageBuf in_place(path);
    ASSERT_TRUE(tonemap(in_place, in_place, hable())) << in_place.geterror();
    EXPECT_EQ(pixel(in_place, 149, 89)[4], pixel(local, 149, 89)[4]);
}

TEST(Tonemap, TruncatedSourceIsAnError) {
    const Folder folder;
    for (const bool is_cached : {false, true}) {
        // The cache of OpenImageIO 2.4 reports the error of a file once.
        const std::string name = is_cached ? "cached_cut.exr" : "cut.exr";
        write_truncated(folder / name);
        const ImageBuf cut = is_cached ? cached_picture(folder / name) : ImageBuf(folder / name);
        ImageBuf dst;
        expect_error(dst, tonemap(dst, cut, hable()), name);
    }
}

struct Told {
    std::vector<float> parts;
    float stop_at = 2;
};

bool tell(void* data, float part) {
    auto& told = *static_cast<Told*>(data);
    told.parts.push_back(part);
    return part >= told.stop_at;
}

TEST(Tonemap, TellsItsProgress) {
    const ImageBuf src = make_rgb(64, 500);
    for (const int threads : {1, 4}) {
        Told told;
        ImageBuf dst;
        ASSERT_TRUE(tonemap(dst, src, hable(), {}, threads, tell, &told)) << dst.geterror();
        ASSERT_FALSE(told.parts.empty());
        EXPECT_GE(told.parts.size(), 50U);
        EXPECT_LE(told.parts.size(), 110U);
        EXPECT_TRUE(std::is_sorted(told.parts.begin(), told.parts.end()));
        EXPECT_EQ(told.parts.back(), 1);
        EXPECT_TRUE(same_bits(dst, tonemap(src, hable())));
    }
    Told of_region;
    ASSERT_TRUE(Tonemapper(hable())(*std::make_unique<ImageBuf>(), src, {3, 9, 5, 7, 0, 1, 0, 3}, 1,
                                    tell, &of_region));
    EXPECT_EQ(of_region.parts.back(), 1) << "of the region";
}

TEST(Tonemap, StopsWhenItIsTold) {
    const ImageBuf src = make_rgb(64, 500);
    for (const int threads : {1, 4}) {
        Told told;
        told.stop_at = 0.3F;
        ImageBuf dst;
        const bool ok = tonemap(dst, src, hable(), {}, threads, tell, &told);
        expect_error(dst, ok, "canceled");
        EXPECT_LT(told.parts.back(), 0.4F) << "and is not asked again";
    }
}

TEST(Tonemap, WhatAFunctionThrowsIsAnError) {
    const ImageBuf src = make_rgb(8, 300);
    for (const int kind : {0, 1, 2}) {
        ImageBuf dst;
        const auto thrower = [&](const float*, float*, std::size_t) {
            if (kind == 0) throw std::runtime_error("no more");
            if (kind == 1) throw std::bad_alloc();
            throw 5;  // NOLINT(hicpp-exception-baseclass): anything may come
        };
        EXPECT_FALSE(map_colors(dst, src, thrower, Unpremult::automatic, {}, 4));
        const std::string message = dst.geterror();
        constexpr std::array kMessages = {"no more", "not enough memory", "unknown error"};
        EXPECT_EQ(message, kMessages.at(static_cast<std::size_t>(kind)));
    }
}

TEST(Tonemap, AnySubimageAndLevel) {
    const Folder folder;
    const std::string path = folder / "mip.exr";
    const ImageBuf top = make_rgb(64, 64, TypeDesc::HALF, 4);
    OIIO::ImageSpec config;
    config.set_format(TypeDesc::HALF);
    ASSERT_TRUE(
        OIIO::ImageBufAlgo::make_texture(OIIO::ImageBufAlgo::MakeTxTexture, top, path, config))
        << OIIO::geterror();
    const ImageBuf level(path, 0, 2);
    ASSERT_EQ(level.spec().width, 16);
    const ImageBuf result = tonemap(level, hable());
    ASSERT_FALSE(result.has_error()) << result.geterror();
    ImageBuf local = level.copy(TypeDesc::FLOAT);
    EXPECT_TRUE(same_bits(result, tonemap(local, hable())));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
