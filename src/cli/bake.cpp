// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/command.h"
#include "engine/error_metric.h"
#include "tonewright/lut.h"

namespace tonewright {
namespace {

struct Options : ViewOptions {
    std::string format = "cube";
    std::string file;
    std::string encoding = "acescct";
    std::optional<int> size;
    bool one = false;
    bool three = false;
    std::string all;
    bool input_was_given = false;
};

void bake_one(Options& options) {
    if (options.op.empty())
        throw Error("bake: operator is missing; expected an id of `tonewright list`, or --all DIR");
    if (options.file.empty()) throw Error("bake: -o is missing; expected the file to write");
    LutRequest request;
    request.format = parse_lut_format(options.format);
    request.encoding = parse_input_encoding(options.encoding);
    if (!options.input_was_given) options.input = request.encoding.default_input;
    request.view = options.view();
    request.size = options.size;
    if (options.one) request.dimension = LutDimension::one;
    if (options.three) request.dimension = LutDimension::three;
    const Lut lut = sample_lut(request);
    const LutError error = measure_lut(lut, request);
    write_text_atomically(options.file, write_lut(lut, request, error));
    fmt::print(stderr, "{}: {}D, {} in ({}), error max {}, 99.9 % {}, mean {} ({} interpolation)\n",
               options.file, lut.dimension,
               lut.is_half_domain ? "scene-linear" : request.encoding.id, request.view.input,
               rounded_up(error.max), rounded_up(error.p999), rounded_up(error.mean),
               error.interpolation);
}

}  // namespace

void add_bake(CLI::App& program, int&) {
    auto options = std::make_shared<Options>();
    CLI::App* command = program.add_subcommand("bake", "a view or operator as a lookup table file");
    command->add_option("operator", options->op, "operator, or operator:preset");
    add_view_options(*command, *options);
    command->add_option("-o", options->file, "file to write");
    command->add_option("--format", options->format, "cube, clf, spi1d or spi3d")
        ->capture_default_str();
    command
        ->add_option("--input-encoding", options->encoding,
                     "what goes in: acescct (AP1 primaries unless --input says otherwise), "
                     "log2[:LO:HI] (stops from 0.18, "
                     "default -10:6.5), linear[:LO:HI] (1D only)")
        ->capture_default_str();
    command->add_option(
        "--size", options->size,
        "grid points a side (17..129, default 33), or entries in 1D (default 4096)");
    CLI::Option* one = command->add_flag(
        "--1d", options->one, "a 1D table; the view must be per channel in its own space");
    command->add_flag("--3d", options->three, "a cube even where a 1D table would do")
        ->excludes(one);
    command->add_option("--all", options->all, "write the shipped set into this folder");
    command->footer(
        "1D or 3D follows from the view where neither is asked for. The file says what goes in, "
        "what comes\n"
        "out and how far it is from the exact operator.\n"
        "Example:\n  tonewright bake agx_sobotka --format cube --size 33 --input-encoding acescct "
        "-o agx.cube");
    command->callback([options, command] {
        if (!options->all.empty()) {
            if (!options->op.empty())
                throw Error("bake: operator is " + options->op + "; expected none with --all");
            write_generated_files(options->all, make_shipped_luts(), "MANIFEST.csv");
            return;
        }
        options->input_was_given = command->count("--input") > 0;
        bake_one(*options);
    });
}

}  // namespace tonewright
