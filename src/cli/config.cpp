// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/command.h"
#include "tonewright/ocio.h"

namespace tonewright {

void add_config(CLI::App& program, int&) {
    struct Options {
        std::string folder;
        ConfigOptions config;
        std::vector<std::string> operators;
        std::vector<std::string> names;
    };
    auto options = std::make_shared<Options>();
    CLI::App* command =
        program.add_subcommand("config", "an OpenColorIO config of operators, for any application");
    command->add_option("-o", options->folder, "folder to write: config.ocio, luts/, probe.csv")
        ->required();
    ConfigOptions& config = options->config;
    command->add_option("--profile", config.profile, "of OpenColorIO: 2.0 or 2.1")
        ->capture_default_str();
    command
        ->add_option("--views", config.views,
                     "views (\"AgX Punchy\") or operators, comma separated, in order, or all; "
                     "default: a dozen")
        ->delimiter(',');
    command->add_option("--displays", config.displays, "displays, comma separated; default: all")
        ->delimiter(',');
    command
        ->add_option(
            "--looks", config.looks,
            "looks (\"AgX - Punchy\"), comma separated, or none; default: all of the views")
        ->delimiter(',');
    command->add_option("--working", config.working, "space that applications compute in")
        ->capture_default_str();
    command
        ->add_option("--operator", options->operators,
                     "a view of your own: ID[:PRESET][:PARAMETER=VALUE...]; repeat for more")
        ->allow_extra_args(false);
    command
        ->add_option("--name", options->names, "its name, one for each --operator, in their order")
        ->allow_extra_args(false);
    command
        ->add_option("--exposure-views", config.exposure_stops,
                     "every view once more with so many stops more light, comma separated")
        ->delimiter(',')
        ->check(CLI::Range(-16.0, 16.0));
    command->footer(
        "Examples:\n  tonewright config -o ocio_config\n"
        "  tonewright config -o everything --views all\n"
        "  tonewright config -o studio --working acescg --views AgX,aces_20 --displays "
        "srgb,rec1886 "
        "\\\n    --operator reinhard_extended:white=6 --name \"Studio Reinhard\"\n"
        "  oiiotool --colorconfig ocio_config/config.ocio in.exr --ociodisplay sRGB Hable -o "
        "out.png");
    command->callback([options] {
        ConfigOptions& wanted = options->config;
        if (options->operators.size() != options->names.size()) {
            throw Error(
                fmt::format("config: {} --operator and {} --name; expected one name for each",
                            options->operators.size(), options->names.size()));
        }
        for (std::size_t i = 0; i < options->operators.size(); ++i)
            wanted.custom.push_back({options->names[i], options->operators[i]});
        wanted.working = find_input_space(wanted.working).id;
        require_writable_folder(options->folder);
        write_generated_files(options->folder, make_config(wanted), "config.ocio");
    });
}

}  // namespace tonewright
