// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "cli/picture_options.h"
#include "tonewright/meter.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Meaning of a picture's numbers. @see TonemapOptions
struct MeteredInput {
    std::string space;
    std::string units;
    double reference_white;
};
/// @throws Error
[[nodiscard]] MeterOptions meter_options_of(const ExposureOptions& options,
                                            const MeteredInput& input, const PictureInput& picture);
/// @throws Error
[[nodiscard]] ExposureRule rule_of(const ExposureOptions& options);
/// @throws Error
[[nodiscard]] Adaptation adaptation_of(const ShotOptions& options);

/// A metered picture.
struct MeteredPicture {
    std::string path;
    Metering metering = {};
    /// Why there is none, in the words of the command.
    std::optional<Problem> problem = {};
};

/// Meters files, several at the same time, with a timeout each in a process of its own. What a
/// cache has of a file that has not changed since (size and time) and of the same options is not
/// measured; what is measured, it has afterwards.
///
/// @param cache  file, or empty
/// @param done   called after each picture with the number that are done, from one thread at a time
/// @throws FileError  a cache that cannot be read or written, or is something else
[[nodiscard]] std::vector<MeteredPicture> meter_pictures(
    const std::vector<std::string>& paths, const MeterOptions& options, const std::string& cache,
    const PictureInput& input, const std::function<void(std::size_t)>& done = {});

/// A warning if more than 1 % of a metered picture lies outside the histogram; empty: none.
[[nodiscard]] std::string histogram_warning(const MeteredPicture& picture);
/// Prints those of pictures.
void warn_of_histograms(const std::vector<MeteredPicture>& pictures);

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

/// @param frames  any order; of `pattern`
[[nodiscard]] MeteredShot meter_shot(const std::string& pattern, std::vector<int> frames,
                                     const MeterOptions& options, const std::string& cache,
                                     const PictureInput& input,
                                     const std::function<void(std::size_t)>& done = {});

TONEWRIGHT_NAMESPACE_END
