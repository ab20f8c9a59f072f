// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tasks/json.h"
#include "tasks/listener.h"
#include "tasks/pictures/contained.h"
#include "tasks/pictures/frames.h"
#include "tonewright/meter.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// An exposure from a metered luminance.
struct Suggestion {
    double luminance = 0;
    double ev100 = 0;
    double stops = 0;  // with compensation
};
/// @param delta  MeterOptions::delta
[[nodiscard]] Suggestion suggest_exposure(const Metering& metering, const ExposureRule& rule,
                                          double delta);

/// Metering of files.
struct MeterRequest {
    MeterOptions options;
    /// File that keeps the figures: a picture that has the same size and time as in the cache is
    /// not metered again with the same options. Empty: none.
    std::string cache = {};
    PictureWork work = {};
};

/// A metered picture.
struct MeteredPicture {
    std::string path;
    Metering metering = {};
    /// Why there is no metering.
    std::optional<Problem> problem = {};
};

/// Meters files, several at the same time, with a timeout each in a process of its own.
/// @param listener  its `progress` is called after each picture, from one thread at a time
/// @throws FileError  a cache that cannot be read or written, or is something else
[[nodiscard]] std::vector<MeteredPicture> meter_pictures(const std::vector<std::string>& paths,
                                                         const MeterRequest& request,
                                                         const Listener& listener = {});

/// A warning if more than 1 % of a metered picture lies outside the histogram; empty: none.
[[nodiscard]] std::string histogram_warning(const MeteredPicture& picture);
/// Passes those warnings on if the exposure comes from histograms.
void warn_of_histograms(const std::vector<MeteredPicture>& pictures, const ExposureRule& rule,
                        const Listener& listener);

/// Exposures and statistics of a metered shot.
struct MeteredShot {
    std::vector<int> numbers;  // increasing
    std::vector<MeteredPicture> pictures;

    /// Throws the first error of a picture.
    void require_all() const;
    [[nodiscard]] SceneStatistics statistics() const;
    /// Exposures of all metered frames, in stops, with compensation.
    /// @param adaptation  null: each frame separately; otherwise all frames are required
    [[nodiscard]] std::map<int, double> exposures(const ExposureRule& rule, double delta,
                                                  const Adaptation* adaptation) const;
};

/// A metered picture, or a metered frame of a shot.
struct MeteredFrame {
    MeteredPicture picture;
    std::optional<int> number = {};
    std::optional<double> adapted = {};  // stops
};
/// @param adaptation  null: the frames have no adapted exposures
/// @throws Error  the problem of a picture that the adaptation needs
[[nodiscard]] std::vector<MeteredFrame> frames_of(const MeteredShot& shot, const ExposureRule& rule,
                                                  double delta, const Adaptation* adaptation);

/// Names of a metering method: that of parse_meter_method(), and in words.
struct MeterMethodNames {
    ExposureRule::Method method;
    const char* name;
    const char* title;
};
inline constexpr std::array<MeterMethodNames, 4> kMeterMethods = {
    {{ExposureRule::Method::log_average, "log-average", "log average"},
     {ExposureRule::Method::histogram, "histogram", "histogram"},
     {ExposureRule::Method::mean, "mean", "mean"},
     {ExposureRule::Method::maximum, "max", "maximum"}}};

/// All figures, with the exposures that all methods suggest; or the problem.
/// @param style  of the parameters that the problem names
[[nodiscard]] Json to_json(const MeteredFrame& metered, const ExposureRule& rule, double delta,
                           const MessageStyle& style);

/// @param frames  any order; of `pattern`
[[nodiscard]] MeteredShot meter_shot(const std::string& pattern, std::vector<int> frames,
                                     const MeterRequest& request, const Listener& listener = {});

/// Exposures from metering before pictures are tone mapped.
struct ExposureRequest {
    MeterRequest meter;
    /// None: no exposure.
    std::optional<ExposureRule> rule = {};
    /// Added to the metered exposure.
    double exposure_stops = 0;
    // Shots alone.
    std::optional<Adaptation> adaptation = {};
    /// Operators take the statistics of all metered frames together.
    bool takes_sequence = false;
    /// Frames of the whole shot. Empty: those that are tone mapped.
    std::vector<int> frames = {};
    /// Meters frames that exist, and no others.
    bool leaves_out_missing = false;
};

/// Sets the exposure of each file from its own metering, which needs a rule. With a timeout, files
/// that cannot be metered get their problem.
/// @throws FileError  the only file cannot be metered
std::vector<MeteredPicture> meter_files(std::vector<FrameFiles>& files,
                                        const ExposureRequest& request,
                                        const Listener& listener = {});

/// Meters a shot and sets the exposures of its frames and the tonemapper's statistics. With a
/// timeout, frames that cannot be metered get their problem.
/// @param pattern  of the input frames. @see frame_name
/// @throws Error  a frame is none of those that are metered; one cannot be metered although
///                statistics or adaptation need it
void meter_frames(Tonemapper& tonemapper, Shot& shot, const std::string& pattern,
                  const ExposureRequest& request, const Listener& listener = {});

TONEWRIGHT_NAMESPACE_END
