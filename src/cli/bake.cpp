// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "cli/picture_commands.h"
#include "cli/shared_options.h"
#include "lut/shipped_set.h"
#include "measure/error_metric.h"
#include "tonewright/lut.h"
#include "tonewright/lut_applications.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Options : ViewOptions {
    std::string format = "cube";
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
};

/// @throws Error  for a file type that does not hold the numbers as they are: lossy, or of other
///                depths.
void require_lut_picture(const std::string& path, int bits) {
    const std::string extension = extension_of(path);
    const bool is_tiff = extension == ".tif" || extension == ".tiff";
    const bool is_held = is_tiff || (bits == 32 ? extension == ".exr" : extension == ".png");
    if (!is_held) {
        throw Error(fmt::format("bake: file is {}; expected {} or .tif for {} bits", path,
                                bits == 32 ? ".exr" : ".png", bits));
    }
}

/// What the host expects, where the user has not said otherwise.
void take_from_host(Options& options) {
    if (options.host.empty()) return;
    const LutApplication& host = find_lut_application(options.host);
    const auto is_given = [&](const char* option) { return options.given.contains(option); };
    if (!is_given("--input-encoding")) options.encoding = host.encoding;
    if (!is_given("--display")) options.display = host.display;
    if (is_given("--format")) return;  // another file than the host's own
    options.format = name_of(host.format);
    if (is_given("--max-error") && is_strip(host.format)) {
        throw Error("bake: max error is given for " + host.id + "; expected none, its size is " +
                    std::to_string(host.size));
    }
    if (!is_given("--size") && !is_given("--max-error") && !options.one) options.size = host.size;
    if (!is_given("--depth")) options.bits = host.bits;
    if (!options.one) options.three = true;
}

void bake_one(Options& options) {
    if (options.op.empty())
        throw Error("bake: operator is missing; expected an id of `tonewright list`, or --all DIR");
    if (options.file.empty()) throw Error("bake: -o is missing; expected the file to write");
    take_from_host(options);
    LutRequest request;
    request.format = parse_lut_format(options.format);
    request.encoding = parse_input_encoding(options.encoding);
    if (!options.given.contains("--input")) options.input = request.encoding.default_input;
    request.view = options.view();
    request.size = options.size;
    request.bits = options.bits;
    request.icc_version = options.icc_version;
    if (options.given.contains("--icc-version") && request.format != LutFormat::icc)
        throw Error("bake: ICC version is given for " + options.format + "; expected icc");
    request.decimals = options.decimals;
    if (options.one) request.dimension = LutDimension::one;
    if (options.three) request.dimension = LutDimension::three;
    const bool trilinear =
        !options.host.empty() && is_trilinear(find_lut_application(options.host));
    LutNodes nodes = LutNodes::automatic;
    if (options.nodes == "sampled") nodes = LutNodes::sampled;
    if (options.nodes == "fitted") nodes = LutNodes::fitted;
    const bool is_picture = is_picture_format(request.format);
    if (is_picture) require_lut_picture(options.file, request.bits.value_or(16));
    const BakedLut baked = bake_lut(request, nodes, trilinear, options.max_error);
    const Lut& lut = baked.lut;
    const LutError& error = baked.error;
    request.size = lut.size;
    if (is_picture) {
        picture_commands().write_lut(lut, request.format, options.file, request.bits.value_or(16));
    } else {
        write_text_atomically(options.file, write_lut(lut, request, error, baked.other_error));
    }
    fmt::print(
        stderr,
        "{}: {}D, {} {}, {} in ({}), error max {}, 99.9 % {}, mean {} ({} interpolation{})\n",
        options.file, lut.dimension, lut.size, lut.dimension == 3 ? "a side" : "entries",
        lut.is_half_domain ? "scene-linear" : request.encoding.id, request.view.input,
        rounded_up(error.max), rounded_up(error.p999), rounded_up(error.mean), error.interpolation,
        baked.is_fitted ? ", fitted nodes" : "");
    const std::string clipped = to_string(measure_clipping(request, lut));
    if (!clipped.empty()) {
        fmt::print(stderr, "{}: clips what {} would show {}\n", options.file, request.view.op.label,
                   clipped);
    }
    if (!options.host.empty()) {
        const LutApplication& host = find_lut_application(options.host);
        fmt::print(stderr, "{}: {}\n", host.title, host.steps);
    }
}

int run_bake(Options& options) {
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
    const Command command = program.add("bake", "a view or operator as a lookup table file");
    command.add("operator", options->op, "operator, or operator:preset");
    add_view_options(command, *options);
    command.add("-o", options->file, "file to write");
    command.add("--for", options->host,
                "application that reads it (`tonewright list --hosts`): format, size, "
                "input and output are then what it expects, unless given");
    command
        .add("--format", options->format,
             "cube, clf, ctf, spi1d, spi3d, csp, resolve_cube (1D and 3D tables), 3dl, lut "
             "(Houdini), icc (device link); hald, strip, strip_up (pictures); raw")
        .show_default();
    command
        .add("--input-encoding", options->encoding,
             "what goes in: acescct, logc3, logc4, slog3, davinci, unity_logc, unreal_log, "
             "srgb (each of its own primaries unless --input says otherwise), pq[:WHITE] "
             "(scene-linear 1 at WHITE cd/m2), log2[:LO:HI] (stops from 0.18, default "
             "-10:6.5), linear[:LO:HI] (1D only)")
        .show_default();
    command.add(
        "--size", options->size,
        "grid points a side (17..129, default 33; 3dl 17, 33, 65; hald a square of 16..144, "
        "default 64; strip 2..64, default 32; raw 2..129), or entries in 1D (default 4096)");
    command.add("--max-error", options->max_error,
                "instead of a size: the smallest of 17, 25, 33, 49, 65, 97 and 129 points a "
                "side whose largest error is at most this, in code values");
    command
        .add("--nodes", options->nodes,
             "values at the nodes: sampled, fitted (least error between them), or auto: "
             "the nearer one")
        .choices({"auto", "sampled", "fitted"})
        .show_default();
    command.add("--depth", options->bits,
                "bits of a number: 8, 16 or 32 (float) in pictures, 10, 12 or 16 in 3dl");
    command.add("--icc-version", options->icc_version, "of a device link")
        .choices({2, 4})
        .show_default();
    command.add("--decimals", options->decimals,
                "of the numbers in a cube, 3..9 (default: as many as a float has); 4 round "
                "by 5e-5, less than most cubes are off between their nodes");
    const Option one = command.add_flag(
        "--1d", options->one, "a 1D table; the view must be per channel in its own space");
    command.add_flag("--3d", options->three, "a cube even where a 1D table would do").excludes(one);
    command.add("--all", options->all,
                "write the shipped LUTs into this folder; with --for, those of one application");
    command.footer(
        "1D or 3D follows from the view where neither is asked for. Files that have room for text "
        "say what\n"
        "goes in, what comes out and how far it is from the exact operator.\n"
        "Examples:\n  tonewright bake agx_blender --for resolve -o agx.cube\n"
        "  tonewright bake agx_sobotka --format cube --size 33 --input-encoding acescct -o "
        "agx.cube");
    command.action([options, command] {
        options->given = command.given();
        return run_bake(*options);
    });
}

TONEWRIGHT_NAMESPACE_END
