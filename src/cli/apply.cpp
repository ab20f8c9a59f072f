// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <iterator>
#include <map>
#include <set>

#include "base/strings.h"
#include "cli/apply_frames.h"
#include "cli/command.h"
#include "cli/exposure_options.h"
#include "cli/frames.h"
#include "cli/lut_input.h"
#include "cli/picture_input.h"
#include "cli/progress_bar.h"
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

struct Options : ViewOptions {
    std::string in;
    std::string out;
    FrameOptions frames;
    std::string type;
    std::string statistics = "picture";
    bool is_false_color = false;
    bool dither = false;
    PictureInput picture;
    LutOptions lut;
    ExposureOptions metering;
    ShotOptions shot;

    [[nodiscard]] OIIO::TypeDesc pixel_type() const {
        return type.empty() ? OIIO::TypeDesc(OIIO::TypeUnknown) : parse_pixel_type(type);
    }
};

/// What the frames of a shot say before any of them is tone mapped: their exposures, the statistics
/// of all.
void meter_frames(Tonemapper& tonemapper, std::vector<FrameFiles>& frames,
                  const std::vector<int>& numbers, const Options& options,
                  const CLI::App& command) {
    const bool has_exposures = !options.metering.method.empty();
    const bool has_statistics = options.statistics == "sequence" && tonemapper.takes_statistics();
    if (!has_exposures && !has_statistics) return;
    const ExposureRule rule = has_exposures ? options.metering.rule() : ExposureRule{};
    const Adaptation adaptation = options.shot.adaptation(command);
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
        shot = meter_shot(options.in, all,
                          options.metering.meter_options(options.input, options.picture.alpha(),
                                                         options.picture.subimage),
                          options.shot.cache, options.picture.threads,
                          [&](std::size_t) { bar.add(true); });
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
double meter_exposure(const Options& options) {
    const ExposureRule rule = options.metering.rule();
    const MeteredPicture metered =
        meter_pictures({options.in},
                       options.metering.meter_options(options.input, options.picture.alpha(),
                                                      options.picture.subimage),
                       options.shot.cache, options.picture.threads)
            .front();
    if (metered.is_file_error) throw FileError(metered.error);
    if (!metered.error.empty()) throw Error(metered.error);
    return suggested_exposure(
        metered_luminance(metered.metering, rule.method, options.metering.delta), rule);
}

void apply_lut(const Options& options, const CLI::App& command) {
    Pipeline before = before_lut(command, options.lut, options, source_color({}, options.input));
    const LutFile lut = open_lut(options.lut.file, options.lut.interpolation);
    const OIIO::TypeDesc type = options.pixel_type();
    const QuietStderr quiet;
    const OIIO::ImageBuf source = read_image(options.in);
    if (!before.empty()) {
        before =
            before_lut(command, options.lut, options, source_color(source.spec(), options.input));
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
    if (!map_colors(result, source, map, options.picture.alpha(), {}, options.picture.threads))
        throw Error("apply: " + options.in + ": " + result.geterror());
    write_image_atomically(result, options.out, type);
}

}  // namespace

void add_apply(CLI::App& program, int& exit_code) {
    auto options = std::make_shared<Options>();
    CLI::App* command =
        program.add_subcommand("apply", "tone map a picture, or the frames of a shot");
    command->add_option("in", options->in, "picture, any format that OpenImageIO reads")
        ->required();
    command->add_option("out", options->out, "picture to write; the extension says the format")
        ->required();
    CLI::Option* op =
        command->add_option("--operator", options->op, "operator, or operator:preset");
    CLI::Option* false_color =
        command->add_flag("--false-color", options->is_false_color,
                          "where the light is: a color for every stop, the operator false_color");
    false_color->excludes(op);
    CLI::Option* frames = add_frame_options(*command, options->frames);
    options->input = kAutoInput;
    add_view_options(*command, *options);
    command->get_option("--input")->description(
        "what the input's numbers are: `auto`, what the picture says (`oiio:ColorSpace`, "
        "chromaticities, ...; linear Rec.709 where it says nothing), a scene-linear space, or "
        "sRGB, "
        "Rec709, Gamma2.2 or a display, whose code values are decoded");
    command->add_option("-d", options->type,
                        "pixel type of the output: uint8, uint16, half or float");
    command
        ->add_option("--statistics", options->statistics,
                     "parameters that a picture has (its largest luminance, ...) and --set does "
                     "not name: each `picture`'s own, those of the `sequence` of --frames, or "
                     "`defaults`")
        ->capture_default_str();
    add_picture_input(*command, options->picture);
    command->add_flag("--dither", options->dither,
                      "noise of half a code value against bands, in files of 8 bits; the same in "
                      "every frame");
    CLI::Option* metered = command
                               ->add_option("--auto-exposure", options->metering.method,
                                            "exposure from the picture's light: log-average, "
                                            "histogram, mean or max; --exposure comes on top")
                               ->group("Metering");
    add_exposure_options(*command, options->metering, metered);
    add_shot_options(*command, options->shot, frames, metered);
    add_lut_options(*command, options->lut, op,
                    {"--set", "--look", "--display", "--reference-white", "--statistics",
                     "--frames", "--false-color", "--auto-exposure", "--subimage", "--dither"});
    command->footer(
        "Examples:\n"
        "  tonewright apply render.exr out.png --operator hable --exposure 1 -d uint8\n"
        "  tonewright apply shot.%04d.exr out.####.png --frames 1001-1100 --operator agx_blender\n"
        "  tonewright apply in.@@@@.exr out.@@@@.png --frames 1-99x2 --operator hable "
        "--skip-existing\n"
        "  tonewright apply render.exr out.png --lut agx.cube --input-encoding acescct -d uint8");
    command->callback([options, command, &exit_code] {
        options->picture.use_threads();
        if (!options->lut.file.empty()) {
            apply_lut(*options, *command);
            return;
        }
        if (options->is_false_color) options->op = "false_color";
        if (options->op.empty()) {
            throw Error(
                "apply: operator is missing; expected --operator with an id of `tonewright list`, "
                "or --lut FILE");
        }
        TonemapOptions tonemap;
        tonemap.op = options->op;
        tonemap.settings = options->settings();
        tonemap.look = options->look;
        tonemap.exposure_stops = options->exposure;
        tonemap.input = options->input;
        tonemap.display = options->display;
        tonemap.reference_white = options->reference_white;
        tonemap.unpremult = options->picture.alpha();
        tonemap.dither = options->dither;
        tonemap.statistics = parse_statistics(options->statistics);
        for (const char* name : {"--meter-frames", "--meter-cache"}) {
            if (command->count(name) == 0 || command->count("--auto-exposure") > 0 ||
                options->statistics == "sequence") {
                continue;
            }
            throw Error(fmt::format(
                "apply: {} is {}; expected --auto-exposure or --statistics sequence with it", name,
                command->get_option(name)->as<std::string>()));
        }
        Tonemapper tonemapper(tonemap);  // a wrong name is told before a large file is read
        const OIIO::TypeDesc type = options->pixel_type();
        if (command->count("--frames") > 0) {
            const auto prepare = [&](std::vector<FrameFiles>& all,
                                     const std::vector<int>& numbers) {
                for (FrameFiles& frame : all)
                    frame.subimage = options->picture.subimage;
                meter_frames(tonemapper, all, numbers, *options, *command);
            };
            exit_code = apply_to_frames(tonemapper, options->in, options->out, options->frames,
                                        type, options->picture.threads, prepare);
            return;
        }
        if (options->statistics == "sequence")
            throw Error("apply: statistics is sequence; expected --frames with it");
        try {
            const QuietStderr quiet;
            if (!options->metering.method.empty()) {
                const double metered_stops = meter_exposure(*options);
                tonemapper = tonemapper.with_exposure(options->exposure + metered_stops);
            }
            tonemap_file(tonemapper, options->in, options->out, type, options->picture.threads,
                         options->picture.subimage);
        } catch (const FileError& e) {
            if (!is_frame_pattern(options->in)) throw;
            throw FileError(std::string(e.what()) + "; for the frames of a shot: --frames 1-100");
        }
    });
}

TONEWRIGHT_NAMESPACE_END
