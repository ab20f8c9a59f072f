// SPDX-License-Identifier: Apache-2.0
#include "cli/pictures/requests.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <system_error>
#include <vector>

#include "cli/rows/apply_request.h"
#include "image/resize.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// `count` numbers with commas between them.
std::vector<double> parse_numbers(const std::string& option, const std::string& text,
                                  std::size_t count, const std::string& expected) {
    std::vector<double> numbers;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (numbers.size() < count) {
        double value = 0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc()) break;
        numbers.push_back(value);
        at = next;
        if (at == end || *at != ',') break;
        ++at;
    }
    if (numbers.size() != count || at != end) {
        throw Error(fmt::format("meter: {} is {}; expected {}", option, text, expected));
    }
    return numbers;
}

OIIO::ROI parse_region(const std::string& text) {
    const std::string expected =
        "x,y,width,height in pixels of the picture, width and height 1 or more";
    const std::vector<double> n = parse_numbers("--meter-region", text, 4, expected);
    constexpr double kMost = 1 << 29;
    for (const double x : n) {
        if (x != static_cast<int>(std::clamp(x, -kMost, kMost)) || n[2] < 1 || n[3] < 1)
            throw Error(fmt::format("meter: --meter-region is {}; expected {}", text, expected));
    }
    const auto at = [&](std::size_t i) { return static_cast<int>(n[i]); };
    // For a volume, all slices.
    constexpr int kAll = 1 << 30;
    return {at(0), at(0) + at(2), at(1), at(1) + at(3), -kAll, kAll};
}

}  // namespace

void check_resize(const char* command, const std::string& resize, const PictureChoice& choice) {
    ResizeSize size;
    try {
        size = parse_resize(resize);
    } catch (const Error& e) {
        throw Error(fmt::format("{}: --{}", command, e.what()));
    }
    const double most = choice.max_pixels.value_or(kMaxPixels);
    if (static_cast<double>(size.width) * std::max(size.height, 1) > most) {
        throw Error(fmt::format("{}: --resize is {}; expected at most {:.0f} pixels (--max-pixels)",
                                command, resize, most));
    }
}

void use_threads(const PictureInput& input) {
    if (input.timeout == 0) set_picture_threads(input.threads);
}

// `--help` shows the library's defaults. Clang 14 does not accept a structure with a std::string as
// a constant.
#ifndef __clang__
static_assert(ExposureOptions{}.delta == kMeterDelta &&
              ExposureOptions{}.histogram_bins == kMeterBins &&
              ShotOptions{}.fps == Adaptation{}.fps);
#endif

MeterOptions meter_options_of(const ExposureOptions& options, const LightOptions& light,
                              const PictureInput& picture) {
    MeterOptions o;
    o.input = light.input;
    o.input_units = parse_input_units(light.units);
    o.reference_white = light.reference_white;
    o.read = read_options_of(picture);
    o.unpremult = alpha_of(picture);
    if (!options.region.empty()) o.region = parse_region(options.region);
    o.delta = options.delta;
    if (!options.histogram_range.empty()) {
        const auto range = parse_numbers("--histogram-range", options.histogram_range, 2,
                                         "log2 of two luminances, such as -8,3.5");
        o.histogram_min = range[0];
        o.histogram_max = range[1];
        o.grows_histogram = false;
    }
    o.bins = options.histogram_bins;
    const auto percents =
        parse_numbers("--percentiles", options.percentiles, 2, "two percentages, such as 40,95");
    o.low_percentile = percents[0];
    o.high_percentile = percents[1];
    o.exact = options.exact;
    check_meter_options(o);
    return o;
}

ExposureRule rule_of(const ExposureOptions& options) {
    ExposureRule r;
    r.method = parse_meter_method(options.method);
    const std::string& key = options.key;
    if (key == "auto") {
        r.auto_key = true;
    } else if (!key.empty()) {
        r.key = parse_numbers("--key", key, 1, "[0.001, 16] or auto")[0];
    }
    if (options.calibration == "9.6") {
        r.calibration = ExposureRule::Calibration::saturation;
        if (!key.empty()) {
            throw Error("meter: --key is " + key + "; expected none with --calibration 9.6");
        }
    } else if (options.calibration != "key") {
        throw Error("meter: --calibration is " + options.calibration + "; expected key or 9.6");
    }
    r.compensation = options.compensation;
    const auto stops =
        parse_numbers("--exposure-limits", options.limits, 2, "two stops, such as -4,6");
    r.min_stops = stops[0];
    r.max_stops = stops[1];
    check_exposure_rule(r);
    return r;
}

Adaptation adaptation_of(const ShotOptions& options) {
    Adaptation a;
    if (options.form == "0.98") {
        a.form = Adaptation::Form::power_098;
    } else if (options.form != "exponential") {
        throw Error("meter: --adapt-form is " + options.form + "; expected exponential or 0.98");
    }
    a.up = options.up;
    a.down = options.down;
    a.start = options.start;
    a.fps = options.fps;
    check_adaptation(a);
    return a;
}

TONEWRIGHT_NAMESPACE_END
