// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tonewright/meter.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// How pictures are metered, and which exposure follows: of `apply` and `meter`.
struct ExposureOptions {
    /// Empty: no metering.
    std::string method;
    std::string region;
    double delta = MeterOptions{}.delta;
    std::string percentiles = "0,100";
    std::string histogram_range = "-8,3.5";
    int histogram_bins = MeterOptions{}.bins;
    bool exact = false;
    std::string key;
    std::string calibration = "key";
    double compensation = 0;
    std::string limits = "-20,20";

    /// @throws Error
    [[nodiscard]] MeterOptions meter_options(const std::string& input,
                                             TonemapOptions::Unpremult unpremult,
                                             int subimage) const;
    /// @throws Error
    [[nodiscard]] ExposureRule rule() const;
};

/// How the exposure of a shot follows its light.
struct ShotOptions {
    bool adapt = false;
    std::string form = "exponential";
    double up = 0;
    double down = 0;
    double fps = Adaptation{}.fps;
    double start = 0;
    std::string meter_frames;
    std::string cache;

    /// @throws Error
    [[nodiscard]] Adaptation adaptation(const CLI::App& command) const;
};

/// --delta, --percentiles, --key, ... and --meter-region.
/// @param method  the option that says how to meter, which they need; null: they need none.
void add_exposure_options(CLI::App& command, ExposureOptions& options, CLI::Option* method);
/// --adapt, --fps, ..., --meter-frames, --meter-cache.
/// @param method  what --adapt needs; null: nothing
void add_shot_options(CLI::App& command, ShotOptions& options, CLI::Option* frames,
                      CLI::Option* method);

/// One picture that was metered.
struct MeteredPicture {
    std::string path;
    Metering metering = {};
    /// What went wrong, in one line; empty: nothing.
    std::string error = {};
    bool is_file_error = false;
};

/// Meters files, several at the same time. What a cache has of a file that has not changed since
/// (size and time) and of the same options is not measured; what is measured, it has afterwards.
///
/// @param cache  file, or empty
/// @param done   called after each picture with the number that are done, from one thread at a time
/// @throws FileError  a cache that cannot be read or written, or is something else
[[nodiscard]] std::vector<MeteredPicture> meter_pictures(
    const std::vector<std::string>& paths, const MeterOptions& options, const std::string& cache,
    int threads, const std::function<void(std::size_t)>& done = {});

/// What a shot was metered for.
struct MeteredShot {
    std::vector<int> numbers;  // increasing
    std::vector<MeteredPicture> pictures;

    /// Throws the first error that a picture has.
    void require_all() const;
    [[nodiscard]] SceneStatistics statistics() const;
    /// Of every frame that could be metered, stops, compensation included.
    /// @param adaptation  null: each by itself; else all frames are required.
    [[nodiscard]] std::map<int, double> exposures(const ExposureRule& rule, double delta,
                                                  const Adaptation* adaptation) const;
};

/// @param frames  any order; of `pattern`
[[nodiscard]] MeteredShot meter_shot(const std::string& pattern, std::vector<int> frames,
                                     const MeterOptions& options, const std::string& cache,
                                     int threads,
                                     const std::function<void(std::size_t)>& done = {});

TONEWRIGHT_NAMESPACE_END
