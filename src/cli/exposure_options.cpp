// SPDX-License-Identifier: Apache-2.0
#include "cli/exposure_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <mutex>
#include <set>
#include <thread>

#include "cli/frames.h"
#include "cli/meter_cache.h"
#include "lut/in_parallel.h"
#include "tonewright/tonemap.h"

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
    // Of a volume, all slices.
    constexpr int kAll = 1 << 30;
    return {at(0), at(0) + at(2), at(1), at(1) + at(3), -kAll, kAll};
}

}  // namespace

MeterOptions ExposureOptions::meter_options(const std::string& input,
                                            TonemapOptions::Unpremult unpremult,
                                            int subimage) const {
    MeterOptions o;
    o.input = input;
    o.subimage = subimage;
    o.unpremult = unpremult;
    if (!region.empty()) o.region = parse_region(region);
    o.delta = delta;
    const auto range = parse_numbers("--histogram-range", histogram_range, 2,
                                     "log2 of two luminances, such as -8,3.5");
    o.histogram_min = range[0];
    o.histogram_max = range[1];
    o.bins = histogram_bins;
    const auto percents =
        parse_numbers("--percentiles", percentiles, 2, "two percentages, such as 40,95");
    o.low_percentile = percents[0];
    o.high_percentile = percents[1];
    o.exact = exact;
    check_meter_options(o);
    return o;
}

ExposureRule ExposureOptions::rule() const {
    ExposureRule r;
    r.method = parse_meter_method(method);
    if (key == "auto") {
        r.auto_key = true;
    } else if (!key.empty()) {
        r.key = parse_numbers("--key", key, 1, "[0.001, 16] or auto")[0];
    }
    if (calibration == "9.6") {
        r.calibration = ExposureRule::Calibration::saturation;
        if (!key.empty()) {
            throw Error("meter: --key is " + key +
                        "; expected none with --calibration 9.6, which has a key of its own");
        }
    } else if (calibration != "key") {
        throw Error("meter: --calibration is " + calibration + "; expected key or 9.6");
    }
    r.compensation = compensation;
    const auto stops = parse_numbers("--exposure-limits", limits, 2, "two stops, such as -4,6");
    r.min_stops = stops[0];
    r.max_stops = stops[1];
    check_exposure_rule(r);
    return r;
}

Adaptation ShotOptions::adaptation(const CLI::App& command) const {
    Adaptation a;
    if (form == "0.98") {
        a.form = Adaptation::Form::power_098;
    } else if (form != "exponential") {
        throw Error("meter: --adapt-form is " + form + "; expected exponential or 0.98");
    }
    if (command.count("--adapt-up") > 0) a.up = up;
    if (command.count("--adapt-down") > 0) a.down = down;
    if (command.count("--adapt-start") > 0) a.start = start;
    a.fps = fps;
    check_adaptation(a);
    return a;
}

void add_exposure_options(CLI::App& command, ExposureOptions& options, CLI::Option* method) {
    const auto add = [&](const char* name, auto& value, const char* help) {
        CLI::Option* option = command.add_option(name, value, help);
        if (method) option->needs(method);
        option->group("Metering");
        return option;
    };
    add(method ? "--meter-region" : "--region,--meter-region", options.region,
        "pixels that count: x,y,width,height; default: all");
    add("--delta", options.delta,
        "added to each luminance inside the logarithm of the log average, and the least metered "
        "luminance")
        ->capture_default_str();
    add("--percentiles", options.percentiles,
        "the histogram's average is that of the pixels between, such as 40,95")
        ->capture_default_str();
    add("--histogram-range", options.histogram_range, "log2 of luminance")->capture_default_str();
    add("--histogram-bins", options.histogram_bins, "the first is black")->capture_default_str();
    CLI::Option* exact = command.add_flag(
        "--exact", options.exact,
        "percentiles and the average between them from all luminances, not from bins");
    exact->group("Metering");
    if (method) exact->needs(method);
    add("--key", options.key,
        "what the metered luminance becomes, or `auto`; default: 0.18, of max: 1");
    add("--calibration", options.calibration,
        "`key`, or `9.6`: as a camera that saturates at 9.6 times the metered luminance")
        ->capture_default_str();
    add("--compensation", options.compensation, "stops on top of what is metered")
        ->capture_default_str();
    add("--exposure-limits", options.limits,
        "stops that the metered exposure is held between, before compensation")
        ->capture_default_str();
}

void add_shot_options(CLI::App& command, ShotOptions& options, CLI::Option* frames,
                      CLI::Option* method) {
    const char* const group = "Metering of shots";
    CLI::Option* adapt = command.add_flag("--adapt", options.adapt,
                                          "exposure follows the light of the shot, as an eye does");
    adapt->needs(frames)->group(group);
    if (method) adapt->needs(method);
    const auto add = [&](const char* name, auto& value, const char* help, CLI::Option* needed) {
        return command.add_option(name, value, help)->needs(needed)->group(group);
    };
    add("--adapt-up", options.up,
        "speed towards more light, per second; default: 1.1, of 0.98: a factor, 1", adapt);
    add("--adapt-down", options.down, "speed towards less light; default: as --adapt-up's", adapt);
    add("--adapt-form", options.form,
        "`exponential`: 1 - e^(-speed dt), or `0.98`: 1 - 0.98^(30 speed dt)", adapt)
        ->capture_default_str();
    add("--fps", options.fps, "frames per second", adapt)->capture_default_str();
    add("--adapt-start", options.start,
        "exposure of the first frame, stops; default: what it is metered at", adapt);
    add("--meter-frames", options.meter_frames,
        "the whole shot, where --frames is a part of it: all parts have the same exposures",
        frames);
    command
        .add_option("--meter-cache", options.cache,
                    "file to keep what was metered in; frames that have changed since are metered "
                    "again")
        ->group(group);
}

std::vector<MeteredPicture> meter_pictures(const std::vector<std::string>& paths,
                                           const MeterOptions& options, const std::string& cache,
                                           int threads,
                                           const std::function<void(std::size_t)>& done) {
    std::vector<MeteredPicture> pictures(paths.size());
    if (paths.empty()) return pictures;
    MeterCache known(cache, options);
    std::mutex mutex;
    std::size_t done_count = 0;
    const auto all =
        static_cast<std::size_t>(threads > 0 ? static_cast<unsigned>(threads)
                                             : std::max(std::thread::hardware_concurrency(), 1U));
    const std::size_t workers = std::min(all, paths.size());
    in_parallel(paths.size(), static_cast<unsigned>(workers), [&](std::size_t i) {
        MeteredPicture& picture = pictures[i];
        picture.path = paths[i];
        const FileStamp stamp = stamp_of(paths[i]);
        const Metering* found = known.find(paths[i], stamp);
        try {
            picture.metering =
                found ? *found : meter_file(paths[i], options, static_cast<int>(all / workers));
        } catch (const std::exception& e) {
            picture.error = e.what();
            picture.is_file_error = dynamic_cast<const FileError*>(&e) != nullptr;
        }
        const std::lock_guard lock(mutex);
        if (!found && picture.error.empty()) known.add(paths[i], stamp, picture.metering);
        ++done_count;
        if (done) done(done_count);
    });
    known.save();
    return pictures;
}

MeteredShot meter_shot(const std::string& pattern, std::vector<int> frames,
                       const MeterOptions& options, const std::string& cache, int threads,
                       const std::function<void(std::size_t)>& done) {
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    std::vector<std::string> paths;
    paths.reserve(frames.size());
    for (const int frame : frames)
        paths.push_back(frame_name("in", pattern, frame));
    return {std::move(frames), meter_pictures(paths, options, cache, threads, done)};
}

void MeteredShot::require_all() const {
    for (const MeteredPicture& picture : pictures) {
        if (picture.error.empty()) continue;
        const std::string message = "meter: " + picture.error +
                                    "; expected all frames of the shot, the others depend on it";
        if (picture.is_file_error) throw FileError(message);
        throw Error(message);
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
        if (!pictures[i].error.empty()) continue;
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
