// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/pictures/commands.h"
#include "cli/pictures/picture_input.h"
#include "image/contact_sheet.h"
#include "image/source_picture.h"
#include "tonewright/contact_sheet.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN

void run_sheet(const SheetOptions& options) {
    std::vector<std::pair<std::string, OIIO::ImageBuf>> labeled;
    for (const std::string& text : options.pictures) {
        const std::size_t equals = text.find('=');
        const std::string path = equals == std::string::npos ? text : text.substr(equals + 1);
        if (is_same_file(path, options.file)) {
            throw Error(fmt::format(
                "sheet: -o is {}, the same file as an input; expected another file", options.file));
        }
        labeled.emplace_back(equals == std::string::npos ? text : text.substr(0, equals),
                             read_picture(path, options.choice));
        try {
            check_shown_window(labeled.back().second);
        } catch (const PictureError& e) {
            throw FileError(within("sheet: " + path, e.problem()));
        }
    }
    write_image_atomically(make_contact_sheet(labeled, options.columns, options.cell_width),
                           options.file, OIIO::TypeUInt8);
}

TONEWRIGHT_NAMESPACE_END
