// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "base/atomic_file.h"
#include "base/format_number.h"
#include "base/input_file.h"
#include "base/strings.h"
#include "cli/elapsed_line.h"
#include "cli/exact_forms.h"
#include "cli/messages.h"
#include "cli/picture_commands.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"
#include "lut/display_code.h"
#include "lut/lut_warnings.h"
#include "lut/shipped_set.h"
#include "ocio/lut_chain.h"
#include "pipeline/stand_ins.h"
#include "tonewright/lut.h"
#include "tonewright/lut_applications.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Options : ViewOptions {
    std::string format;
    std::string file;
    std::string encoding = "acescct";
    std::optional<int> size;
    bool one = false;
    bool three = false;
    std::optional<int> bits;
    int icc_version = 2;
    std::optional<int> decimals;
    std::optional<double> max_error;
    std::string nodes = "auto";
    std::string host;
    std::string all;
    bool exact = false;
};

/// @throws Error  a file type that cannot store the numbers exactly: lossy, or of other depths
void require_lut_picture(const std::string& path, int bits) {
    const std::string extension = extension_of(path);
    const bool is_tiff = extension == ".tif" || extension == ".tiff";
    const bool is_held = is_tiff || (bits == 32 ? extension == ".exr" : extension == ".png");
    if (!is_held) {
        throw Error(fmt::format("bake: file is {}; expected {} or .tif for {} bits", path,
                                bits == 32 ? ".exr" : ".png", bits));
    }
}

/// The application's settings, unless the user gives others.
void take_from_host(Options& options, const ResolvedOperator& op, const LutApplication& host,
                    LutFormat format) {
    const auto is_given = [&](const char* option) { return options.given.contains(option); };
    if (!is_given("--display")) options.display = host.display;
    if (!is_given("--input-encoding")) {
        options.encoding = lut_encoding_of(host, format);
        const bool is_chain = reads_chains(host, format);
        if (!is_given("--input") && is_chain)
            options.input = parse_input_encoding(options.encoding).default_input;
        if (is_chain) return;  // it has sizes of its own
        if (!is_given("--input")) options.input = lut_input_of(host, *op.op);
    }
    // A size counts the entries of a 1D table.
    const bool is_table = options.one || (!options.three && is_table_for(host, options.view(op)));
    if (options.size && !is_table && format == host.format) check_lut_size(host, *options.size);
    if (is_given("--format")) return;  // another file than the application's own
    if (is_given("--max-error") && is_strip(host.format)) {
        throw Error(
            fmt::format("bake: --max-error is given for {}; expected none, because its size is {}",
                        host.id, host.size));
    }
    if (!is_given("--depth")) options.bits = host.bits;
    if (is_table) return;
    if (!is_given("--size") && !is_given("--max-error")) options.size = host.size;
    options.three = true;
}

void print_every_color(const std::string& file, const View& view, const LutError& error) {
    print_result(
        fmt::format("{}: on every color of its input, in {}: error max {}, 99.9 % {}, mean {}",
                    file, is_light(view) ? "display-linear values" : "code values of 0 to 1",
                    rounded_up(error.max), rounded_up(error.p999), rounded_up(error.mean)));
}

/// Replaces a word, if the text has it.
std::string with_word(std::string text, std::string_view word, std::string_view by) {
    if (const std::size_t at = text.find(word); at != std::string::npos)
        text.replace(at, word.size(), by);
    return text;
}

/// The application's instructions for this file. Names with characters that mean something in a
/// shell or in a filter of ffmpeg stay FILE.
std::string steps_for(const LutApplication& host, const LutRequest& request,
                      const std::string& file) {
    constexpr std::string_view kPlain =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-/";
    const std::string& steps =
        request.encoding.is_linear ? lut_steps_of(host, request.format) : host.steps;
    const bool is_plain = file.find_first_not_of(kPlain) == std::string::npos;
    return with_word(with_word(steps, "the file's primaries",
                               find_input_space(request.view.input).primaries.name),
                     "FILE", is_plain ? file : "FILE");
}

void print_steps(const LutApplication& host, const LutRequest& request, const std::string& file) {
    if (request.view.display != host.display && !takes_any_display(host)) {
        print_result(fmt::format("{}: these steps are for the display {}; the file is for {}",
                                 host.title, host.display, request.view.display));
    }
    const bool has_its_encoding = request.encoding.id == parse_input_encoding(host.encoding).id;
    if (has_usual_input(host, request) || (host.takes_any_primaries && has_its_encoding)) {
        print_result(fmt::format("{}: {}", host.title, steps_for(host, request, file)));
        return;
    }
    const std::string input =
        "scene-linear " + with_word(find_input_space(request.view.input).title, "Linear ", "");
    print_result(fmt::format(
        "{}: convert {} before this file, which does not take the "
        "application's usual input",
        host.title,
        request.encoding.is_linear ? "to " + input : input + " to " + request.encoding.title));
}

void bake_chain(const Options& options, const LutRequest& request, LutNodes nodes,
                const LutApplication* host) {
    const LutChain chain = [&] {
        const ElapsedLine line("bake");
        return make_lut_chain(request, nodes, user_cache_folder());
    }();
    const PhotographError& photographs = chain.error.photographs;
    if (options.max_error && photographs.p999 > *options.max_error) {
        throw Error(fmt::format(
            "bake: max error is {}; expected at least {}, which {} has on "
            "photographs",
            shortest(*options.max_error), rounded_up(photographs.p999), chain.operations));
    }
    write_text_atomically(options.file, chain.contents);
    print_result(fmt::format("{}: {}, scene-linear in ({}); on photographs {}", options.file,
                             chain.operations, request.view.input, to_string(photographs)));
    print_every_color(options.file, request.view, chain.error);
    if (host) print_steps(*host, request, options.file);
}

void bake_one(Options& options) {
    if (options.op.empty())
        throw Error(
            "bake: OPERATOR is missing; expected an id from `tonewright list`, or --all FOLDER");
    if (options.file.empty()) throw Error("bake: -o is missing; expected -o FILE");
    // Reports the error before minutes of work, and before the check of the name.
    if (const std::string why = why_no_file(options.file); !why.empty())
        throw FileError(fmt::format("write: {}: {}", options.file, why));
    const LutApplication* host =
        options.host.empty() ? nullptr : &find_lut_application(options.host);
    LutRequest request;
    std::optional<LutFormat> format;
    if (!options.format.empty()) format = parse_lut_format(options.format);
    request.format = lut_format_of_file(options.file, format, host);
    if (!options.given.contains("--input"))
        options.input = parse_input_encoding(options.encoding).default_input;
    const ResolvedOperator op = options.resolved();
    if (host) take_from_host(options, op, *host, request.format);
    request.encoding = parse_input_encoding(options.encoding);
    request.view = options.view(op);
    request.size = options.size;
    request.bits = options.bits;
    request.icc_version = options.icc_version;
    if (options.given.contains("--icc-version") && request.format != LutFormat::icc)
        throw Error(fmt::format("bake: --icc-version is given for {}; expected format icc with it",
                                name_of(request.format)));
    request.decimals = options.decimals;
    if (options.one) request.dimension = LutDimension::one;
    if (options.three) request.dimension = LutDimension::three;
    LutNodes nodes = LutNodes::automatic;
    if (options.nodes == "sampled") nodes = LutNodes::sampled;
    if (options.nodes == "fitted") nodes = LutNodes::fitted;
    if (options.nodes == "smooth") nodes = LutNodes::smooth;
    const bool is_picture = is_picture_format(request.format);
    if (is_picture) require_lut_picture(options.file, request.bits.value_or(16));
    if (const std::string text = stand_in_warning(request.view.op, "LUT"); !text.empty())
        warn(text);
    if (is_lut_chain(request)) {
        bake_chain(options, request, nodes, host);
        return;
    }
    const BakedLut baked = [&] {
        const ElapsedLine line("bake");
        constexpr int kLargest = 129;
        const bool is_for_host = host && request.format == host->format;
        return bake_lut(request, nodes, interpolation_of(host), options.max_error,
                        is_for_host ? host->largest_size : kLargest);
    }();
    const Lut& lut = baked.lut;
    // The application's own input: nothing of it can be changed.
    const LutApplication* own_host = host && has_usual_input(*host, request) ? host : nullptr;
    const LutError& error = baked.error;
    request.size = lut.size;
    if (const std::string text = lut_warning(options.file, request, baked, own_host); !text.empty())
        warn(text);
    if (is_picture) {
        picture_commands().write_lut(lut, request.format, options.file, request.bits.value_or(16));
    } else {
        write_text_atomically(options.file, write_lut(baked, request));
    }
    print_result(fmt::format(
        "{}: {}D, {} {}, {} in ({}), {} interpolation{}; on photographs {}", options.file,
        lut.dimension, lut.size, lut.dimension == 3 ? "a side" : "entries",
        lut.is_half_domain ? "scene-linear" : request.encoding.id, request.view.input,
        error.interpolation, baked.is_fitted ? ", fitted nodes" : "",
        to_string(error.photographs)));
    print_every_color(options.file, request.view, error);
    const std::string clipped = to_string(measure_clipping(request, lut));
    if (!clipped.empty()) {
        print_result(fmt::format("{}: clips what {} would show {}", options.file,
                                 request.view.op.label, clipped));
    }
    if (host) print_steps(*host, request, options.file);
}

int run_bake(Options& options) {
    if (options.exact) {
        if (options.op.empty()) throw Error("bake: OPERATOR is missing; expected one with --exact");
        if (!options.file.empty() || !options.all.empty())
            throw Error("bake: --exact writes no file; expected no -o and no --all with it");
        print_exact_forms(options,
                          options.host.empty() ? nullptr : &find_lut_application(options.host));
        return kOk;
    }
    if (options.all.empty()) {
        with_memory_for(options.file, [&] { bake_one(options); });
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
    const Command command = program.add("bake", "Write an operator as a LUT file.");
    command.group("LUTs, shaders and configs");
    const char* const output = "Output";
    const char* const table = "Table";
    command.add("operator", options->op, "operator, operator:preset, .tone file, LUT or formula")
        .suggest(suggest_operators);
    command.add("-o", options->file, "file to write").value("FILE").group(output);
    command
        .add("--for", options->host,
             "application that reads the LUT (see `tonewright list --hosts`); sets format, size, "
             "input and display")
        .value("NAME")
        .suggest(suggest_lut_applications)
        .group(output);
    command.add("--format", options->format, "LUT format; see below (default: by the extension)")
        .value("NAME")
        .suggest(suggest_lut_formats)
        .group(output);
    command
        .add("--all", options->all, "write the shipped LUTs; with --for, those of one application")
        .value("FOLDER")
        .group(output);
    command
        .add_flag("--exact", options->exact,
                  "write nothing; list the most exact files for each application, or that of --for")
        .group(output);
    add_view_options(command, *options);
    command.add("--input-encoding", options->encoding, "encoding of the LUT's input; see below")
        .value("NAME")
        .suggest(suggest_encodings)
        .show_default()
        .group("Color");
    command
        .add("--size", options->size,
             "grid points a side (default 33) or entries of a 1D table (default 4096); see below")
        .value("N")
        .group(table);
    command
        .add("--max-error", options->max_error,
             "choose the smallest size up to 129 whose error on photographs (99.9 %), in code "
             "values, is at most this")
        .value("VALUE")
        .group(table);
    const Option one =
        command.add_flag("--1d", options->one, "write a 1D table; the view must be per channel");
    one.group(table);
    command.add_flag("--3d", options->three, "write a 3D LUT even where a 1D table would do")
        .group(table)
        .excludes(one);
    command
        .add("--nodes", options->nodes,
             "values at grid points: `auto` (best on photographs), `sampled`, `fitted` or `smooth`")
        .value("NAME")
        .choices({"auto", "sampled", "fitted", "smooth"})
        .show_default()
        .group(table);
    command
        .add("--decimals", options->decimals,
             "decimals in a .cube file, 3..9 (default: all digits of a float)")
        .value("N")
        .group(table);
    command
        .add("--depth", options->bits,
             "bits of a value: 8, 16 or 32 (float) in pictures, 10, 12 or 16 in 3dl")
        .value("BITS")
        .group(table);
    command.add("--icc-version", options->icc_version, "version of a device link: 2 or 4")
        .value("N")
        .choices({2, 4})
        .show_default()
        .group(table);
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
    command.action([options, command] {
        options->given = command.given();
        return run_bake(*options);
    });
}

TONEWRIGHT_NAMESPACE_END
