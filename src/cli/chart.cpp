// SPDX-License-Identifier: Apache-2.0
#include "tonewright/chart.h"
#include "cli/command.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_chart(CLI::App& program, int&) {
    struct Options {
        std::string file;
        std::string type = "float";
        int width = 1536;
        int height = 864;
    };
    auto options = std::make_shared<Options>();
    CLI::App* command =
        program.add_subcommand("chart", "the synthetic HDR test chart, scene-linear Rec.709");
    command->add_option("-o", options->file, "file to write (.exr)")->required();
    command->add_option("--width", options->width, "pixels")->capture_default_str();
    command->add_option("--height", options->height, "pixels")->capture_default_str();
    command->add_option("-d", options->type, "half or float")->capture_default_str();
    command->footer("Example:\n  tonewright chart -o chart.exr");
    command->callback([options] {
        const OIIO::TypeDesc type = parse_pixel_type(options->type);
        if (!type.is_floating_point()) {
            throw Error("chart: -d is " + options->type +
                        "; expected half or float, the chart holds light up to thousands");
        }
        write_image_atomically(make_chart(options->width, options->height), options->file, type);
    });
}

TONEWRIGHT_NAMESPACE_END
