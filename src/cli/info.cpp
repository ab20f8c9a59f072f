// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "cli/picture_commands.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_info(CommandLine& program) {
    auto options = std::make_shared<InfoOptions>();
    const Command command = program.add(
        "info", "Print what a picture file says about its colors, and what commands make of it.");
    command.group("Pictures");
    command.add("in", options->pictures, "pictures, in any format that OpenImageIO reads")
        .required();
    command.add_flag("--json", options->json, "print one JSON object for each picture, one a line")
        .group("Output");
    command
        .add("--input", options->input,
             "color space of the input: a space, a display or `auto`, as the file says")
        .value("SPACE")
        .suggest(suggest_source_colors)
        .group("Pictures")
        .show_default();
    add_picture_choice(command, options->choice, "Pictures");
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
