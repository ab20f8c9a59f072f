// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "cli/options.h"
#include "cli/picture_commands.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_sheet(CommandLine& program) {
    auto options = std::make_shared<SheetOptions>();
    const Command command =
        program.add("sheet", "pictures side by side with their labels: a contact sheet");
    command.add("pictures", options->pictures, "label=file, display pictures").required();
    command.add("-o", options->file, "file to write").required();
    command.add("--columns", options->columns, "pictures a row").show_default().range(1, 100);
    command.add("--cell-width", options->cell_width, "pixels").show_default().range(16, 16384);
    command.footer("Example:\n  tonewright sheet -o sheet.png Hable=hable.png AgX=agx.png");
    command.action([options] {
        picture_commands().sheet(*options);
        return kOk;
    });
}

TONEWRIGHT_NAMESPACE_END
