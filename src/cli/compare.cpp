// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "cli/options.h"
#include "cli/picture_commands.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_compare(CommandLine& program) {
    auto options = std::make_shared<CompareOptions>();
    const Command command = program.add(
        "compare", "a picture through several operators: a contact sheet, or a before/after split");
    command.add("in", options->in, "picture, any format that OpenImageIO reads").required();
    command.add("operators", options->operators,
                "operator[:preset][:name=value...], look=ID among the values; without any: "
                "the views of the OpenColorIO config");
    command.add("-o", options->file, "file to write; the extension says the format").required();
    command.add("--exposure", options->exposure, "stops, the same for all").show_default();
    command
        .add("--input", options->input,
             "what the picture's numbers are: `auto`, what it says, or a name as in `apply`")
        .show_default();
    const Option pictures =
        command.add("--pictures", options->pictures,
                    "folder for the pictures at full size: 8-bit PNG files with the names of the "
                    "operators");
    const Option columns =
        command.add("--columns", options->columns, "pictures a row; default: as fits")
            .range(1, 100);
    const Option cell_width =
        command.add("--cell-width", options->cell_width, "of each picture, pixels")
            .show_default()
            .range(16, 16384);
    const Option false_color =
        command.add_flag("--false-color", options->has_false_color,
                         "one more picture: where the light is, a color for every stop, with a "
                         "legend");
    const Option difference =
        command
            .add("--difference", options->difference,
                 "one more picture, of two operators: their absolute difference in code "
                 "values, times this")
            .range(0.1, 1000.0);
    const Option split =
        command
            .add("--split", options->split,
                 "no sheet: the whole picture, two operators side by side, the first up to "
                 "this part of the width")
            .range(0.0, 1.0);
    command.add_flag("--horizontal", options->is_horizontal, "split the height: the first above")
        .needs(split);
    command.add_flag("--no-labels", options->has_no_labels, "the split without its line and labels")
        .needs(split);
    for (const Option& other : {pictures, columns, cell_width, false_color, difference})
        split.excludes(other);
    command.footer(
        "The sheet's scene is scaled to the cells in linear light before the operators see it; "
        "statistics\nthat an operator takes are those of the whole picture. A split has the pixels "
        "that `apply` writes.\n"
        "Examples:\n"
        "  tonewright compare render.exr -o sheet.png --false-color\n"
        "  tonewright compare render.exr hable:white=4 hable:white=11.2 --exposure 1 -o sheet.jpg\n"
        "  tonewright compare render.exr clamp agx_blender --split 0.5 -o split.png");
    command.action([options] {
        picture_commands().compare(*options);
        return kOk;
    });
}

TONEWRIGHT_NAMESPACE_END
