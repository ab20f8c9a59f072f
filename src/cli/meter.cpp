// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "cli/picture_commands.h"
#include "cli/shared_options.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_meter(CommandLine& program) {
    auto options = std::make_shared<MeterCommandOptions>();
    options->metering.method = "log-average";
    const Command command =
        program.add("meter", "how much light a picture has, and which exposure that suggests");
    command.add("in", options->in, "pictures, any format that OpenImageIO reads").required();
    command.add_flag("--json", options->json, "for programs: all figures, with all digits");
    command.add("--method", options->metering.method, "log-average, histogram, mean or max")
        .show_default()
        .group("Metering");
    const Option frames =
        command.add("--frames", options->frames,
                    "frames of a shot, such as 1001-1100: `in` has %04d or #### where the "
                    "number stands");
    command
        .add("--input", options->input,
             "what the input's numbers are: `auto`, what the picture says, or a name as in "
             "`apply`")
        .show_default();
    add_picture_input(command, options->picture);
    add_exposure_options(command, options->metering, nullptr);
    add_shot_options(command, options->shot, frames, nullptr);
    command.footer(
        "Examples:\n"
        "  tonewright meter render.exr\n"
        "  tonewright meter render.exr --json --method histogram --percentiles 40,95\n"
        "  tonewright meter shot.####.exr --frames 1001-1100 --adapt --meter-cache shot.json");
    command.action([options] { return picture_commands().meter(*options); });
}

TONEWRIGHT_NAMESPACE_END
