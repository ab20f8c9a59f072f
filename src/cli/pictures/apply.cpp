// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "cli/elapsed_line.h"
#include "cli/lut_input.h"
#include "cli/messages.h"
#include "cli/pictures/apply_frames.h"
#include "cli/pictures/commands.h"
#include "cli/pictures/frames.h"
#include "cli/pictures/input_files.h"
#include "cli/pictures/legend.h"
#include "cli/pictures/metering.h"
#include "cli/pictures/picture_input.h"
#include "cli/pictures/progress_bar.h"
#include "cli/pictures/standard_streams.h"
#include "image/color_tags.h"
#include "image/picture_file.h"
#include "image/resize.h"
#include "image/source_picture.h"
#include "image/tonemap_file.h"
#include "tonewright/engine.h"
#include "tonewright/image_io.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TonemapOptions::Statistics parse_statistics(const std::string& text) {
    return find_choice("apply: --statistics", text, {"picture", "sequence", "defaults"}) < 2
               ? TonemapOptions::Statistics::from_picture
               : TonemapOptions::Statistics::defaults;
}

/// True if color is un-premultiplied first, as far as the picture's alpha is associated.
bool keeps_cover(const ApplyOptions& options) {
    return options.alpha != "ignore" && options.alpha != "opaque";
}

/// @throws Error  the file name cannot have this output; checked before a large picture is read
WriteOptions write_options_of(const ApplyOptions& options, const std::string& out) {
    WriteOptions write;
    if (!options.type.empty()) set_pixel_type(write, options.type);
    set_alpha(write, options.alpha);
    if (!keeps_cover(options) && options.picture.unpremult) {
        throw Error(fmt::format(
            "apply: --alpha is {}; expected keep with --unpremult, which divides by alpha",
            options.alpha));
    }
    write.compression = options.compression;
    write.quality = options.quality;
    write.subsampling = options.subsampling;
    write.verifies = options.verifies_output;
    if (options.picture.max_pixels) write.max_pixels = *options.picture.max_pixels;
    write.write_provenance = !options.has_no_metadata;
    if (write.bits > 0 || options.given.contains("--compression") ||
        options.given.contains("--quality") || options.given.contains("--subsampling"))
        (void)PictureWriter(out, write);
    return write;
}

/// Without alpha, color is taken as it is.
TonemapOptions::Unpremult alpha_of(const ApplyOptions& options) {
    return keeps_cover(options) ? alpha_of(options.picture) : TonemapOptions::Unpremult::no;
}

/// For metering, which uses the same colors.
PictureInput picture_of(const ApplyOptions& options) {
    PictureInput picture = options.picture;
    if (!keeps_cover(options)) picture.no_unpremult = true;
    return picture;
}

MeterOptions meter_options_of(const ApplyOptions& options) {
    MeterOptions result = meter_options_of(
        options.metering, {options.input, options.input_units, options.reference_white},
        picture_of(options));
    result.read.resize = options.resize;
    return result;
}

/// A frame that took too long to meter is not tone mapped: if it were faster the second time, it
/// would have another frame's exposure.
void take_error(const MeteredShot& shot, FrameFiles& frame) {
    for (const MeteredPicture& picture : shot.pictures) {
        if (picture.path == frame.in) frame.problem = picture.problem;
    }
}

/// Results of metering a shot before tone mapping: exposures of the frames, statistics of all.
void meter_frames(Tonemapper& tonemapper, std::vector<FrameFiles>& frames,
                  const std::vector<int>& numbers, const ApplyOptions& options) {
    const bool has_exposures = !options.metering.method.empty();
    const bool has_statistics =
        is_same_name(options.statistics, "sequence") && tonemapper.takes_statistics();
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
    // If frames may be missing, the shot consists of the existing ones.
    if (options.frames.missing != "error") {
        std::erase_if(all, [&](int number) {
            return !std::filesystem::exists(frame_name("in", options.in, number));
        });
    }
    MeteredShot shot;
    {
        const QuietStderr quiet;
        ProgressBar bar(quiet.before(), metered.size());
        shot = meter_shot(options.in, all, meter_options_of(options), options.shot.cache,
                          options.picture, [&](std::size_t) { bar.add(true); });
    }
    if (has_exposures && rule.method == ExposureRule::Method::histogram)
        warn_of_histograms(shot.pictures);
    if (has_statistics) tonemapper = tonemapper.with_statistics(shot.statistics());
    if (!has_exposures) return;
    const std::map<int, double> exposures =
        shot.exposures(rule, options.metering.delta, options.shot.adapt ? &adaptation : nullptr);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        if (options.picture.timeout > 0) take_error(shot, frames[i]);
        // A held frame also has the exposure of the frame before it. A frame that could not be
        // metered cannot be tone mapped either, and reports the same error.
        const auto after = exposures.upper_bound(numbers[i]);
        if (after != exposures.begin())
            frames[i].exposure_stops = options.exposure + std::prev(after)->second;
    }
}

/// Each picture separately.
/// @returns  the pictures whose exposure comes from a histogram
/// @throws  the first error, if there is one picture only
std::vector<MeteredPicture> meter_each(std::vector<FrameFiles>& files,
                                       const ApplyOptions& options) {
    if (options.metering.method.empty()) return {};
    const ExposureRule rule = rule_of(options.metering);
    std::vector<std::string> paths;
    paths.reserve(files.size());
    for (const FrameFiles& file : files)
        paths.push_back(file.in);
    std::vector<MeteredPicture> metered =
        meter_pictures(paths, meter_options_of(options), options.shot.cache, options.picture);
    for (std::size_t i = 0; i < files.size(); ++i) {
        // If there are several, tone mapping reports the reason.
        if (files.size() == 1 && metered[i].problem) throw_problem(*metered[i].problem);
        if (options.picture.timeout > 0) files[i].problem = metered[i].problem;
        if (metered[i].problem) continue;
        files[i].exposure_stops =
            options.exposure +
            suggested_exposure(
                metered_luminance(metered[i].metering, rule.method, options.metering.delta), rule);
    }
    if (rule.method != ExposureRule::Method::histogram) return {};
    return metered;
}

/// @param light  exposure, input, units and alpha of the picture
OIIO::ImageBuf resized(const OIIO::ImageBuf& source, const ApplyOptions& options,
                       const std::string& path, const TonemapOptions& light) {
    return about_picture(path, [&] {
        return resized_picture(source, options.resize, light,
                               options.picture.max_pixels.value_or(kMaxPixels),
                               options.picture.threads);
    });
}

/// @param stated  the input that the LUT states; the first picture finds it, and says so
void apply_lut(const ApplyOptions& options, const LutFile& lut, const FrameFiles& file,
               std::optional<LutOptions>& stated) {
    WriteOptions write = write_options_of(options, file.out);
    Warnings warnings(file.out);
    write.warn = [hear = warnings.hearer()](const std::string& text) {
        // The LUT decides the display.
        const MessageStyle style = {
            .setting = [](std::string_view parameter, std::string_view value) {
                const std::string option = command_style().setting(parameter, value);
                return parameter == "display" ? "a LUT that is baked with " + option : option;
            }};
        hear(render(text, style));
    };
    OIIO::ImageBuf source = read_picture(file.in, options.picture, options.input);
    SourceColor color = about_picture(file.in, [&] {
        (void)channel_layout(source.spec());
        return source_color(source.spec(), options.input);
    });
    std::string name = color.name;
    if (!options.resize.empty()) {
        TonemapOptions light;
        light.input = options.input;
        light.exposure_stops = options.exposure;
        light.reference_white = options.reference_white;
        light.input_units = parse_input_units(options.input_units);
        light.unpremult = alpha_of(options);
        source = resized(source, options, file.in, light);
        color = source_color(source.spec(), options.input);
    } else if (color.convert) {
        source = converted_picture(source, color);
        color = source_color(source.spec(), kAutoInput);
        name = color.name;
    }
    if (!stated) stated = with_stated_input(options.lut, name);
    const Pipeline before = before_lut("apply", *stated, options, color);
    auto quiet = std::make_optional<QuietStderr>();
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
    if (!map_colors(result, source, map, alpha_of(options), {}, options.picture.threads))
        throw FileError(file.in + ": " + first_line(result.geterror()));
    if (const std::optional<std::string> display = stated_display(options.lut))
        tag_as_shown_on(*display, result.specmod());
    if (write.write_provenance) {
        const std::string lut_name = std::filesystem::path(options.lut.file).filename().string();
        const std::string size = options.resize.empty() ? "" : ", resize " + options.resize;
        result.specmod().attribute(
            "Software", fmt::format("Tonewright {}: LUT {}{}", TONEWRIGHT_VERSION, lut_name, size));
    }
    write_image_atomically(result, file.out, write);
    quiet.reset();
    warnings.print();
}

int apply_lut(const ApplyOptions& options, ApplyFiles& files) {
    // Reports wrong options before a picture is read.
    check_lut_options("apply", options.lut, options, source_color({}, options.input));
    const LutFile lut = with_memory_for(options.lut.file, [&] {
        return open_lut(options.lut.file, options.lut.interpolation, load_lut_picture);
    });
    (void)write_options_of(options, files.files.front().out);
    check_overwriting(files.files, options.is_in_place);
    std::optional<LutOptions> stated;
    if (files.is_single) {
        apply_lut(options, lut, files.files.front(), stated);
        return kOk;
    }
    require_writable_folder(options.output);
    int exit_code = kOk;
    for (FrameFiles& file : files.files) {
        try {
            apply_lut(options, lut, file, stated);
        } catch (const Error& e) {
            if (e.problem().kind == Problem::Kind::check) throw;  // --strict
            print_message("apply: " + render(e.problem(), command_style()));
            exit_code = kCheckFailed;
        }
    }
    return exit_code;
}

/// "render.exr (640 x 360 half, lin_rec709) -> out.png: AgX (agx_blender), exposure +1, sRGB,
/// 0.12 s"
/// @param header  none: another process tone mapped the picture, or it has a legend
void print_result(const FrameFiles& file, const Tonemapper& tonemapper, const ApplyOptions& given,
                  const std::optional<OIIO::ImageSpec>& header, const ResultLine& line) {
    if (!says_what_was_done()) return;
    const TonemapOptions& options = tonemapper.options();
    const ResolvedOperator& op = options.op;
    const OIIO::ImageSpec spec =
        header ? *header : PictureReader(file.in, 1, read_options_of(given.picture)).spec();
    const PictureDescription said = describe_picture(spec, options.input);
    std::string text =
        fmt::format("apply: {} ({} x {} {}, {} by {}) -> {}: {} ({}), exposure {:+.3g}, display {}",
                    file.in, spec.width, spec.height, spec.format.c_str(), said.color.name,
                    said.rule, file.out, op.op->view, operator_text(op),
                    file.exposure_stops.value_or(options.exposure_stops), options.display);
    if (!given.resize.empty()) {
        const OIIO::ImageSpec size = resized_spec(spec, given.resize, kUnlimited);
        text += fmt::format(", resized to {} x {}", size.full_width, size.full_height);
    }
    if (message_options().is_verbose) text += fmt::format(", {} threads", thread_count(0));
    line.print(text);
}

void write_with_legend(const Tonemapper& tonemapper, const FrameFiles& file,
                       const ApplyOptions& options, const WriteOptions& write) {
    OIIO::ImageBuf picture;
    OIIO::ImageBuf source = read_picture(file.in, options.picture, options.input);
    if (!options.resize.empty()) source = resized(source, options, file.in, tonemapper.options());
    if (!tonemapper(picture, source, {}, options.picture.threads))
        throw FileError(file.in + ": " + first_line(picture.geterror()));
    write_image_atomically(with_legend(with_associated_alpha(picture)), file.out, write);
}

}  // namespace

namespace {

int run_on_files(ApplyOptions options) {
    use_threads(options.picture);
    if (options.given.contains("--resize")) check_resize("apply", options.resize, options.picture);
    if (options.given.contains("--operator") && trimmed(options.op).empty())
        throw Error("apply: --operator has no value; expected --operator NAME");
    ApplyFiles files = files_of(options);
    if (!options.lut.file.empty()) return apply_lut(options, files);
    take_lut_options("apply", options.lut, options, LutOption::yes);
    std::string op = options.is_false_color ? "false_color" : options.op;
    if (op.empty()) op = kDefaultOperator;
    TonemapOptions tonemap;
    tonemap.op = resolve_for_command(op, options.settings(), options.look);
    tonemap.exposure_stops = options.exposure;
    tonemap.input = options.input;
    tonemap.display = options.display;
    tonemap.reference_white = options.reference_white;
    tonemap.input_units = parse_input_units(options.input_units);
    tonemap.unpremult = alpha_of(options);
    tonemap.dither = options.dither;
    tonemap.mix = options.mix;
    tonemap.statistics = parse_statistics(options.statistics);
    const bool is_of_sequence = is_same_name(options.statistics, "sequence");
    const bool is_metered = options.given.contains("--auto-exposure") || is_of_sequence;
    for (const auto& [name, value] : {std::pair("--meter-frames", options.shot.meter_frames),
                                      std::pair("--meter-cache", options.shot.cache)}) {
        if (is_metered || !options.given.contains(name)) continue;
        throw Error(fmt::format(
            "apply: {} is {}; expected --auto-exposure or --statistics sequence with it", name,
            value));
    }
    const auto tell_default = [&] {
        if (!options.op.empty() || options.is_false_color || message_options().is_quiet) return;
        print_message(
            fmt::format("apply: operator is {} ({}), the default; use --operator "
                        "for another",
                        kDefaultOperator, find_operator(kDefaultOperator).view));
    };
    Tonemapper tonemapper(tonemap);  // reports a wrong name before it reads a large file
    if (options.has_legend && find_display(options.display).id != "srgb") {
        throw Error("apply: --display is " + options.display + "; expected srgb with --legend");
    }
    if (options.has_legend && !files.is_single)
        throw Error("apply: --legend is given; expected one picture with it");
    WriteOptions write = write_options_of(options, files.files.front().out);
    if (options.given.contains("--frames")) {
        options.in = files.files.front().in;
        options.out = files.files.front().out;
        const auto prepare = [&](std::vector<FrameFiles>& all, const std::vector<int>& numbers) {
            meter_frames(tonemapper, all, numbers, options);
        };
        tell_default();
        return apply_to_frames(tonemapper, options, write, prepare);
    }
    if (is_of_sequence) throw Error("apply: --statistics is sequence; expected --frames with it");
    check_overwriting(files.files, options.is_in_place);
    if (!files.is_single) {
        require_writable_folder(options.output);
        warn_of_histograms(meter_each(files.files, options));
        tell_default();
        return apply_to_files(tonemapper, options, files.files, write);
    }
    FrameFiles& file = files.files.front();
    remove_leftovers({file.out});
    Warnings warnings(file.out);
    write.warn = warnings.hearer();
    ReadMessages messages(file.in);
    std::optional<OIIO::ImageSpec> header;
    ReadOptions read = messages.hearing(read_options_of(options));
    read.header = [&](const OIIO::ImageSpec& spec) { header = spec; };
    const ResultLine result;
    std::vector<MeteredPicture> metered;
    try {
        const QuietStderr quiet;
        const ElapsedLine line("apply", quiet.before());
        metered = meter_each(files.files, options);
        if (file.exposure_stops) tonemapper = tonemapper.with_exposure(*file.exposure_stops);
        if (options.has_legend) {
            write_with_legend(tonemapper, file, options, write);
        } else if (options.picture.timeout > 0) {
            tonemap_contained(tonemapper, file, write, read, options.picture);
        } else {
            tonemap_file(tonemapper, file.in, file.out, write, read, options.picture.threads);
        }
    } catch (const FileError& e) {
        if (!is_frame_pattern(file.in)) throw;
        throw FileError(e.text() + "; for the frames of a shot, use --frames 1-100");
    }
    messages.print();
    warnings.print();
    warn_of_histograms(metered);
    tell_default();
    print_result(file, tonemapper, options, header, result);
    return kOk;
}

}  // namespace

int run_apply(const ApplyOptions& given) {
    ApplyOptions options = given;
    const StandardStreams streams(options);
    message_options().named = [&](std::string text) {
        return streams.with_dashes(std::move(text));
    };
    const std::shared_ptr<void> no_names(nullptr, [](void*) { message_options().named = {}; });
    try {
        const int exit_code = run_on_files(std::move(options));
        streams.finish();
        return exit_code;
    } catch (const Error& e) {
        Problem problem = e.problem();
        for (std::string* text : {&problem.what, &problem.value, &problem.expected})
            *text = streams.with_dashes(std::move(*text));
        throw_problem(problem);
    }
}

TONEWRIGHT_NAMESPACE_END
