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

/// Metering: how much light a picture has, which exposure that suggests, and how the exposure of a
/// shot follows its light.
///
/// Luminance is relative (0.2126, 0.7152, 0.0722) of Rec.709 light: channels limited to +-65504,
/// converted from `input`, negatives 0. 1 is diffuse white; EV100 takes it for 1 cd/m2.
TONEWRIGHT_NAMESPACE_BEGIN

/// What is measured of a picture, and where.
struct MeterOptions {
    /// @see TonemapOptions::input
    std::string input = std::string(kAutoInput);
    /// As in tonemap(). Where alpha counts, pixels without cover (alpha 0 or not finite) are left
    /// out, unless none has any.
    TonemapOptions::Unpremult unpremult = TonemapOptions::Unpremult::automatic;
    /// Of a file.
    int subimage = 0;
    /// Of a file. @see read_image
    double max_pixels = kMaxPixels;
    /// Pixels that count, in the picture's coordinates. Default: the data window. Channels of it
    /// are not read.
    OIIO::ROI region = {};
    /// Added to every luminance inside the logarithm of the log average, [1e-10, 1]; no metered
    /// luminance is below it.
    double delta = 1e-3;
    /// The histogram's limits, log2 of luminance, [-64, 16]. What is outside counts in its first
    /// and last bins.
    double histogram_min = -8;
    double histogram_max = 3.5;
    /// Bins, [3, 4096]; the first is black (below 1e-6).
    int bins = 256;
    /// Share of the pixels that are not black that the histogram's average leaves out below and
    /// takes in up to, percent, 0 <= low < high <= 100.
    double low_percentile = 0;
    double high_percentile = 100;
    /// Percentiles and the trimmed average are those of the luminances themselves, not of bins.
    /// Takes 8 bytes for each pixel.
    bool exact = false;
};

/// @throws Error  a number out of its interval, or an unknown space
TONEWRIGHT_API void check_meter_options(const MeterOptions& options);

/// What was measured.
struct Metering {
    // Pixels of the region.
    std::uint64_t counted = 0;
    /// Of those that count: without light.
    std::uint64_t black = 0;
    /// Left out: a channel of color is NaN; none is, but one is infinite; without cover.
    std::uint64_t nan = 0;
    std::uint64_t infinite = 0;
    std::uint64_t uncovered = 0;

    /// exp(mean ln(delta + L)). E. Reinhard et al., "Photographic Tone Reproduction for Digital
    /// Images", SIGGRAPH 2002, eq. 1, with 1/N inside. 0 where no pixel counts.
    double log_average = 0;
    /// exp(mean ln L) of the pixels that are not black.
    double geometric_mean = 0;
    double mean = 0;
    /// Of the pixels that are not black.
    double minimum = 0;
    double maximum = 0;

    /// Pixels in each bin. B. Opsenica, "Automatic Exposure Using a Luminance Histogram",
    /// bruop.github.io, 2019: bin 0
    /// has luminances below 1e-6, bin i > 0 those with floor(clamp((log2 L - min)/(max - min)) *
    /// (bins - 2) + 1) = i.
    std::vector<std::uint64_t> histogram;
    /// 2^(mean of the bins' lower ends) over the pixels that are not black, between the
    /// percentiles; a picture without such pixels: just below the lower limit. MeterOptions::exact:
    /// of their luminances.
    double histogram_average = 0;
    /// Luminance below which kPercents of the pixels that are not black are: linear in log2 within
    /// a bin, or exact. Empty where all is black.
    static constexpr double kPercents[] = {1, 5, 25, 50, 75, 95, 99};
    std::vector<double> percentiles;

    /// As measure_scene() has it: there NaN is 0 and infinities are limited, and they count.
    SceneStatistics scene;
    std::uint64_t scene_count = 0;
    std::uint64_t scene_lit_count = 0;
};

/// One pass over a picture.
///
/// @param nthreads  0: OIIO's `threads` attribute. The result does not depend on it, nor on the
///                  instruction set, in any bit.
/// @throws Error    bad options; a picture that cannot be read, is deep, or has no color; a region
///                  beside it.
[[nodiscard]] TONEWRIGHT_API Metering meter(const OIIO::ImageBuf& src,
                                            const MeterOptions& options = {}, int nthreads = 0);

/// The same of a file, in the memory of some rows.
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

/// From what was measured to an exposure.
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
    /// [1e-3, 16]. Default: 0.18; of `maximum` 1, so that the brightest light is white.
    std::optional<double> key = {};
    /// Instead: 1.03 - 2/(2 + log10(L + 1)), darker pictures of darker scenes. G. Krawczyk, K.
    /// Myszkowski, H.-P. Seidel, "Lightness Perception in Tone Reproduction for High Dynamic Range
    /// Images", Eurographics 2005, eq. 10.
    bool auto_key = false;
    /// Stops between which what is suggested stays.
    double min_stops = -20;
    double max_stops = 20;
    /// Stops that are added after those limits.
    double compensation = 0;
};

/// `log-average`, `histogram`, `mean` or `max`.
/// @throws Error  for any other text, with the nearest name.
[[nodiscard]] TONEWRIGHT_API ExposureRule::Method parse_meter_method(std::string_view text);

/// @throws Error  a number out of its interval
TONEWRIGHT_API void check_exposure_rule(const ExposureRule& rule);

/// The luminance that a method takes of a picture; no less than `delta`.
[[nodiscard]] TONEWRIGHT_API double metered_luminance(const Metering& metering,
                                                      ExposureRule::Method method,
                                                      double delta = MeterOptions{}.delta);

/// Exposure of a metered luminance in stops, compensation included.
[[nodiscard]] TONEWRIGHT_API double suggested_exposure(double luminance, const ExposureRule& rule);

// ---------------------------------------------------------------------------------------------
// Adaptation over time

/// How the exposure of a shot follows its light.
///
/// What adapts is the luminance A that the exposure is made for, 2^-stops: from frame to frame, dt
/// seconds later, A += (target - A) s, s = 1 - e^(-speed dt) or 1 - 0.98^(30 speed dt).
struct Adaptation {
    enum class Form : unsigned char { exponential, power_098 };
    Form form = Form::exponential;
    /// Towards more light, and towards less. [0, 1000]; per second in the exponential form, a
    /// factor in the other. Defaults: 1.1, and 1.
    std::optional<double> up = {};
    std::optional<double> down = {};
    double fps = 24;
    /// Exposure of the first frame, stops. Default: what the first frame suggests.
    std::optional<double> start = {};
};

/// @throws Error  a number out of its interval
TONEWRIGHT_API void check_adaptation(const Adaptation& adaptation);

/// Exposures of the frames of a shot, in stops, without compensation.
/// @param frames   numbers, increasing: dt is their difference over fps
/// @param targets  what each frame suggests by itself, in stops
[[nodiscard]] TONEWRIGHT_API std::vector<double> adapted_exposures(
    const std::vector<int>& frames, const std::vector<double>& targets,
    const Adaptation& adaptation);

TONEWRIGHT_NAMESPACE_END
