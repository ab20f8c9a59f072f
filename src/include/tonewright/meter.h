// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/pipeline.h"
#include "tonewright/tonemap.h"

/// Metering: the luminance of a picture, the exposure that follows from it, and the exposure of a
/// shot over time.
///
/// Luminance is relative (0.2126, 0.7152, 0.0722), of Rec.709 light: channels are converted from
/// `input`; then negatives become 0. Light is measured before exposure, over the whole range of
/// floats. 1 is diffuse white; EV100 takes it as 1 cd/m2.
TONEWRIGHT_NAMESPACE_BEGIN

/// Defaults of MeterOptions.
inline constexpr double kMeterDelta = 1e-3;
inline constexpr int kMeterBins = 256;

/// Pixels and figures to measure.
struct MeterOptions {
    /// @see TonemapOptions::input
    std::string input = std::string(kAutoInput);
    /// @see TonemapOptions::input_units. Reference whites other than the default are accepted for
    /// all pictures.
    InputUnits input_units = InputUnits::relative;
    double reference_white = kUnitLuminance;
    /// @see TonemapOptions::unpremult. If alpha counts, pixels whose alpha is 0 or not finite are
    /// left out, unless all are.
    TonemapOptions::Unpremult unpremult = TonemapOptions::Unpremult::automatic;
    /// Options for reading a file.
    ReadOptions read = {};
    /// Pixels to measure, in the picture's coordinates. Default: the data window. Its channels are
    /// ignored.
    OIIO::ROI region = {};
    /// Added to every luminance inside the logarithm of the log average, [1e-10, 1]; also the least
    /// metered luminance.
    double delta = kMeterDelta;
    /// Limits of the histogram, log2 of luminance, [-64, 128]. Values outside count in the first
    /// and last bins.
    double histogram_min = -8;
    double histogram_max = 3.5;
    /// Adds bins of the same width at either end until at most 0.05 % of the pixels that are not
    /// black lie beyond it. Pictures within the limits get the same figures with and without it.
    /// Bins keep their places, so that the figures of a shot do not jump from frame to frame.
    bool grows_histogram = true;
    /// Bins between the limits, with that of black (below 1e-6), [3, 4096].
    int bins = kMeterBins;
    /// The histogram's average takes the pixels between these percentiles, without black, 0 <= low
    /// < high <= 100.
    double low_percentile = 0;
    double high_percentile = 100;
    /// Computes percentiles and the trimmed average from all luminances, not from bins. Takes 8
    /// bytes for each pixel.
    bool exact = false;
};

/// @throws Error  a number out of its interval, or an unknown space
TONEWRIGHT_API void check_meter_options(const MeterOptions& options);

/// The measured figures.
struct Metering {
    // Pixels of the region.
    std::uint64_t counted = 0;
    /// Counted pixels that are black.
    std::uint64_t black = 0;
    /// Pixels that are left out: with a NaN channel; with an infinite channel, but no NaN; with an
    /// alpha that is 0 or not finite.
    std::uint64_t nan = 0;
    std::uint64_t infinite = 0;
    std::uint64_t uncovered = 0;

    /// exp(mean ln(delta + L)). E. Reinhard et al., "Photographic Tone Reproduction for Digital
    /// Images", SIGGRAPH 2002, eq. 1, with 1/N inside. 0 if no pixel counts.
    double log_average = 0;
    /// exp(mean ln L) of the pixels that are not black.
    double geometric_mean = 0;
    double mean = 0;
    /// Over the pixels that are not black.
    double minimum = 0;
    double maximum = 0;

    /// Pixels in each bin. B. Opsenica, "Automatic Exposure Using a Luminance Histogram",
    /// bruop.github.io, 2019: bin 0 has luminances below 1e-6, bin i > 0 those with
    /// floor(clamp((log2 L - min)/(max - min)) * (bins - 2) + 1) = i.
    std::vector<std::uint64_t> histogram;
    /// Limits of that histogram: those of the options, or beyond them.
    double histogram_min = 0;
    double histogram_max = 0;
    /// Pixels that are not black, with luminances below and above those limits.
    std::uint64_t below_histogram = 0;
    std::uint64_t above_histogram = 0;
    /// 2^(mean of the bins' lower ends) over the pixels that are not black, between the
    /// percentiles; just below the lower limit if all are black. With MeterOptions::exact, from
    /// their luminances.
    double histogram_average = 0;
    /// kPercents of the pixels that are not black have a smaller luminance: linear in log2 within a
    /// bin, or exact. Empty if all are black.
    static constexpr double kPercents[] = {1, 5, 25, 50, 75, 95, 99};
    std::vector<double> percentiles;

    /// Share of the pixels that are not black and lie outside the histogram.
    [[nodiscard]] double share_outside() const {
        const std::uint64_t all = histogram.empty() ? 0 : counted - histogram[0];
        return all == 0 ? 0
                        : static_cast<double>(below_histogram + above_histogram) /
                              static_cast<double>(all);
    }

    /// Statistics of measure_scene(): NaN counts as 0, and infinities are limited.
    SceneStatistics scene;
    std::uint64_t scene_count = 0;
    std::uint64_t scene_lit_count = 0;
};

/// Measures a picture in one pass.
///
/// @param nthreads  0: OIIO's `threads` attribute. Threads and instruction sets change no bit of
///                  the result.
/// @throws Error    bad options; a picture that cannot be read, is deep, or has no color; a region
///                  outside the picture
[[nodiscard]] TONEWRIGHT_API Metering meter(const OIIO::ImageBuf& src,
                                            const MeterOptions& options = {}, int nthreads = 0);

/// The same for a file, with some rows in memory.
/// @throws FileError  @see read_image
/// @throws Error      as meter(), with the file's name.
[[nodiscard]] TONEWRIGHT_API Metering meter_file(const std::string& path,
                                                 const MeterOptions& options = {},
                                                 int nthreads = 0);

/// Statistics of all frames of a shot together, as if they were one picture.
[[nodiscard]] TONEWRIGHT_API SceneStatistics
statistics_of_sequence(const std::vector<Metering>& frames);

// ---------------------------------------------------------------------------------------------
// Exposure

/// log2(L S/K) with S = 100 and K = 12.5 (ISO 2720): the exposure value of a reflected-light meter.
[[nodiscard]] TONEWRIGHT_API double ev100(double luminance);

/// Computes an exposure from a metered luminance.
struct ExposureRule {
    enum class Method : unsigned char { log_average, histogram, mean, maximum };
    enum class Calibration : unsigned char {
        /// The metered luminance becomes `key`.
        key,
        /// Camera at EV100, saturating at 1.2 * 2^EV100 (78/(100 q), q = 0.65) = 9.6 L: the metered
        /// luminance becomes 1/9.6. S. Lagarde, C. de Rousiers, "Moving Frostbite to Physically
        /// Based Rendering", SIGGRAPH 2014 course.
        saturation,
    };
    Method method = Method::log_average;
    Calibration calibration = Calibration::key;
    /// [1e-3, 16]. Default: 0.18; with `maximum` 1, so that the brightest light is white.
    std::optional<double> key = {};
    /// Instead of `key`: 1.03 - 2/(2 + log10(L + 1)), which shows dark scenes darker. G. Krawczyk,
    /// K. Myszkowski, H.-P. Seidel, "Lightness Perception in Tone Reproduction for High Dynamic
    /// Range Images", Eurographics 2005, eq. 10.
    bool auto_key = false;
    /// Limits of the suggested exposure, in stops.
    double min_stops = -20;
    double max_stops = 20;
    /// Stops that are added after the limits.
    double compensation = 0;
};

/// `log-average`, `histogram`, `mean` or `max`.
/// @throws Error  for any other text, with the nearest name.
[[nodiscard]] TONEWRIGHT_API ExposureRule::Method parse_meter_method(std::string_view text);

/// @throws Error  a number out of its interval
TONEWRIGHT_API void check_exposure_rule(const ExposureRule& rule);

/// The luminance of a picture by a method; at least `delta`.
[[nodiscard]] TONEWRIGHT_API double metered_luminance(const Metering& metering,
                                                      ExposureRule::Method method,
                                                      double delta = kMeterDelta);

/// Exposure for a metered luminance, in stops, with compensation.
[[nodiscard]] TONEWRIGHT_API double suggested_exposure(double luminance, const ExposureRule& rule);

// ---------------------------------------------------------------------------------------------
// Adaptation over time

/// Adaptation of the exposure over the frames of a shot.
///
/// The adapted luminance A is 2^-stops. From frame to frame, dt seconds later, A += (target - A) s,
/// with s = 1 - e^(-speed dt) or 1 - 0.98^(30 speed dt).
struct Adaptation {
    enum class Form : unsigned char { exponential, power_098 };
    Form form = Form::exponential;
    /// Speed when the scene gets brighter, and darker, [0, 1000]: per second in the exponential
    /// form, a factor in the other. Default: 1.1 and 1.
    std::optional<double> up = {};
    std::optional<double> down = {};
    double fps = 24;
    /// Exposure of the first frame, stops. Default: its metered exposure.
    std::optional<double> start = {};
};

/// @throws Error  a number out of its interval
TONEWRIGHT_API void check_adaptation(const Adaptation& adaptation);

/// Exposures of the frames of a shot, in stops, without compensation.
/// @param frames   increasing frame numbers: dt is their difference divided by fps
/// @param targets  metered exposure of each frame, in stops
[[nodiscard]] TONEWRIGHT_API std::vector<double> adapted_exposures(
    const std::vector<int>& frames, const std::vector<double>& targets,
    const Adaptation& adaptation);

TONEWRIGHT_NAMESPACE_END
