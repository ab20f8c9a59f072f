// SPDX-License-Identifier: Apache-2.0
//
// Metering of pictures and files, the exposure that follows, and adaptation over the frames of a
// shot.
#include "tonewright/meter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "base/format_number.h"
#include "base/strings.h"
#include "image/converted_picture.h"
#include "image/picture_file.h"
#include "image/scene_meter.h"
#include "image/source_picture.h"
#include "image/spec_conversion.h"
#include "picture/picture_description.h"
#include "picture/source_pixels.h"
#include "tonewright/tonemap.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;

void check_number(const char* name, double value, double least, double most) {
    if (value >= least && value <= most) return;
    throw Error({.parameter = name,
                 .value = shortest(value),
                 .expected = fmt::format("[{}, {}]", shortest(least), shortest(most))});
}

ROI data_window(const ImageSpec& spec) {
    return {spec.x, spec.x + spec.width,
            spec.y, spec.y + spec.height,
            spec.z, spec.z + std::max(spec.depth, 1)};
}

ROI measured_window(const ImageSpec& spec, const MeterOptions& options) {
    const ROI window = data_window(spec);
    const ROI& r = options.region;
    if (!r.defined()) return window;
    ROI inside = window;
    inside.xbegin = std::max(r.xbegin, window.xbegin);
    inside.xend = std::min(r.xend, window.xend);
    inside.ybegin = std::max(r.ybegin, window.ybegin);
    inside.yend = std::min(r.yend, window.yend);
    inside.zbegin = std::max(r.zbegin, window.zbegin);
    inside.zend = std::min(r.zend, window.zend);
    return inside;
}

bool is_empty(const ROI& roi) { return roi.width() <= 0 || roi.height() <= 0 || roi.depth() <= 0; }

void require_pixels(const ImageSpec& spec, const MeterOptions& options) {
    if (!is_empty(measured_window(spec, options))) return;
    const ROI& r = options.region;
    throw Error({.parameter = "region",
                 .value = fmt::format("{},{},{},{} (x, y, width, height)", r.xbegin, r.ybegin,
                                      r.width(), r.height()),
                 .expected = fmt::format("some pixels of the picture, which is {},{},{},{}", spec.x,
                                         spec.y, spec.width, spec.height)});
}

/// Meters a whole picture in memory.
PicturePass pass_over(const ImageBuf& src, const MeterOptions& options) {
    return [&src, window = measured_window(src.spec(), options)](SceneMeter& meter) {
        if (!is_empty(window)) meter.add(src, window);
    };
}

}  // namespace

void check_meter_options(const MeterOptions& o) {
    (void)source_color({}, o.input);  // a wrong name
    check_number("reference_white", o.reference_white, 50, 1000);
    check_number("delta", o.delta, 1e-10, 1);
    check_number("histogram_min", o.histogram_min, -64, 128);
    check_number("histogram_max", o.histogram_max, -64, 128);
    check_number("bins", o.bins, 3, 4096);
    check_number("low_percentile", o.low_percentile, 0, 100);
    check_number("high_percentile", o.high_percentile, 0, 100);
    if (!(o.histogram_min < o.histogram_max)) {
        throw Error({.parameter = "histogram_min",
                     .value = shortest(o.histogram_min),
                     .expected = "less than its maximum " + shortest(o.histogram_max)});
    }
    if (!(o.low_percentile < o.high_percentile)) {
        throw Error({.parameter = "low_percentile",
                     .value = shortest(o.low_percentile),
                     .expected = "less than the high one, " + shortest(o.high_percentile)});
    }
}

SceneMeter measure_picture(const ImageSpec& spec, const MeterOptions& options,
                           SceneMeter::Figures figures, int nthreads, const PicturePass& pass) {
    SceneMeter meter(spec, options, SceneMeter::Cover::counts, figures, nthreads);
    pass(meter);
    if (meter.has_cover()) return meter;
    meter = SceneMeter(spec, options, SceneMeter::Cover::ignored, figures, nthreads);
    pass(meter);
    return meter;
}

namespace {

SceneMeter measure_whole(const ImageBuf& src, const MeterOptions& options,
                         SceneMeter::Figures figures, int nthreads) {
    const PictureSpec spec = described_spec(src);
    const SourceColor color = source_color(spec, options.input);
    if (color.convert)
        return measure_whole(converted_picture(src, color), options, figures, nthreads);
    return measure_picture(image_spec(spec), options, figures, nthreads, pass_over(src, options));
}

}  // namespace

/// Options that read the same light, at exposure 0.
static TonemapOptions tonemap_options(const MeterOptions& options) {
    TonemapOptions result;
    result.input = options.input;
    result.input_units = options.input_units;
    result.reference_white = options.reference_white;
    result.unpremult = options.unpremult;
    return result;
}

/// Reads the rows once, or twice if alpha must be ignored.
static SceneMeter measure_rows(PictureReader& reader, const MeterOptions& options,
                               SceneMeter::Figures figures, int nthreads, std::size_t batch_bytes) {
    reader.convert_colors(tonemap_options(options));
    const ImageSpec& spec = reader.spec();
    check_pixel_type("source", spec.format);
    const ROI window = measured_window(spec, options);
    return measure_picture(spec, options, figures, nthreads, [&](SceneMeter& meter) {
        if (spec.depth > 1) {
            const ImageBuf volume = reader.read_all();
            pass_over(volume, options)(meter);
            return;
        }
        if (is_empty(window)) return;
        const ImageSpec rows = image_spec(with_color_metadata_alone(picture_spec(spec)));
        const int step =
            rows_of_batch(spec.scanline_bytes(), reader.row_step(), spec.height, batch_bytes);
        std::vector<std::byte> pixels(spec.scanline_bytes() * static_cast<std::size_t>(step));
        // Batches begin at multiples of the step, because tiles are read as a whole.
        for (int y = spec.y + (window.ybegin - spec.y) / step * step; y < window.yend; y += step) {
            const int yend = std::min(y + step, spec.y + spec.height);
            reader.read_rows(y, yend, pixels.data());
            const ImageBuf part(spec_of_rows(rows, y, yend), pixels.data());
            ROI roi = window;
            roi.ybegin = std::max(y, window.ybegin);
            roi.yend = std::min(yend, window.yend);
            meter.add(part, roi);
        }
    });
}

SceneMeter measure_file(const std::string& path, const MeterOptions& options,
                        SceneMeter::Figures figures, int nthreads, std::size_t batch_bytes) {
    PictureReader reader(path, nthreads, options.read);
    return measure_rows(reader, options, figures, nthreads, batch_bytes);
}

MeterOptions meter_options(const TonemapOptions& options) {
    MeterOptions result;
    result.input = options.input;
    result.input_units = options.input_units;
    result.reference_white = options.reference_white;
    result.unpremult = options.unpremult;
    return result;
}

SceneStatistics measure_scene(const ImageBuf& src, const TonemapOptions& as, ROI roi,
                              int nthreads) {
    (void)source_color({}, as.input);  // reports a wrong name before it opens a picture
    check_source(src);
    MeterOptions options = meter_options(as);
    options.region = roi;
    return measure_whole(src, options, SceneMeter::Figures::statistics, nthreads).statistics();
}

SceneStatistics measure_scene(const ImageBuf& src, std::string_view input,
                              TonemapOptions::Unpremult unpremult, ROI roi, int nthreads) {
    TonemapOptions options;
    options.input = input;
    options.unpremult = unpremult;
    return measure_scene(src, options, roi, nthreads);
}

Metering meter(const ImageBuf& src, const MeterOptions& options, int nthreads) {
    check_meter_options(options);
    check_source(src);
    require_pixels(src.spec(), options);
    return measure_whole(src, options, SceneMeter::Figures::all, nthreads).metering();
}

Metering meter_file(const std::string& path, const MeterOptions& options, int nthreads) {
    check_meter_options(options);
    std::optional<PictureReader> reader;
    about_picture(path, [&] {
        reader.emplace(path, nthreads, options.read);
        report_header(picture_spec(reader->spec()), options.input, options.read);
    });
    try {
        require_pixels(reader->spec(), options);
    } catch (const Error& e) {
        throw Error(within(path, e.problem()));
    }
    return about_picture(path, [&] {
        return measure_rows(*reader, options, SceneMeter::Figures::all, nthreads, kBatchBytes)
            .metering();
    });
}

SceneStatistics statistics_of_sequence(const std::vector<Metering>& frames) {
    SceneStatistics all;
    double count = 0;
    double lit = 0;
    double log_sum = 0;
    all.minimum_luminance = std::numeric_limits<double>::infinity();
    for (const Metering& frame : frames) {
        if (frame.scene_lit_count == 0) {
            count += static_cast<double>(frame.scene_count);
            continue;
        }
        const SceneStatistics& s = frame.scene;
        const auto n = static_cast<double>(frame.scene_count);
        const auto n_lit = static_cast<double>(frame.scene_lit_count);
        count += n;
        lit += n_lit;
        log_sum += n_lit * std::log(s.log_average);
        all.mean_luminance += n * s.mean_luminance;
        all.minimum_luminance = std::min(all.minimum_luminance, s.minimum_luminance);
        all.maximum_luminance = std::max(all.maximum_luminance, s.maximum_luminance);
        for (std::size_t c = 0; c < 3; ++c) {
            all.mean_rgb[c] += n * s.mean_rgb[c];
            all.maximum_rgb[c] = std::max(all.maximum_rgb[c], s.maximum_rgb[c]);
        }
    }
    if (lit == 0) return {};
    all.log_average = std::exp(log_sum / lit);
    all.mean_luminance /= count;
    for (double& x : all.mean_rgb)
        x /= count;
    return all;
}

// ---------------------------------------------------------------------------------------------
// Exposure

double ev100(double luminance) {
    constexpr double kSpeed = 100;
    constexpr double kCalibration = 12.5;
    return std::log2(luminance * kSpeed / kCalibration);
}

ExposureRule::Method parse_meter_method(std::string_view text) {
    using Method = ExposureRule::Method;
    constexpr Method kMethods[] = {Method::log_average, Method::histogram, Method::mean,
                                   Method::maximum};
    return kMethods[find_choice("method", text, {"log-average", "histogram", "mean", "max"})];
}

void check_exposure_rule(const ExposureRule& rule) {
    if (rule.key) check_number("key", *rule.key, 1e-3, 16);
    check_number("min_stops", rule.min_stops, -40, 40);
    check_number("max_stops", rule.max_stops, -40, 40);
    check_number("compensation", rule.compensation, -20, 20);
    if (rule.min_stops > rule.max_stops) {
        throw Error({.parameter = "min_stops",
                     .value = shortest(rule.min_stops),
                     .expected = "no more than the upper one, " + shortest(rule.max_stops)});
    }
}

double metered_luminance(const Metering& metering, ExposureRule::Method method, double delta) {
    using Method = ExposureRule::Method;
    const double luminance = method == Method::log_average ? metering.log_average
                             : method == Method::histogram ? metering.histogram_average
                             : method == Method::mean      ? metering.mean
                                                           : metering.maximum;
    return std::max(luminance, delta);
}

double suggested_exposure(double luminance, const ExposureRule& rule) {
    double key = rule.method == ExposureRule::Method::maximum ? 1 : 0.18;
    if (rule.key) key = *rule.key;
    if (rule.auto_key) key = 1.03 - 2 / (2 + std::log10(luminance + 1));
    if (rule.calibration == ExposureRule::Calibration::saturation) key = 1 / 9.6;
    return std::clamp(std::log2(key / luminance), rule.min_stops, rule.max_stops) +
           rule.compensation;
}

// ---------------------------------------------------------------------------------------------
// Adaptation over time

void check_adaptation(const Adaptation& adaptation) {
    constexpr double kFastest = 1000;
    if (adaptation.up) check_number("adaptation speed up", *adaptation.up, 0, kFastest);
    if (adaptation.down) check_number("adaptation speed down", *adaptation.down, 0, kFastest);
    check_number("frames per second", adaptation.fps, 0.01, 10000);
    if (adaptation.start) check_number("starting exposure", *adaptation.start, -40, 40);
}

std::vector<double> adapted_exposures(const std::vector<int>& frames,
                                      const std::vector<double>& targets,
                                      const Adaptation& adaptation) {
    const bool is_exponential = adaptation.form == Adaptation::Form::exponential;
    // 0.98^(30 dt) is that of the DirectX SDK's HDR samples, 1.1 per second that of Opsenica.
    const double rate = is_exponential ? 1 : -30 * std::log(0.98);
    const double usual = is_exponential ? 1.1 : 1;
    std::vector<double> exposures;
    double adapted = 0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const double target = std::exp2(-targets[i]);
        if (i == 0) {
            adapted = adaptation.start ? std::exp2(-*adaptation.start) : target;
        } else {
            const double seconds =
                (static_cast<double>(frames[i]) - static_cast<double>(frames[i - 1])) /
                adaptation.fps;
            const double speed =
                (target > adapted ? adaptation.up : adaptation.down).value_or(usual);
            adapted += (target - adapted) * -std::expm1(-rate * speed * seconds);
        }
        exposures.push_back(-std::log2(adapted));
    }
    return exposures;
}

TONEWRIGHT_NAMESPACE_END
