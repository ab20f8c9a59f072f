// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "cli/picture_commands.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_meter(CommandLine& program) {
    auto options = std::make_shared<MeterCommandOptions>();
    options->metering.method = "log-average";
    const Command command = program.add(
        "meter", "Pictures", "Measure the luminance of pictures and suggest an exposure.");
    command.argument("in", &options->in, "pictures, in any format that OpenImageIO reads",
                     {.is_required = true});
    command.title("Output");
    command.add_flag("--json", &options->json, "print all figures with all digits, as JSON");
    add_progress(command);
    command.exclude("--progress", {"--json"});
    command.title("Exposure");
    command.add("--method", "NAME", &options->metering.method,
                "method: log-average, histogram, mean or max",
                {.suggest = one_of({"log-average", "histogram", "mean", "max"})});
    command.title("Pictures");
    command.add("--frames", "RANGE", &options->frames,
                "frames such as 1001-1100; IN has %04d, #### or @@@@ for the number");
    add_light_options(command, options->light);
    add_picture_input(command, options->picture);
    add_exposure_options(command, options->metering);
    add_shot_options(command, options->shot);
    command.common({"--json", "--method", "--frames", "--input", "--key", "--compensation",
                    "--region", "--percentiles", "--adapt"});
    command.footer(
        "Examples:\n"
        "  tonewright meter render.exr\n"
        "  tonewright meter render.exr --json --method histogram --percentiles 40,95\n"
        "  tonewright meter shot.####.exr --frames 1001-1100 --adapt");
    command.action([options] { return picture_commands().meter(*options); });
}

void add_info(CommandLine& program) {
    auto options = std::make_shared<InfoOptions>();
    const Command command = program.add(
        "info", "Pictures",
        "Print what a picture file says about its colors, and what commands make of it.");
    command.argument("in", &options->pictures, "pictures, in any format that OpenImageIO reads",
                     {.is_required = true});
    command.title("Output");
    command.add_flag("--json", &options->json,
                     "print one JSON object for each picture, one a line");
    command.title("Pictures");
    command.add("--input", "SPACE", &options->input,
                "color space of the input: a space, a display or `auto`, as the file says",
                {.suggest = suggest_source_colors});
    add_picture_choice(command, options->choice);
    command.footer(
        "Examples:\n"
        "  tonewright info photo.jpg\n"
        "  tonewright info render.exr --json");
    command.action([options] {
        picture_commands().info(*options);
        return kOk;
    });
}

TONEWRIGHT_NAMESPACE_END
