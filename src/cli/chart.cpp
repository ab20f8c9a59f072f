// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "cli/options.h"
#include "cli/picture_commands.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_chart(CommandLine& program) {
    auto options = std::make_shared<ChartOptions>();
    const Command command =
        program.add("chart", "the synthetic HDR test chart, scene-linear Rec.709");
    command.add("-o", options->file, "file to write (.exr)").required();
    command.add("--width", options->width, "pixels").show_default();
    command.add("--height", options->height, "pixels").show_default();
    command.add("-d", options->type, "half or float").show_default();
    command.footer("Example:\n  tonewright chart -o chart.exr");
    command.action([options] {
        picture_commands().chart(*options);
        return kOk;
    });
}

TONEWRIGHT_NAMESPACE_END
