// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "tonewright/ocio.h"

namespace tonewright {

void add_config(CLI::App& program, int&) {
    auto folder = std::make_shared<std::string>();
    CLI::App* command =
        program.add_subcommand("config", "the OpenColorIO config (profile 2.1) of all operators");
    command->add_option("-o", *folder, "folder to write: config.ocio, luts/, probe.csv")
        ->required();
    command->footer(
        "Example:\n  tonewright config -o ocio_config\n"
        "  oiiotool --colorconfig ocio_config/config.ocio in.exr --ociodisplay sRGB Hable -o "
        "out.png");
    command->callback([folder] {
        require_writable_folder(*folder);
        write_generated_files(*folder, make_config(), "config.ocio");
    });
}

}  // namespace tonewright
