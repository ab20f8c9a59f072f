// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>

#include "cli/messages.h"
#include "cli/options.h"
#include "cli/picture_commands.h"
#include "cli/shared_options.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_sheet(CommandLine& program) {
    auto options = std::make_shared<SheetOptions>();
    const Command command =
        program.add("sheet", "Arrange pictures with labels on a contact sheet.");
    command.group("Pictures");
    const char* const group = "Output";
    command.add("pictures", options->pictures, "LABEL=FILE: label and display-encoded picture")
        .required();
    command.add("-o", options->file, "file to write").value("FILE").required().group(group);
    command.add("--columns", options->columns, "pictures in a row")
        .value("N")
        .show_default()
        .range(1, 100)
        .group(group);
    command.add("--cell-width", options->cell_width, "width of a picture in pixels")
        .value("N")
        .show_default()
        .range(16, 16384)
        .group(group);
    add_picture_choice(command, options->choice, "Pictures");
    command.footer("Example:\n  tonewright sheet -o sheet.png Hable=hable.png AgX=agx.png");
    command.action([options] {
        const ResultLine line;
        picture_commands().sheet(*options);
        line.print(fmt::format("sheet: {}: {} pictures", options->file, options->pictures.size()));
        return kOk;
    });
}

TONEWRIGHT_NAMESPACE_END
