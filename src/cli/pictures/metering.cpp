// SPDX-License-Identifier: Apache-2.0
#include "cli/pictures/metering.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <mutex>
#include <set>
#include <thread>

#include "cli/messages.h"
#include "cli/pictures/contained.h"
#include "cli/pictures/frames.h"
#include "cli/pictures/meter_cache.h"
#include "cli/pictures/picture_input.h"
#include "lut/in_parallel.h"

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

// `--help` shows the library's defaults. Clang 14 does not accept a structure with a std::string as
// a constant.
#ifndef __clang__
static_assert(ExposureOptions{}.delta == kMeterDelta &&
              ExposureOptions{}.histogram_bins == kMeterBins &&
              ShotOptions{}.fps == Adaptation{}.fps);
#endif

MeterOptions meter_options_of(const ExposureOptions& options, const MeteredInput& input,
                              const PictureInput& picture) {
    MeterOptions o;
    o.input = input.space;
    o.input_units = parse_input_units(input.units);
    o.reference_white = input.reference_white;
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

std::vector<MeteredPicture> meter_pictures(const std::vector<std::string>& paths,
                                           const MeterOptions& options, const std::string& cache,
                                           const PictureInput& input,
                                           const std::function<void(std::size_t)>& done) {
    std::vector<MeteredPicture> pictures(paths.size());
    if (paths.empty()) return pictures;
    MeterCache known(cache, options);
    std::mutex mutex;
    std::size_t done_count = 0;
    const auto all = static_cast<std::size_t>(
        input.threads > 0 ? static_cast<unsigned>(input.threads)
                          : std::max(std::thread::hardware_concurrency(), 1U));
    std::vector<FileStamp> stamps(paths.size());
    std::vector<std::size_t> unknown;
    for (std::size_t i = 0; i < paths.size(); ++i) {
        pictures[i].path = paths[i];
        stamps[i] = stamp_of(paths[i]);
        if (const Metering* found = known.find(paths[i], stamps[i])) {
            pictures[i].metering = *found;
            if (done) done(++done_count);
        } else {
            unknown.push_back(i);
        }
    }
    const std::size_t workers = std::clamp<std::size_t>(unknown.size(), 1, all);
    const auto threads_each = static_cast<int>(all / workers);
    const auto tell = [&](std::size_t i) {
        if (!pictures[i].problem) known.add(paths[i], stamps[i], pictures[i].metering);
        ++done_count;
        if (done) done(done_count);
    };
    if (input.timeout > 0) {
        std::vector<std::string> names;
        names.reserve(unknown.size());
        for (const std::size_t i : unknown)
            names.push_back(paths[i]);
        const auto meter = [&](std::size_t n) {
            PictureInput threads;
            threads.threads = threads_each;
            use_threads(threads);
            return to_json(meter_file(names[n], options, threads_each)).dump();
        };
        run_contained(names, workers, input.timeout, meter,
                      [&](std::size_t n, const ContainedResult& result) {
                          MeteredPicture& picture = pictures[unknown[n]];
                          picture.problem = result.problem;
                          if (!result.problem)
                              picture.metering = metering_from(Json::parse(result.value));
                          tell(unknown[n]);
                      });
        known.save();
        return pictures;
    }
    in_parallel(unknown.size(), static_cast<unsigned>(workers), [&](std::size_t n) {
        MeteredPicture& picture = pictures[unknown[n]];
        try {
            picture.metering = meter_file(picture.path, options, threads_each);
        } catch (const std::exception& e) {
            picture.problem = command_problem(e);
        }
        const std::lock_guard lock(mutex);
        tell(unknown[n]);
    });
    known.save();
    return pictures;
}

std::string histogram_warning(const MeteredPicture& picture) {
    constexpr double kMostOutside = 0.01;
    const Metering& m = picture.metering;
    if (picture.problem || !(m.share_outside() > kMostOutside)) return "";
    return fmt::format(
        "{}: {:.3g} % of the picture lies outside the histogram's range, {:g},{:g} in log2 of "
        "luminance; leave out --histogram-range, or set one that holds {:.3g},{:.3g}",
        picture.path, 100 * m.share_outside(), m.histogram_min, m.histogram_max,
        std::log2(m.minimum), std::log2(m.maximum));
}

void warn_of_histograms(const std::vector<MeteredPicture>& pictures) {
    for (const MeteredPicture& picture : pictures) {
        if (const std::string text = histogram_warning(picture); !text.empty()) warn(text);
    }
}

MeteredShot meter_shot(const std::string& pattern, std::vector<int> frames,
                       const MeterOptions& options, const std::string& cache,
                       const PictureInput& input, const std::function<void(std::size_t)>& done) {
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    std::vector<std::string> paths;
    paths.reserve(frames.size());
    for (const int frame : frames)
        paths.push_back(frame_name("in", pattern, frame));
    return {std::move(frames), meter_pictures(paths, options, cache, input, done)};
}

void MeteredShot::require_all() const {
    for (const MeteredPicture& picture : pictures) {
        if (!picture.problem) continue;
        Problem problem = within("meter", *picture.problem);
        problem.expected = "all frames of the shot, the others depend on it";
        throw_problem(problem);
    }
}

SceneStatistics MeteredShot::statistics() const {
    require_all();
    std::vector<Metering> frames;
    frames.reserve(pictures.size());
    for (const MeteredPicture& picture : pictures)
        frames.push_back(picture.metering);
    return statistics_of_sequence(frames);
}

std::map<int, double> MeteredShot::exposures(const ExposureRule& rule, double delta,
                                             const Adaptation* adaptation) const {
    if (adaptation) require_all();
    ExposureRule target = rule;
    target.compensation = 0;
    std::vector<int> metered;
    std::vector<double> stops;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (pictures[i].problem) continue;
        metered.push_back(numbers[i]);
        stops.push_back(suggested_exposure(
            metered_luminance(pictures[i].metering, rule.method, delta), target));
    }
    if (adaptation) stops = adapted_exposures(metered, stops, *adaptation);
    std::map<int, double> exposures;
    for (std::size_t i = 0; i < metered.size(); ++i)
        exposures[metered[i]] = stops[i] + rule.compensation;
    return exposures;
}

TONEWRIGHT_NAMESPACE_END
