// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>

#include "cli/messages.h"
#include "cli/options.h"
#include "cli/picture_commands.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_chart(CommandLine& program) {
    auto options = std::make_shared<ChartOptions>();
    const Command command =
        program.add("chart", "Write the synthetic HDR test chart, in scene-linear Rec.709.");
    command.group("Pictures");
    const char* const group = "Output";
    command.add("-o", options->file, "file to write (.exr)").value("FILE").required().group(group);
    command.add("--width", options->width, "width in pixels")
        .value("N")
        .show_default()
        .group(group);
    command.add("--height", options->height, "height in pixels")
        .value("N")
        .show_default()
        .group(group);
    command.add("-d", options->type, "pixel type: half or float")
        .value("TYPE")
        .suggest({"half", "float"})
        .show_default()
        .group(group);
    command.footer("Example:\n  tonewright chart -o chart.exr");
    command.action([options] {
        const ResultLine line;
        picture_commands().chart(*options);
        line.print(fmt::format("chart: {} ({} x {} {})", options->file, options->width,
                               options->height, options->type));
        return kOk;
    });
}

TONEWRIGHT_NAMESPACE_END
