// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "base/strings.h"
#include "cli/lut_input.h"
#include "cli/pictures/apply_frames.h"
#include "cli/pictures/commands.h"
#include "cli/pictures/frames.h"
#include "cli/pictures/metering.h"
#include "cli/pictures/picture_input.h"
#include "cli/pictures/progress_bar.h"
#include "image/source_picture.h"
#include "tonewright/engine.h"
#include "tonewright/image_io.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TonemapOptions::Statistics parse_statistics(const std::string& text) {
    if (text == "picture" || text == "sequence") return TonemapOptions::Statistics::from_picture;
    if (text == "defaults") return TonemapOptions::Statistics::defaults;
    const std::vector<std::string> names = {"picture", "sequence", "defaults"};
    throw Error("apply: statistics is " + text + "; expected " + join_choices(names) +
                did_you_mean(text, names));
}

OIIO::TypeDesc pixel_type_of(const ApplyOptions& options) {
    return options.type.empty() ? OIIO::TypeDesc(OIIO::TypeUnknown)
                                : parse_pixel_type(options.type);
}

/// What the frames of a shot say before any of them is tone mapped: their exposures, the statistics
/// of all.
void meter_frames(Tonemapper& tonemapper, std::vector<FrameFiles>& frames,
                  const std::vector<int>& numbers, const ApplyOptions& options) {
    const bool has_exposures = !options.metering.method.empty();
    const bool has_statistics = options.statistics == "sequence" && tonemapper.takes_statistics();
    if (!has_exposures && !has_statistics) return;
    const ExposureRule rule = has_exposures ? rule_of(options.metering) : ExposureRule{};
    const Adaptation adaptation = adaptation_of(options.shot);
    std::vector<int> all =
        options.shot.meter_frames.empty() ? numbers : parse_frames(options.shot.meter_frames);
    const std::set<int> metered(all.begin(), all.end());
    for (const int number : numbers) {
        if (metered.contains(number)) continue;
        throw Error(fmt::format("apply: --meter-frames is {}; expected frame {} of --frames in it",
                                options.shot.meter_frames, number));
    }
    // Where frames may be missing, the shot is those that are there.
    if (options.frames.missing != "error") {
        std::erase_if(all, [&](int number) {
            return !std::filesystem::exists(frame_name("in", options.in, number));
        });
    }
    MeteredShot shot;
    {
        const QuietStderr quiet;
        ProgressBar bar(quiet.before(), metered.size());
        shot = meter_shot(
            options.in, all, meter_options_of(options.metering, options.input, options.picture),
            options.shot.cache, options.picture.threads, [&](std::size_t) { bar.add(true); });
    }
    if (has_statistics) tonemapper = tonemapper.with_statistics(shot.statistics());
    if (!has_exposures) return;
    const std::map<int, double> exposures =
        shot.exposures(rule, options.metering.delta, options.shot.adapt ? &adaptation : nullptr);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        // A missing frame that is held has the exposure of the one before, too. One that could not
        // be metered cannot be tone mapped either, which says why.
        const auto after = exposures.upper_bound(numbers[i]);
        if (after != exposures.begin())
            frames[i].exposure_stops = options.exposure + std::prev(after)->second;
    }
}

/// Of one picture, stops.
double meter_exposure(const ApplyOptions& options) {
    const ExposureRule rule = rule_of(options.metering);
    const MeteredPicture metered =
        meter_pictures({options.in},
                       meter_options_of(options.metering, options.input, options.picture),
                       options.shot.cache, options.picture.threads)
            .front();
    if (metered.is_file_error) throw FileError(metered.error);
    if (!metered.error.empty()) throw Error(metered.error);
    return suggested_exposure(
        metered_luminance(metered.metering, rule.method, options.metering.delta), rule);
}

void apply_lut(const ApplyOptions& options) {
    Pipeline before = before_lut("apply", options.lut, options, source_color({}, options.input));
    const LutFile lut = open_lut(options.lut.file, options.lut.interpolation, load_lut_picture);
    const OIIO::TypeDesc type = pixel_type_of(options);
    const QuietStderr quiet;
    const OIIO::ImageBuf source = read_image(options.in);
    if (!before.empty()) {
        before =
            before_lut("apply", options.lut, options, source_color(source.spec(), options.input));
    }
    const SimdEngine encode(before);
    OIIO::ImageBuf result;
    const auto map = [&](const float* in, float* out, std::size_t count) {
        if (before.empty()) {
            lut.run_rgb(in, out, count);
            return;
        }
        std::vector<float> code(3 * count);
        encode.run_rgb(in, code.data(), count);
        lut.run_rgb(code.data(), out, count);
    };
    if (!map_colors(result, source, map, alpha_of(options.picture), {}, options.picture.threads))
        throw Error("apply: " + options.in + ": " + result.geterror());
    write_image_atomically(result, options.out, type);
}

}  // namespace

int run_apply(const ApplyOptions& options) {
    use_threads(options.picture);
    if (!options.lut.file.empty()) {
        apply_lut(options);
        return kOk;
    }
    const std::string op = options.is_false_color ? "false_color" : options.op;
    if (op.empty()) {
        throw Error(
            "apply: operator is missing; expected --operator with an id of `tonewright list`, "
            "or --lut FILE");
    }
    TonemapOptions tonemap;
    tonemap.op = op;
    tonemap.settings = options.settings();
    tonemap.look = options.look;
    tonemap.exposure_stops = options.exposure;
    tonemap.input = options.input;
    tonemap.display = options.display;
    tonemap.reference_white = options.reference_white;
    tonemap.unpremult = alpha_of(options.picture);
    tonemap.dither = options.dither;
    tonemap.statistics = parse_statistics(options.statistics);
    const bool is_metered =
        options.given.contains("--auto-exposure") || options.statistics == "sequence";
    for (const auto& [name, value] : {std::pair("--meter-frames", options.shot.meter_frames),
                                      std::pair("--meter-cache", options.shot.cache)}) {
        if (is_metered || !options.given.contains(name)) continue;
        throw Error(fmt::format(
            "apply: {} is {}; expected --auto-exposure or --statistics sequence with it", name,
            value));
    }
    Tonemapper tonemapper(tonemap);  // a wrong name is told before a large file is read
    const OIIO::TypeDesc type = pixel_type_of(options);
    if (options.given.contains("--frames")) {
        const auto prepare = [&](std::vector<FrameFiles>& all, const std::vector<int>& numbers) {
            for (FrameFiles& frame : all)
                frame.subimage = options.picture.subimage;
            meter_frames(tonemapper, all, numbers, options);
        };
        return apply_to_frames(tonemapper, options.in, options.out, options.frames, type,
                               options.picture.threads, prepare);
        return kOk;
    }
    if (options.statistics == "sequence")
        throw Error("apply: statistics is sequence; expected --frames with it");
    try {
        const QuietStderr quiet;
        if (!options.metering.method.empty()) {
            const double metered_stops = meter_exposure(options);
            tonemapper = tonemapper.with_exposure(options.exposure + metered_stops);
        }
        tonemap_file(tonemapper, options.in, options.out, type, options.picture.threads,
                     options.picture.subimage);
    } catch (const FileError& e) {
        if (!is_frame_pattern(options.in)) throw;
        throw FileError(std::string(e.what()) + "; for the frames of a shot: --frames 1-100");
    }
    return kOk;
}

TONEWRIGHT_NAMESPACE_END
