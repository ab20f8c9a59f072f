// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <set>

#include "cli/command.h"
#include "cli/exposure_options.h"
#include "cli/frames.h"
#include "cli/lut_input.h"
#include "cli/picture_input.h"
#include "tonewright/engine.h"
#include "tonewright/image.h"

namespace tonewright {
namespace {

TonemapOptions::Statistics parse_statistics(const std::string& text) {
    if (text == "picture" || text == "sequence") return TonemapOptions::Statistics::from_picture;
    if (text == "defaults") return TonemapOptions::Statistics::defaults;
    const std::vector<std::string> names = {"picture", "sequence", "defaults"};
    throw Error("apply: statistics is " + text + "; expected " + join_choices(names) +
                did_you_mean(text, names));
}

/// How far it is, on a terminal only, from its first half second on.
class ProgressBar {
  public:
    /// @param terminal  a file descriptor, or -1
    ProgressBar(int terminal, std::size_t count)
        : terminal_(terminal >= 0 && ::isatty(terminal) ? terminal : -1), count_(count) {}
    ~ProgressBar() { show("\r\033[K"); }
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    void set(std::size_t done) {
        constexpr double kInterval = 0.1;
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
        if (terminal_ < 0 || seconds < next_) return;
        next_ = seconds + kInterval;
        constexpr std::size_t kWidth = 40;
        const std::size_t filled = kWidth * done / count_;
        const double left =
            seconds / static_cast<double>(done) * static_cast<double>(count_ - done);
        show(fmt::format("\r[{}{}] {}/{} frames, {:.1f} per second, {:.0f} s left\033[K",
                         std::string(filled, '#'), std::string(kWidth - filled, ' '), done, count_,
                         static_cast<double>(done) / seconds, left));
    }

  private:
    void show(const std::string& text) const {
        if (terminal_ >= 0 && next_ > kFirst) (void)!::write(terminal_, text.data(), text.size());
    }

    static constexpr double kFirst = 0.5;
    int terminal_;
    std::size_t count_;
    double next_ = kFirst;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

struct Options : ViewOptions {
    std::string in;
    std::string out;
    std::string frames;
    std::string type;
    std::string statistics = "picture";
    int threads = 0;
    bool unpremult = false;
    bool no_unpremult = false;
    LutOptions lut;
    ExposureOptions metering;
    ShotOptions shot;

    [[nodiscard]] TonemapOptions::Unpremult alpha() const {
        if (unpremult) return TonemapOptions::Unpremult::yes;
        if (no_unpremult) return TonemapOptions::Unpremult::no;
        return TonemapOptions::Unpremult::automatic;
    }
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
    const std::vector<int> all =
        options.shot.meter_frames.empty() ? numbers : parse_frames(options.shot.meter_frames);
    const std::set<int> metered(all.begin(), all.end());
    for (const int number : numbers) {
        if (metered.contains(number)) continue;
        throw Error(fmt::format("apply: --meter-frames is {}; expected frame {} of --frames in it",
                                options.shot.meter_frames, number));
    }
    MeteredShot shot;
    {
        const QuietStderr quiet;
        ProgressBar bar(quiet.before(), metered.size());
        shot = meter_shot(
            options.in, all, options.metering.meter_options(options.input, options.alpha()),
            options.shot.cache, options.threads, [&](std::size_t done) { bar.set(done); });
    }
    if (has_statistics) tonemapper = tonemapper.with_statistics(shot.statistics());
    if (!has_exposures) return;
    const std::map<int, double> exposures =
        shot.exposures(rule, options.metering.delta, options.shot.adapt ? &adaptation : nullptr);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        // One that could not be metered cannot be tone mapped either, which says why.
        const auto found = exposures.find(numbers[i]);
        if (found != exposures.end()) frames[i].exposure_stops = options.exposure + found->second;
    }
}

/// Every frame, whatever becomes of the others. @return the exit code
int apply_to_frames(Tonemapper& tonemapper, const Options& options, const CLI::App& command) {
    const std::string& in = options.in;
    const std::string& out = options.out;
    const std::vector<int> numbers = parse_frames(options.frames);
    const OIIO::TypeDesc type = options.pixel_type();
    const int threads = options.threads;
    std::vector<FrameFiles> frames;
    std::set<std::string> names;
    for (const int number : numbers) {
        frames.push_back({frame_name("in", in, number), frame_name("out", out, number)});
        if (!names.insert(frames.back().out).second)
            throw Error(fmt::format("apply: --frames names frame {} twice; expected once", number));
    }
    meter_frames(tonemapper, frames, numbers, options, command);
    {
        const QuietStderr quiet;
        ProgressBar bar(quiet.before(), frames.size());
        tonemap_files(
            tonemapper, frames, type, [&](std::size_t done) { bar.set(done); }, threads);
    }
    std::size_t failed = 0;
    int exit_code = kOk;
    for (const FrameFiles& frame : frames) {
        if (frame.error.empty()) continue;
        ++failed;
        exit_code = std::max<int>(exit_code, frame.is_file_error ? kFile : kUsage);
        fmt::print(stderr, "tonewright: apply: {}\n", frame.error);
    }
    if (failed > 0) {
        fmt::print(stderr, "tonewright: apply: {} of {} frames failed, {} written\n", failed,
                   frames.size(), frames.size() - failed);
    }
    return exit_code;
}

/// Of one picture, stops.
double meter_exposure(const Options& options) {
    const ExposureRule rule = options.metering.rule();
    const MeteredPicture metered =
        meter_pictures({options.in}, options.metering.meter_options(options.input, options.alpha()),
                       options.shot.cache, options.threads)
            .front();
    if (metered.is_file_error) throw FileError(metered.error);
    if (!metered.error.empty()) throw Error(metered.error);
    return suggested_exposure(
        metered_luminance(metered.metering, rule.method, options.metering.delta), rule);
}

void apply_lut(const Options& options, const CLI::App& command) {
    const Pipeline before = before_lut(command, options.lut, options);
    const LutFile lut = open_lut(options.lut.file, options.lut.interpolation);
    const SimdEngine encode(before);
    const OIIO::TypeDesc type = options.pixel_type();
    const QuietStderr quiet;
    const OIIO::ImageBuf source = read_image(options.in);
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
    if (!map_colors(result, source, map, options.alpha(), {}, options.threads))
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
    CLI::Option* frames = command->add_option(
        "--frames", options->frames,
        "frames such as 1001-1100, 1-9x2 (every second) or 1,5,10-20: `in` and `out` "
        "have %04d or #### (# is four digits, too) where the number stands");
    add_view_options(*command, *options);
    command->add_option("-d", options->type,
                        "pixel type of the output: uint8, uint16, half or float");
    command
        ->add_option("--statistics", options->statistics,
                     "parameters that a picture has (its largest luminance, ...) and --set does "
                     "not name: each `picture`'s own, those of the `sequence` of --frames, or "
                     "`defaults`")
        ->capture_default_str();
    command
        ->add_option(
            "--threads", options->threads,
            "threads that read, tone map and write; 0 = all cores, 1 = one after the other")
        ->capture_default_str()
        ->check(CLI::Range(0, 1024));
    CLI::Option* yes = command->add_flag(
        "--unpremult", options->unpremult,
        "divide color by alpha before, multiply after; default: as the picture says");
    command->add_flag("--no-unpremult", options->no_unpremult, "take color as it is")
        ->excludes(yes);
    CLI::Option* metered = command
                               ->add_option("--auto-exposure", options->metering.method,
                                            "exposure from the picture's light: log-average, "
                                            "histogram, mean or max; --exposure comes on top")
                               ->group("Metering");
    add_exposure_options(*command, options->metering, metered);
    add_shot_options(*command, options->shot, frames, metered);
    add_lut_options(*command, options->lut, op,
                    {"--set", "--look", "--display", "--reference-white", "--statistics",
                     "--frames", "--auto-exposure"});
    command->footer(
        "Examples:\n"
        "  tonewright apply render.exr out.png --operator hable --exposure 1 -d uint8\n"
        "  tonewright apply shot.%04d.exr out.####.png --frames 1001-1100 --operator agx_blender\n"
        "  tonewright apply render.exr out.png --lut agx.cube --input-encoding acescct -d uint8");
    command->callback([options, command, &exit_code] {
        OIIO::attribute("threads", options->threads);
        // OpenEXR has threads of its own; there, 0 is all cores and less is none.
        OIIO::attribute("exr_threads", options->threads == 1 ? -1 : options->threads);
        if (!options->lut.file.empty()) {
            apply_lut(*options, *command);
            return;
        }
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
        tonemap.unpremult = options->alpha();
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
            exit_code = apply_to_frames(tonemapper, *options, *command);
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
            tonemap_file(tonemapper, options->in, options->out, type, options->threads);
        } catch (const FileError& e) {
            if (!is_frame_pattern(options->in)) throw;
            throw FileError(std::string(e.what()) + "; for the frames of a shot: --frames 1-100");
        }
    });
}

}  // namespace tonewright
