// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/picture_input.h"
#include "tonewright/contact_sheet.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_sheet(CLI::App& program, int&) {
    struct Options {
        std::string file;
        std::vector<std::string> pictures;
        int columns = 4;
        int cell_width = 480;
    };
    auto options = std::make_shared<Options>();
    CLI::App* command =
        program.add_subcommand("sheet", "pictures side by side with their labels: a contact sheet");
    command->add_option("pictures", options->pictures, "label=file, display pictures")->required();
    command->add_option("-o", options->file, "file to write")->required();
    command->add_option("--columns", options->columns, "pictures a row")
        ->capture_default_str()
        ->check(CLI::Range(1, 100));
    command->add_option("--cell-width", options->cell_width, "pixels")
        ->capture_default_str()
        ->check(CLI::Range(16, 16384));
    command->footer("Example:\n  tonewright sheet -o sheet.png Hable=hable.png AgX=agx.png");
    command->callback([options] {
        std::vector<std::pair<std::string, OIIO::ImageBuf>> labelled;
        for (const std::string& text : options->pictures) {
            const std::size_t equals = text.find('=');
            const std::string path = equals == std::string::npos ? text : text.substr(equals + 1);
            labelled.emplace_back(equals == std::string::npos ? text : text.substr(0, equals),
                                  read_picture(path));
        }
        write_image_atomically(make_contact_sheet(labelled, options->columns, options->cell_width),
                               options->file, OIIO::TypeUInt8);
    });
}

TONEWRIGHT_NAMESPACE_END
