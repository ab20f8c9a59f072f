// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>

#include "cli/messages.h"
#include "cli/options.h"
#include "cli/picture_commands.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_compare(CommandLine& program) {
    auto options = std::make_shared<CompareOptions>();
    const Command command = program.add(
        "compare", "Show a picture through several operators: a contact sheet or a split picture.");
    command.group("Pictures");
    const char* const output = "Output";
    const char* const sheet = "Contact sheet";
    const char* const split_group = "Split picture";
    command.add("in", options->in, "a picture, in any format that OpenImageIO reads").required();
    command
        .add("operators", options->operators,
             "NAME[:PRESET][:PARAMETER=VALUE...][:look=LOOK] (default: the views of the config)")
        .suggest(suggest_operators);
    command.add("-o", options->file, "file to write; its extension sets the format")
        .value("FILE")
        .required()
        .group(output);
    command.add("--exposure", options->exposure, "exposure before the operators, in stops")
        .value("STOPS")
        .show_default()
        .group(output);
    command
        .add("--input", options->input,
             "color space (`tonewright list --inputs`), or `auto`, as the file says")
        .value("SPACE")
        .suggest(suggest_source_colors)
        .show_default()
        .group(output);
    add_input_units(command, options->input_units, options->reference_white, output);
    add_resize(command, options->resize, "Picture");
    add_picture_choice(command, options->picture, "Picture");
    const Option columns =
        command.add("--columns", options->columns, "pictures in a row (default: as fits)")
            .value("N")
            .range(1, 100);
    const Option cell_width =
        command.add("--cell-width", options->cell_width, "width of a picture in pixels")
            .value("N")
            .show_default()
            .range(16, 16384);
    const Option false_color =
        command.add_flag("--false-color", options->has_false_color,
                         "add a picture of exposure as colors, one for every stop, with a legend");
    const Option difference =
        command
            .add("--difference", options->difference,
                 "add the absolute difference of two operators in code values, times this")
            .value("FACTOR")
            .range(0.1, 1000.0);
    const Option pictures = command
                                .add("--pictures", options->pictures,
                                     "folder for the pictures at full size, as 8-bit PNG files")
                                .value("FOLDER");
    const Option split =
        command
            .add("--split", options->split,
                 "show two operators in one picture; the first fills this fraction of the width")
            .value("FRACTION")
            .range(0.0, 1.0);
    split.group(split_group);
    command.add_flag("--horizontal", options->is_horizontal, "split the height, the first on top")
        .group(split_group)
        .needs(split);
    command.add_flag("--no-labels", options->has_no_labels, "leave out the line and the labels")
        .group(split_group)
        .needs(split);
    for (const Option& other : {columns, cell_width, false_color, difference, pictures}) {
        other.group(sheet);
        split.excludes(other);
    }
    command.footer(
        "A sheet scales the scene in linear light before the operators. Operators that measure "
        "the picture measure all of it. A split has the pixels of `tonewright apply`.\n"
        "Examples:\n"
        "  tonewright compare render.exr -o sheet.png --false-color\n"
        "  tonewright compare render.exr hable:white=4 hable:white=11.2 -o sheet.jpg\n"
        "  tonewright compare render.exr clamp agx_blender --split 0.5 -o split.png");
    command.action([options, command] {
        const ResultLine line;
        options->is_resized = command.given().contains("--resize");
        picture_commands().compare(*options);
        line.print(fmt::format("compare: {} -> {}", options->in, options->file));
        return kOk;
    });
}

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
