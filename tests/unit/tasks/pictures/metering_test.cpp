// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/metering.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tonewright/image_io.h"
#include "tonewright/registry.h"
#include "unit/errors.h"
#include "unit/folder.h"
#include "unit/image/pictures.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Gray frames: frame n is twice as bright as frame n - 1.
class MeteredFrames : public testing::Test {
  protected:
    MeteredFrames() {
        for (const int number : {1, 2, 3}) {
            OIIO::ImageBuf picture(OIIO::ImageSpec(8, 6, 3, OIIO::TypeFloat));
            const auto light = static_cast<float>(0.18 * std::exp2(number));
            const std::vector<float> pixels(8 * 6 * 3, light);
            picture.set_pixels(picture.roi(), OIIO::TypeFloat, pixels.data());
            write_image_atomically(picture, frame_name("in", in(), number));
        }
    }
    [[nodiscard]] std::string in() const { return folder_ / "in.#.exr"; }
    [[nodiscard]] Shot shot(std::vector<int> numbers) const {
        return plan_shot({in(), folder_ / "out.#.png", std::move(numbers)});
    }
    static ExposureRequest by_mean() {
        ExposureRequest request;
        request.rule = ExposureRule{};
        request.rule->method = ExposureRule::Method::mean;
        return request;
    }
    Folder folder_;
};

TEST_F(MeteredFrames, SuggestionHasAllFigures) {
    const Metering metering = meter_file(frame_name("in", in(), 2));
    const Suggestion suggestion = suggest_exposure(metering, *by_mean().rule, kMeterDelta);
    EXPECT_NEAR(suggestion.luminance, 0.72, 1e-6);
    EXPECT_NEAR(suggestion.stops, -2, 1e-6);
    EXPECT_EQ(suggestion.ev100, ev100(suggestion.luminance));
}

TEST_F(MeteredFrames, CacheAndProgress) {
    MeterRequest request;
    request.cache = folder_ / "cache.json";
    const std::vector<std::string> paths = {frame_name("in", in(), 1), folder_ / "none.exr"};
    std::vector<std::pair<std::size_t, std::size_t>> told;
    const Listener listener = {
        .progress = [&](std::size_t done, std::size_t total) { told.emplace_back(done, total); }};
    const auto first = meter_pictures(paths, request, listener);
    EXPECT_FALSE(first[0].problem);
    ASSERT_TRUE(first[1].problem);
    EXPECT_EQ(first[1].problem->kind, Problem::Kind::file);
    EXPECT_EQ(told, (std::vector<std::pair<std::size_t, std::size_t>>{{1, 2}, {2, 2}}));
    EXPECT_NE(read(request.cache).find("in.0001.exr"), std::string::npos);
    // A figure that no picture has shows that the second run reads the cache.
    std::string text = read(request.cache);
    const std::string key = "\"log_average\":";
    const std::size_t at = text.find(key);
    ASSERT_NE(at, std::string::npos) << text;
    const std::size_t number = text.find_first_not_of(' ', at + key.size());
    text.replace(number, text.find_first_of(",}", number) - number, "123.0");
    write(request.cache, text);
    EXPECT_EQ(meter_pictures(paths, request)[0].metering.log_average, 123);
}

TEST_F(MeteredFrames, EachFileGetsItsExposure) {
    ExposureRequest request = by_mean();
    request.exposure_stops = 0.5;
    std::vector<FrameFiles> files = shot({1, 3}).frames;
    (void)meter_files(files, request);
    EXPECT_NEAR(*files[0].exposure_stops, -0.5, 1e-6);
    EXPECT_NEAR(*files[1].exposure_stops, -2.5, 1e-6);
    std::vector<FrameFiles> missing = {{folder_ / "none.exr", folder_ / "none.png"}};
    EXPECT_THROW((void)meter_files(missing, request), FileError);
}

TEST_F(MeteredFrames, ShotAdaptsAndGivesStatistics) {
    ExposureRequest request = by_mean();
    request.adaptation = Adaptation{};
    request.takes_sequence = true;
    request.frames = {1, 2, 3};
    Tonemapper tonemapper({.op = resolve_picture_operator("drago")});
    Shot part = shot({2});
    meter_frames(tonemapper, part, in(), request);
    EXPECT_FALSE(tonemapper.takes_statistics());
    EXPECT_LT(*part.frames[0].exposure_stops, -1);  // between its own and that of the first frame
    EXPECT_GT(*part.frames[0].exposure_stops, -2);
    request.frames = {1, 3};
    EXPECT_EQ(error_of([&] { meter_frames(tonemapper, part, in(), request); }),
              "meter frames is 1,3; expected frame 2 of frames in it");
}

TEST_F(MeteredFrames, AdaptationNeedsAllFrames) {
    const MeteredShot metered = meter_shot(in(), {4, 1}, {});
    EXPECT_EQ(metered.numbers, (std::vector<int>{1, 4}));
    EXPECT_EQ(metered.exposures(ExposureRule{}, kMeterDelta, nullptr).size(), 1U);
    const Adaptation adaptation;
    EXPECT_NE(error_of([&] {
                  (void)metered.exposures(ExposureRule{}, kMeterDelta, &adaptation);
              }).find("expected all frames of the shot"),
              std::string::npos);
    EXPECT_THROW((void)metered.statistics(), FileError);
}

TEST_F(MeteredFrames, HistogramsWarnOfTheirRange) {
    MeterRequest request;
    request.options.histogram_min = -8;
    request.options.histogram_max = -7;
    request.options.grows_histogram = false;
    const auto metered = meter_pictures({frame_name("in", in(), 1)}, request);
    EXPECT_NE(histogram_warning(metered[0]).find("leave out <<histogram_range>>"),
              std::string::npos);
    std::vector<std::string> warnings;
    const Listener listener = {.warn = [&](const std::string& line) { warnings.push_back(line); }};
    ExposureRule rule;
    warn_of_histograms(metered, rule, listener);
    EXPECT_TRUE(warnings.empty());
    rule.method = ExposureRule::Method::histogram;
    warn_of_histograms(metered, rule, listener);
    EXPECT_EQ(warnings.size(), 1U);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
