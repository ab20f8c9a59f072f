// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "base/format_number.h"
#include "cli/messages.h"
#include "cli/picture_commands.h"
#include "cli/progress.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"
#include "lut/display_code.h"
#include "lut/shipped_set.h"
#include "tasks/bake.h"
#include "tasks/exact_files.h"
#include "tonewright/lut.h"
#include "tonewright/lut_applications.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Options : ViewOptions {
    std::string format;
    std::string file;
    std::string encoding = std::string(kDefaultLutEncoding);
    std::optional<int> size;
    bool one = false;
    bool three = false;
    std::optional<int> bits;
    std::optional<int> icc_version;
    std::optional<int> decimals;
    std::optional<double> max_error;
    std::string nodes = "auto";
    std::string host;
    std::string all;
    bool exact = false;
};

BakeRequest request_of(const Options& options) {
    const auto is_given = [&](const char* option) { return options.given.contains(option); };
    BakeRequest request;
    request.file = options.file;
    if (!options.host.empty()) request.application = &find_lut_application(options.host);
    if (!options.format.empty()) request.format = parse_lut_format(options.format);
    if (is_given("--input-encoding")) request.encoding = parse_input_encoding(options.encoding);
    if (is_given("--input")) request.input = &find_input_space(options.input);
    request.input_units = parse_input_units(options.input_units);
    request.exposure_stops = options.exposure;
    if (is_given("--display")) request.display = options.display;
    request.reference_white = options.reference_white;
    if (options.one) request.dimension = LutDimension::one;
    if (options.three) request.dimension = LutDimension::three;
    request.size = options.size;
    request.depth = options.bits;
    request.decimals = options.decimals;
    request.icc_version = options.icc_version;
    request.max_error = options.max_error;
    request.nodes = parse_lut_nodes(options.nodes);
    request.cache_folder = user_cache_folder();
    request.write_picture = [](const auto&... arguments) {
        picture_commands().write_lut(arguments...);
    };
    request.op = options.resolved();
    return request;
}

void bake_one(const Options& options) {
    if (options.op.empty())
        throw Error(
            "bake: OPERATOR is missing; expected an id from `tonewright list`, or --all FOLDER");
    if (options.file.empty()) throw Error("bake: -o is missing; expected -o FILE");
    const BakeRequest request = request_of(options);
    const BakeResult result =
        with_progress("bake", [&](const Listener& listener) { return bake(request, listener); });
    const View& view = result.request.view;
    const Lut& lut = result.baked.lut;
    const LutError& error = result.baked.error;
    const std::string on_photographs = fmt::format(
        "({}){}; on photographs {}", view.input,
        result.operations.empty() ? fmt::format(", {} interpolation{}", error.interpolation,
                                                result.baked.is_fitted ? ", fitted nodes" : "")
                                  : "",
        to_string(error.photographs));
    if (!result.operations.empty()) {
        print_result(fmt::format("{}: {}, scene-linear in {}", options.file, result.operations,
                                 on_photographs));
    } else {
        print_result(fmt::format("{}: {}D, {} {}, {} in {}", options.file, lut.dimension, lut.size,
                                 lut.dimension == 3 ? "a side" : "entries",
                                 lut.is_half_domain ? "scene-linear" : result.request.encoding.id,
                                 on_photographs));
    }
    print_result(fmt::format(
        "{}: on every color of its input, in {}: error max {}, 99.9 % {}, mean {}", options.file,
        is_light(view) ? "display-linear values" : "code values of 0 to 1", rounded_up(error.max),
        rounded_up(error.p999), rounded_up(error.mean)));
    if (const std::string clipped = to_string(result.clipping); !clipped.empty()) {
        print_result(
            fmt::format("{}: clips what {} would show {}", options.file, view.op.label, clipped));
    }
    for (const std::string& line : result.steps)
        print_result(line);
}

std::string grade_of(double error) {
    const double codes = 255 * error;
    constexpr double kExact = 0.01;  // half a code of 14 bits
    constexpr double kNear = 0.5;    // rounds to the same 8-bit code
    if (codes < kExact) return "exact";
    if (codes <= kNear) return "near";
    return fmt::format("{:.1f}", codes);
}

/// The command line that writes the file, with the user's own options.
std::string command_of(const ExactFile& file, const LutApplication& host, const Options& options) {
    std::string name = options.op;
    std::string text = fmt::format("tonewright {} {}", file.is_shader ? "shader" : "bake", name);
    for (const std::string& setting : options.set)
        text += " --set " + setting;
    if (!options.look.empty()) text += " --look " + options.look;
    if (options.given.contains("--exposure"))
        text += fmt::format(" --exposure {}", options.exposure);
    if (options.given.contains("--display")) text += " --display " + options.display;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == ':' || c == '='; }, '_');
    return fmt::format("{} --for {} -o {}{}", text, host.id, name, file.extension);
}

/// The files of the operator for each application, or for that of --for.
void print_exact_files(const Options& options) {
    const BakeRequest request = request_of(options);
    fmt::print(
        "{}: files for applications; 99.9 % of photographs are within this many codes of "
        "255 (exact: less than 0.01; near: at most 0.5)\n",
        options.op);
    ExactFiles files(request);
    for (const LutApplication& host : all_lut_applications()) {
        if (request.application && request.application != &host) continue;
        fmt::print("\n  {}: {}\n", host.id, host.title);
        const std::vector<ExactFile> found = [&] {
            const Progress line("bake --exact");
            return files.of(host);
        }();
        for (const ExactFile& file : found) {
            fmt::print("    {:<5}  {}\n           {}\n", grade_of(file.error), file.title,
                       command_of(file, host, options));
        }
    }
}

int run_bake(const Options& options) {
    if (options.exact) {
        if (options.op.empty()) throw Error("bake: OPERATOR is missing; expected one with --exact");
        if (!options.file.empty() || !options.all.empty())
            throw Error("bake: --exact writes no file; expected no -o and no --all with it");
        print_exact_files(options);
        return kOk;
    }
    if (options.all.empty()) {
        bake_one(options);
        return kOk;
    }
    if (!options.op.empty())
        throw Error("bake: operator is " + options.op + "; expected none with --all");
    if (!options.host.empty()) require_preset_set(options.host);
    picture_commands().write_shipped_luts(options.all, options.host);
    return kOk;
}

}  // namespace

void add_bake(CommandLine& program) {
    auto options = std::make_shared<Options>();
    const Command command =
        program.add("bake", "LUTs, shaders and configs", "Write an operator as a LUT file.");
    add_operator_argument(command, options->op);
    command.title("Output");
    command.add("-o", "FILE", &options->file, "file to write");
    command.add(
        "--for", "NAME", &options->host,
        "application that reads the LUT (see `tonewright list --hosts`); sets format, size, "
        "input and display",
        {.suggest = suggest_lut_applications});
    command.add("--format", "NAME", &options->format,
                "LUT format; see below (default: by the extension)",
                {.suggest = suggest_lut_formats});
    command.add("--all", "FOLDER", &options->all,
                "write the shipped LUTs; with --for, those of one application");
    command.add_flag(
        "--exact", &options->exact,
        "write nothing; list the most exact files for each application, or that of --for");
    add_view_options(command, *options);
    command.title("Color");
    command.add("--input-encoding", "NAME", &options->encoding,
                "encoding of the LUT's input; see below", {.suggest = suggest_encodings});
    command.title("Table");
    command.add(
        "--size", "N", &options->size,
        "grid points a side (default 33) or entries of a 1D table (default 4096); see below");
    command.add("--max-error", "VALUE", &options->max_error,
                "choose the smallest size up to 129 whose error on photographs (99.9 %), in code "
                "values, is at most this");
    command.add_flag("--1d", &options->one, "write a 1D table; the view must be per channel");
    command.add_flag("--3d", &options->three, "write a 3D LUT even where a 1D table would do",
                     {.excludes = {"--1d"}});
    command.add(
        "--nodes", "NAME", &options->nodes,
        "values at grid points: `auto` (best on photographs), `sampled`, `fitted` or `smooth`",
        {.choices = {"auto", "sampled", "fitted", "smooth"}});
    command.add("--decimals", "N", &options->decimals,
                "decimals in a .cube file, 3..9 (default: all digits of a float)");
    command.add("--depth", "BITS", &options->bits,
                "bits of a value: 8, 16 or 32 (float) in pictures, 10, 12 or 16 in 3dl");
    command.add("--icc-version", "N", &options->icc_version, "version of a device link: 2 or 4",
                {.choices = {"2", "4"}, .default_text = "2"});
    add_progress(command);
    command.common({"-o", "--for", "--format", "--all", "--set", "--look", "--exposure", "--input",
                    "--display", "--input-encoding", "--size", "--max-error"});
    command.footer(
        "Formats: cube, clf, ctf, spi1d, spi3d, csp, resolve_cube (1D and 3D), 3dl, lut "
        "(Houdini), icc (device link); hald, strip, strip_up (pictures); raw.\n"
        "Input encodings: acescct, logc3, logc4, slog3, davinci, unity_logc, unreal_log, srgb, "
        "reinhard (x/(x + 1)), agx_log (the grid of agx_blender: exact for Rec.1886); pq[:WHITE] "
        "(cd/m2 of scene-linear 1.0); hlg[:WHITE] (scene light; "
        "cd/m2 that an "
        "HLG display of 1000 cd/m2 shows for scene-linear 1.0); log2[:LOW:HIGH] (stops from "
        "0.18, default "
        "-10:6.5); linear[:LOW:HIGH] (1D only). The named ones have their own primaries unless "
        "--input is given.\n"
        "Sizes: 17..129; 3dl 17, 33 or 65; hald a square of 16..144 (default 64); strip 2..64 "
        "(default 32); raw 2..129.\n"
        "Examples:\n"
        "  tonewright bake agx_blender --exact --for resolve\n"
        "  tonewright bake agx_blender --for resolve -o agx.cube\n"
        "  tonewright bake agx_sobotka --size 33 --input-encoding acescct -o agx.cube");
    command.action([options] { return run_bake(*options); }, &options->given);
}

TONEWRIGHT_NAMESPACE_END
