// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/apply.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <tuple>
#include <unordered_set>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "base/problem.h"
#include "base/strings.h"
#include "cli/lut_input.h"
#include "cli/messages.h"
#include "cli/pictures/commands.h"
#include "cli/pictures/reading.h"
#include "cli/pictures/requests.h"
#include "cli/pictures/standard_streams.h"
#include "cli/progress.h"
#include "cli/rows/apply_request.h"
#include "cli/rows/picture_messages.h"
#include "image/picture_file.h"
#include "image/resize.h"
#include "image/spec_conversion.h"
#include "image/tonemap_file.h"
#include "picture/picture_description.h"
#include "tasks/pictures/frames.h"
#include "tasks/pictures/input_files.h"
#include "tasks/pictures/metering.h"
#include "tasks/pictures/read_picture.h"
#include "tonewright/engines.h"
#include "tonewright/image_io.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// ---------------------------------------------------------------------------------------------
// Options as requests

/// Other commands take the operator by its place.
/// @throws Error  the name is an operator's, and no file has it
void expect_picture(const std::string& name) {
    std::error_code unknown;  // too long a name, too
    if (std::filesystem::exists(name, unknown) || names_a_file(name)) return;
    try {
        // --operator says what is wrong with a setting. With a dot, it may be a file's name.
        const bool may_be_file = name.find('.') != std::string::npos;
        (void)resolve_picture_operator(may_be_file ? name : name.substr(0, name.find(':')));
    } catch (const Error&) {
        return;
    }
    throw Error(fmt::format("apply: IN is {}, an operator; expected a picture, and --operator {}",
                            name, name));
}

/// Input and output files.
struct ApplyFiles {
    /// One picture, or the pattern of a shot.
    bool is_single = true;
    std::vector<FrameFiles> files;
};

/// The files of the arguments, also those of folders and lists.
/// @throws Error      no output, or two outputs of one name
/// @throws FileError  a folder without pictures, or a list that cannot be read
ApplyFiles files_of(const ApplyOptions& options) {
    std::vector<std::string> named = options.pictures;
    expect_picture(named.front());
    const bool has_output = options.given.contains("--output");
    std::string output = options.output;
    if (!has_output) {
        if (named.size() != 2) {
            throw Error(fmt::format("apply: -o is missing; expected -o {}",
                                    named.size() == 1 ? "FILE" : "FOLDER"));
        }
        output = named.back();
        named.pop_back();
    }
    const bool is_shot = options.given.contains("--frames");
    std::vector<std::string> inputs = named;
    bool has_many = false;
    if (!is_shot) std::tie(inputs, has_many) = expanded_inputs(named, has_output);
    if (has_output && !is_shot &&
        (has_many || inputs.size() > 1 || output.ends_with('/') || is_folder(output))) {
        const std::string format = lowercase(options.format);
        if (!format.empty() &&
            !is_picture_extension(format.front() == '.' ? format : "." + format)) {
            throw Error(
                fmt::format("apply: --format is {}; expected an extension of pictures, such as "
                            "png or exr",
                            options.format));
        }
        if (format.empty() && !is_folder(output) && is_picture_extension(extension_of(output))) {
            throw Error(fmt::format(
                "apply: -o is {}; expected a folder for several inputs, or --format with it",
                output));
        }
        return {false, files_into_folder(inputs, output, options.format)};
    }
    if (inputs.size() != 1) {
        throw Error(
            fmt::format("apply: --frames is {} with {} names; expected one with a "
                        "placeholder for the frame number",
                        options.frames.frames, inputs.size()));
    }
    if (!options.format.empty()) {
        throw Error(
            fmt::format("apply: --format is {}; expected -o with a folder, or the "
                        "extension in the output's name",
                        options.format));
    }
    return {true, {{inputs.front(), output, {}}}};
}

/// @throws Error  the file name cannot have this output; checked before a large picture is read
WriteOptions checked_write_options(const ApplyOptions& options, const std::string& out) {
    WriteOptions write = write_options_of(options);
    if (write.bits > 0 || options.given.contains("--compression") ||
        options.given.contains("--quality") || options.given.contains("--subsampling"))
        (void)PictureWriter(out, write);
    return write;
}

ReadOptions with_resize(const ApplyOptions& options) {
    ReadOptions read = read_options_of(options.picture);
    read.resize = options.resize;
    return read;
}

bool takes_sequence(const ApplyOptions& options) {
    return is_same_name(options.statistics, "sequence");
}

/// Metering sees the colors that are tone mapped.
ExposureRequest exposure_request_of(const ApplyOptions& options, const TonemapOptions& tonemap) {
    ExposureRequest request;
    request.takes_sequence = takes_sequence(options);
    if (options.metering.method.empty() && !request.takes_sequence) return request;
    request.meter.options = meter_options_of(
        options.metering, {options.input, options.input_units, options.reference_white},
        options.picture);
    request.meter.options.unpremult = tonemap.unpremult;
    request.meter.options.read.resize = options.resize;
    request.meter.cache = options.shot.cache;
    request.meter.work = {options.picture.threads, options.picture.timeout};
    if (!options.metering.method.empty()) request.rule = rule_of(options.metering);
    request.exposure_stops = options.exposure;
    if (options.shot.adapt) request.adaptation = adaptation_of(options.shot);
    if (!options.shot.meter_frames.empty())
        request.frames = parse_frames(options.shot.meter_frames, "meter_frames");
    request.leaves_out_missing =
        parse_missing(options.frames.missing) != ShotRequest::Missing::error;
    return request;
}

void check_shot_options(const ApplyOptions& options, bool is_single) {
    const bool is_metered = options.given.contains("--auto-exposure") || takes_sequence(options);
    for (const auto& [name, value] : {std::pair("--meter-frames", options.shot.meter_frames),
                                      std::pair("--meter-cache", options.shot.cache)}) {
        if (is_metered || !options.given.contains(name)) continue;
        throw Error(fmt::format(
            "apply: {} is {}; expected --auto-exposure or --statistics sequence with it", name,
            value));
    }
    if (options.has_legend && find_display(options.display).id != "srgb")
        throw Error("apply: --display is " + options.display + "; expected srgb with --legend");
    if (options.has_legend && !is_single)
        throw Error("apply: --legend is given; expected one picture with it");
    if (takes_sequence(options) && !options.given.contains("--frames"))
        throw Error("apply: --statistics is sequence; expected --frames with it");
}

// ---------------------------------------------------------------------------------------------
// A LUT instead of an operator

int apply_lut(const ApplyOptions& options, const ApplyFiles& files) {
    // Reports wrong options before a picture is read.
    check_lut_options("apply", options.lut, options, source_color({}, options.input));
    const LutFile lut = with_memory_for(options.lut.file, [&] {
        return open_lut(options.lut.file, options.lut.interpolation, load_lut_picture);
    });
    const WriteOptions write = checked_write_options(options, files.files.front().out);
    const TonemapOptions light = tonemap_options_of(options, write);
    check_overwriting(files.files, options.is_in_place);
    std::optional<LutOptions> stated;  // the first picture finds the input, and says so
    double done = 0;                   // percent
    const double each = 100.0 / static_cast<double>(files.files.size());
    const auto apply_to = [&](const FrameFiles& file) {
        PictureMessages messages({}, file.out);
        const LutSource source =
            lut_source(read_picture(file.in, options.picture, options.input), file.in, light,
                       with_resize(options), options.picture.threads);
        if (!stated) stated = with_stated_input(options.lut, source.name);
        LutPictureRequest request = {
            .lut = lut,
            .lut_name = std::filesystem::path(options.lut.file).filename().string(),
            .before = before_lut("apply", *stated, options, source.color),
            .display = stated_display(options.lut),
            .unpremult = light.unpremult,
            .resize = options.resize,
            .write = write,
            .nthreads = options.picture.threads};
        messages.attach_to(request.write);
        request.write.warn = [sink = request.write.warn](const std::string& text) {
            // The LUT decides the display.
            const MessageStyle style = {
                .setting = [](std::string_view parameter, std::string_view value) {
                    const std::string option = command_style().setting(parameter, value);
                    return parameter == "display" ? "a LUT that is baked with " + option : option;
                }};
            sink(render(text, style));
        };
        {
            const QuietStderr quiet;
            Progress progress("apply",
                              {.terminal = quiet.before(), .from = done, .to = done + each});
            request.write.progress = progress.listener().progress;
            write_through_lut(source, file, request);
        }
        done += each;
        messages.print();
    };
    if (files.is_single) {
        apply_to(files.files.front());
        return kOk;
    }
    require_writable_folder(options.output);
    int exit_code = kOk;
    for (const FrameFiles& file : files.files) {
        try {
            apply_to(file);
        } catch (const Error& e) {
            if (e.problem().kind == Problem::Kind::check) throw;  // --strict
            print_message("apply: " + render(e.problem(), command_style()));
            exit_code = kCheckFailed;
        }
    }
    return exit_code;
}

// ---------------------------------------------------------------------------------------------
// Results

/// Prints lines for failures.
/// @returns  their number
std::size_t print_failures(const std::vector<FrameFiles>& files) {
    constexpr std::size_t kMostLines = 50;
    std::size_t failed = 0;
    // Warnings that --strict makes errors are the same for all. A million errors are known by their
    // hash.
    std::unordered_set<std::size_t> errors;
    for (const FrameFiles& file : files) {
        if (!file.problem) continue;
        ++failed;
        const std::string text = render(*file.problem, command_style());
        if (errors.insert(std::hash<std::string>()(text)).second && errors.size() <= kMostLines)
            print_message("apply: " + text);
    }
    if (errors.size() > kMostLines)
        print_message(fmt::format("apply: and {} more", errors.size() - kMostLines));
    return failed;
}

/// ", pixel types as the inputs; ...", for several files.
std::string kept_type_text(const std::vector<FrameFiles>& files, const ApplyOptions& options) {
    return says_what_was_done() && !files.empty() && keeps_type(files.front().out, options)
               ? ", pixel types as the inputs (-d float for 32 bits)"
               : "";
}

/// One line for all, on a terminal or if not all were simply written.
void print_summary(const std::string& text, bool is_all_written) {
    if (says_what_was_done() || (!is_all_written && !message_options().is_quiet))
        print_message("apply: " + text);
}

/// Lines for failures, and one for all.
/// @returns  the exit code
int print_summary(const Shot& shot, const ApplyOptions& options) {
    std::vector<int> failed;
    std::size_t skipped = 0;
    for (std::size_t i = 0; i < shot.frames.size(); ++i) {
        const FrameFiles& frame = shot.frames[i];
        skipped += frame.is_skipped ? 1 : 0;
        if (frame.problem) failed.push_back(shot.numbers[i]);
    }
    print_failures(shot.frames);
    const std::size_t count = shot.frames.size() + shot.missing_count;
    const std::size_t written = shot.frames.size() - skipped - failed.size();
    std::string text = fmt::format("{} frame{}: {} written", count, count == 1 ? "" : "s", written);
    if (skipped > 0) text += fmt::format(", {} skipped", skipped);
    if (shot.missing_count > 0) text += fmt::format(", {} missing", shot.missing_count);
    if (shot.held_count > 0) text += fmt::format(", {} held for missing ones", shot.held_count);
    if (!failed.empty())
        text += fmt::format(", {} failed: {}", failed.size(), format_frames(failed));
    text += kept_type_text(shot.frames, options);
    print_summary(text, written == count && shot.held_count == 0);
    return failed.empty() ? kOk : kCheckFailed;
}

// ---------------------------------------------------------------------------------------------

/// Metering is the first part of the work: it reads the pictures, and writes none.
constexpr double kMetered = 30;  // percent
double begin_of_writing(const ExposureRequest& exposure) {
    return exposure.rule || exposure.takes_sequence ? kMetered : 0;
}

void run(const Tonemapper& tonemapper, std::vector<FrameFiles>& files, SequenceOptions sequence,
         const ApplyOptions& options, PictureMessages& messages, const char* unit, double from) {
    {
        const QuietStderr quiet;
        Progress progress(
            "apply",
            {.unit = unit, .total = files.size(), .terminal = quiet.before(), .from = from});
        sequence.done = [&](const FrameFiles& file) { progress.add(!file.is_skipped); };
        tonemap_pictures(tonemapper, files, sequence, options.picture.timeout);
    }
    messages.print();
}

int apply_to_shot(Tonemapper& tonemapper, const ApplyOptions& options, const FrameFiles& pattern,
                  SequenceOptions sequence) {
    tell_default_operator(options);
    const ExposureRequest exposure = exposure_request_of(options, tonemapper.options());
    std::optional<QuietStderr> quiet(std::in_place);
    Shot shot = plan_shot({.in = pattern.in,
                           .out = pattern.out,
                           .numbers = parse_frames(options.frames.frames),
                           .missing = parse_missing(options.frames.missing),
                           .skips_existing = options.frames.skip_existing,
                           .is_in_place = options.is_in_place});
    {
        std::optional<Progress> progress;
        if (begin_of_writing(exposure) > 0) {
            progress.emplace("apply", ProgressFacts{.unit = "metered frames",
                                                    .terminal = quiet->before(),
                                                    .to = kMetered});
        }
        const Listener listener = {.warn =
                                       [&](const std::string& text) {
                                           progress.reset();
                                           quiet.reset();
                                           warn(text);
                                       },
                                   .progress =
                                       [&](std::size_t done, std::size_t total) {
                                           if (progress) progress->set(done, total);
                                       }};
        meter_frames(tonemapper, shot, pattern.in, exposure, listener);
    }
    quiet.reset();
    PictureMessages messages(pattern.in, pattern.out);
    messages.attach_to(sequence.read);
    messages.attach_to(sequence.write);
    sequence.skip_existing = options.frames.skip_existing;
    sequence.jobs = options.frames.jobs;
    run(tonemapper, shot.frames, sequence, options, messages, "frames", begin_of_writing(exposure));
    return print_summary(shot, options);
}

int apply_to_files(const Tonemapper& tonemapper, const ApplyOptions& options,
                   std::vector<FrameFiles>& files, SequenceOptions sequence) {
    require_writable_folder(options.output);
    const ExposureRequest exposure = exposure_request_of(options, tonemapper.options());
    if (exposure.rule) {
        const std::vector<MeteredPicture> metered = [&] {
            const QuietStderr quiet;
            Progress progress("apply", {.unit = "metered pictures",
                                        .total = files.size(),
                                        .terminal = quiet.before(),
                                        .to = kMetered});
            return meter_files(files, exposure, {.progress = progress.listener().progress});
        }();
        warn_of_histograms(metered, *exposure.rule, {.warn = warn});
    }
    tell_default_operator(options);
    PictureMessages messages;
    messages.attach_to(sequence.read);
    messages.attach_to(sequence.write);
    sequence.names_pictures = true;
    run(tonemapper, files, sequence, options, messages, "pictures", begin_of_writing(exposure));
    const std::size_t failed = print_failures(files);
    const std::size_t written = files.size() - failed;
    std::string text = fmt::format("{} picture{}: {} written", files.size(),
                                   files.size() == 1 ? "" : "s", written);
    if (failed > 0) text += fmt::format(", {} failed", failed);
    text += kept_type_text(files, options);
    print_summary(text, failed == 0);
    return failed == 0 ? kOk : kCheckFailed;
}

int apply_to_picture(Tonemapper& tonemapper, const ApplyOptions& options,
                     std::vector<FrameFiles>& files, SequenceOptions sequence) {
    FrameFiles& file = files.front();
    remove_leftovers({file.out});
    PictureMessages messages(file.in, file.out);
    messages.attach_to(sequence.read);
    messages.attach_to(sequence.write);
    std::optional<OIIO::ImageSpec> header;
    sequence.read.header = [&](const OIIO::ImageSpec& spec) { header = spec; };
    const ExposureRequest exposure = exposure_request_of(options, tonemapper.options());
    const ResultLine result;
    std::vector<MeteredPicture> metered;
    try {
        const QuietStderr quiet;
        Progress progress("apply",
                          {.terminal = quiet.before(), .from = begin_of_writing(exposure)});
        sequence.write.progress = progress.listener().progress;
        if (exposure.rule) metered = meter_files(files, exposure);
        if (options.has_legend) {
            if (file.exposure_stops) tonemapper = tonemapper.with_exposure(*file.exposure_stops);
            ReadOptions unchanged = sequence.read;
            unchanged.resize.clear();  // write_with_legend() resizes
            write_with_legend(tonemapper, read_picture(file.in, unchanged, options.input), file,
                              sequence.write, sequence.read, sequence.nthreads);
        } else {
            tonemap_pictures(tonemapper, files, sequence, options.picture.timeout);
            if (file.problem) throw_problem(*file.problem);
        }
    } catch (const FileError& e) {
        if (!is_frame_pattern(file.in)) throw;
        throw FileError(e.text() + "; for the frames of a shot, use --frames 1-100");
    }
    messages.print();
    if (exposure.rule) warn_of_histograms(metered, *exposure.rule, {.warn = warn});
    tell_default_operator(options);
    const OIIO::ImageSpec spec =
        header ? *header : PictureReader(file.in, 1, read_options_of(options.picture)).spec();
    std::string size;
    if (!options.resize.empty()) {
        const OIIO::ImageSpec resized = resized_spec(spec, options.resize, kUnlimited);
        size = fmt::format(", resized to {} x {}", resized.full_width, resized.full_height);
    }
    print_result({.in = file.in,
                  .out = file.out,
                  .source = picture_spec(spec),
                  .exposure_stops = file.exposure_stops,
                  .resized = size,
                  .threads = thread_count(0)},
                 tonemapper.options(), options, result);
    return kOk;
}

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
    const ResolvedOperator resolved = resolve_for_command(op, options.settings(), options.look);
    const FrameFiles first = files.files.front();
    SequenceOptions sequence;
    sequence.write = checked_write_options(options, first.out);
    sequence.read = with_resize(options);
    sequence.nthreads = options.picture.threads;
    TonemapOptions tonemap = tonemap_options_of(options, sequence.write);
    tonemap.op = resolved;
    check_shot_options(options, files.is_single);
    Tonemapper tonemapper(tonemap);  // reports a wrong name before it reads a large file
    if (options.given.contains("--frames"))
        return apply_to_shot(tonemapper, options, first, sequence);
    check_overwriting(files.files, options.is_in_place);
    return files.is_single ? apply_to_picture(tonemapper, options, files.files, sequence)
                           : apply_to_files(tonemapper, options, files.files, sequence);
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
    } catch (const AmbiguousNameError&) {
        throw;  // main() prints the meanings of the name
    } catch (const Error& e) {
        Problem problem = e.problem();
        for (std::string* text : {&problem.what, &problem.value, &problem.expected})
            *text = streams.with_dashes(std::move(*text));
        throw_problem(problem);
    }
}

TONEWRIGHT_NAMESPACE_END
