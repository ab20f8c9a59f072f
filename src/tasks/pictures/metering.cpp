// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/metering.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <mutex>
#include <set>

#include "base/problem.h"
#include "image/tonemap_file.h"
#include "lut/in_parallel.h"
#include "tasks/json.h"
#include "tasks/pictures/meter_cache.h"

TONEWRIGHT_NAMESPACE_BEGIN

Suggestion suggest_exposure(const Metering& metering, const ExposureRule& rule, double delta) {
    const double luminance = metered_luminance(metering, rule.method, delta);
    return {luminance, ev100(luminance), suggested_exposure(luminance, rule)};
}

std::vector<MeteredPicture> meter_pictures(const std::vector<std::string>& paths,
                                           const MeterRequest& request, const Listener& listener) {
    std::vector<MeteredPicture> pictures(paths.size());
    if (paths.empty()) return pictures;
    MeterCache known(request.cache, request.options);
    std::mutex mutex;
    std::size_t done_count = 0;
    const auto count_one = [&] {
        ++done_count;
        if (listener.progress) listener.progress(done_count, paths.size());
    };
    const auto all = static_cast<std::size_t>(thread_count(request.work.threads));
    std::vector<FileStamp> stamps(paths.size());
    std::vector<std::size_t> unknown;
    for (std::size_t i = 0; i < paths.size(); ++i) {
        pictures[i].path = paths[i];
        stamps[i] = stamp_of(paths[i]);
        if (const Metering* found = known.find(paths[i], stamps[i])) {
            pictures[i].metering = *found;
            count_one();
        } else {
            unknown.push_back(i);
        }
    }
    const std::size_t workers = std::clamp<std::size_t>(unknown.size(), 1, all);
    const auto threads_each = static_cast<int>(all / workers);
    const auto tell = [&](std::size_t i) {
        if (!pictures[i].problem) known.add(paths[i], stamps[i], pictures[i].metering);
        count_one();
    };
    if (request.work.timeout > 0) {
        std::vector<std::string> names;
        names.reserve(unknown.size());
        for (const std::size_t i : unknown)
            names.push_back(paths[i]);
        const auto meter = [&](std::size_t n) {
            set_picture_threads(threads_each);
            return to_json(meter_file(names[n], request.options, threads_each)).dump();
        };
        run_contained(names, workers, request.work.timeout, meter,
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
            picture.metering = meter_file(picture.path, request.options, threads_each);
        } catch (const std::exception& e) {
            picture.problem = problem_of(e);
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
        "luminance; leave out <<histogram_range>>, or set one that holds {:.3g},{:.3g}",
        picture.path, 100 * m.share_outside(), m.histogram_min, m.histogram_max,
        std::log2(m.minimum), std::log2(m.maximum));
}

void warn_of_histograms(const std::vector<MeteredPicture>& pictures, const ExposureRule& rule,
                        const Listener& listener) {
    if (rule.method != ExposureRule::Method::histogram || !listener.warn) return;
    for (const MeteredPicture& picture : pictures) {
        if (const std::string text = histogram_warning(picture); !text.empty()) listener.warn(text);
    }
}

MeteredShot meter_shot(const std::string& pattern, std::vector<int> frames,
                       const MeterRequest& request, const Listener& listener) {
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    std::vector<std::string> paths;
    paths.reserve(frames.size());
    for (const int frame : frames)
        paths.push_back(frame_name("in", pattern, frame));
    return {std::move(frames), meter_pictures(paths, request, listener)};
}

void MeteredShot::require_all() const {
    for (const MeteredPicture& picture : pictures) {
        if (!picture.problem) continue;
        throw_problem({.kind = picture.problem->kind,
                       .what = unrendered(*picture.problem),
                       .expected = "all frames of the shot, the others depend on it",
                       .error_number = picture.problem->error_number});
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
        stops.push_back(suggest_exposure(pictures[i].metering, target, delta).stops);
    }
    if (adaptation) stops = adapted_exposures(metered, stops, *adaptation);
    std::map<int, double> exposures;
    for (std::size_t i = 0; i < metered.size(); ++i)
        exposures[metered[i]] = stops[i] + rule.compensation;
    return exposures;
}

std::vector<MeteredFrame> frames_of(const MeteredShot& shot, const ExposureRule& rule, double delta,
                                    const Adaptation* adaptation) {
    std::map<int, double> adapted;
    if (adaptation) adapted = shot.exposures(rule, delta, adaptation);
    std::vector<MeteredFrame> frames;
    for (std::size_t i = 0; i < shot.numbers.size(); ++i) {
        frames.push_back({shot.pictures[i], shot.numbers[i]});
        if (const auto found = adapted.find(shot.numbers[i]); found != adapted.end())
            frames.back().adapted = found->second;
    }
    return frames;
}

Json to_json(const MeteredFrame& metered, const ExposureRule& rule, double delta,
             const MessageStyle& style) {
    const MeteredPicture& picture = metered.picture;
    Json j = {{"file", picture.path}};
    if (metered.number) j.add("frame", *metered.number);
    if (picture.problem) {
        j.add("error", render(*picture.problem, style));
        return j;
    }
    const Json measured = to_json(picture.metering);
    for (const auto& [name, value] : measured.members())
        j.add(name, value);
    Json suggested;
    double chosen = 0;
    for (const MeterMethodNames& method : kMeterMethods) {
        ExposureRule other = rule;
        other.method = method.method;
        const Suggestion s = suggest_exposure(picture.metering, other, delta);
        suggested.add(method.name,
                      {{"luminance", s.luminance}, {"ev100", s.ev100}, {"exposure", s.stops}});
        if (method.method == rule.method) chosen = s.stops;
    }
    j.add("suggested", suggested);
    j.add("exposure", chosen);
    if (metered.adapted) j.add("adapted_exposure", *metered.adapted);
    return j;
}

std::vector<MeteredPicture> meter_files(std::vector<FrameFiles>& files,
                                        const ExposureRequest& request, const Listener& listener) {
    std::vector<std::string> paths;
    paths.reserve(files.size());
    for (const FrameFiles& file : files)
        paths.push_back(file.in);
    std::vector<MeteredPicture> metered = meter_pictures(paths, request.meter, listener);
    for (std::size_t i = 0; i < files.size(); ++i) {
        // If there are several, tone mapping reports the reason.
        if (files.size() == 1 && metered[i].problem) throw_problem(*metered[i].problem);
        if (request.meter.work.timeout > 0) files[i].problem = metered[i].problem;
        if (metered[i].problem) continue;
        files[i].exposure_stops =
            request.exposure_stops +
            suggest_exposure(metered[i].metering, *request.rule, request.meter.options.delta).stops;
    }
    return metered;
}

void meter_frames(Tonemapper& tonemapper, Shot& shot, const std::string& pattern,
                  const ExposureRequest& request, const Listener& listener) {
    const bool has_statistics = request.takes_sequence && tonemapper.takes_statistics();
    if (!request.rule && !has_statistics) return;
    const std::vector<int>& numbers = shot.numbers;
    std::vector<int> all = request.frames.empty() ? numbers : request.frames;
    const std::set<int> known(all.begin(), all.end());
    for (const int number : numbers) {
        if (known.contains(number)) continue;
        throw Error({.parameter = "meter_frames",
                     .value = format_frames(request.frames),
                     .expected = fmt::format("frame {} of <<frames>> in it", number)});
    }
    // If frames may be missing, the shot consists of the existing ones.
    if (request.leaves_out_missing) {
        std::erase_if(all, [&](int number) {
            return !std::filesystem::exists(frame_name("in", pattern, number));
        });
    }
    const MeteredShot metered = meter_shot(pattern, all, request.meter, listener);
    if (request.rule) warn_of_histograms(metered.pictures, *request.rule, listener);
    if (has_statistics) tonemapper = tonemapper.with_statistics(metered.statistics());
    if (!request.rule) return;
    const std::map<int, double> exposures =
        metered.exposures(*request.rule, request.meter.options.delta,
                          request.adaptation ? &*request.adaptation : nullptr);
    for (std::size_t i = 0; i < shot.frames.size(); ++i) {
        FrameFiles& frame = shot.frames[i];
        // A frame that took too long to meter is not tone mapped: if it were faster the second
        // time, it would have another frame's exposure.
        for (const MeteredPicture& picture : metered.pictures) {
            if (request.meter.work.timeout > 0 && picture.path == frame.in)
                frame.problem = picture.problem;
        }
        // A held frame also has the exposure of the frame before it. A frame that could not be
        // metered cannot be tone mapped either, and reports the same error.
        const auto after = exposures.upper_bound(numbers[i]);
        if (after != exposures.begin())
            frame.exposure_stops = request.exposure_stops + std::prev(after)->second;
    }
}

TONEWRIGHT_NAMESPACE_END
