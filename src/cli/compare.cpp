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
        "compare", "Pictures",
        "Show a picture through several operators: a contact sheet or a split picture.");
    command.argument("in", &options->in, "a picture, in any format that OpenImageIO reads",
                     {.is_required = true});
    command.argument(
        "operators", &options->operators,
        "NAME[:PRESET][:PARAMETER=VALUE...][:look=LOOK] (default: the views of the config)",
        {.suggest = suggest_operators});
    command.title("Output");
    command.add("-o", "FILE", &options->file, "file to write; its extension sets the format",
                {.is_required = true});
    command.add("--exposure", "STOPS", &options->exposure,
                "exposure before the operators, in stops");
    add_light_options(command, options->light);
    command.title("Picture");
    add_resize(command, options->resize);
    add_picture_choice(command, options->picture);
    command.title("Contact sheet");
    command.add("--columns", "N", &options->columns, "pictures in a row (default: as fits)",
                {.range = {{1, 100}}});
    command.add("--cell-width", "N", &options->cell_width, "width of a picture in pixels",
                {.range = {{16, 16384}}});
    command.add_flag("--false-color", &options->has_false_color,
                     "add a picture of exposure as colors, one for every stop, with a legend");
    command.add("--difference", "FACTOR", &options->difference,
                "add the absolute difference of two operators in code values, times this",
                {.range = {{0.1, 1000.0}}});
    command.add("--pictures", "FOLDER", &options->pictures,
                "folder for the pictures at full size, as 8-bit PNG files");
    add_progress(command);
    command.title("Split picture");
    command.add(
        "--split", "FRACTION", &options->split,
        "show two operators in one picture; the first fills this fraction of the width",
        {.range = {{0.0, 1.0}},
         .excludes = {"--columns", "--cell-width", "--false-color", "--difference", "--pictures"}});
    command.add_flag("--horizontal", &options->is_horizontal, "split the height, the first on top",
                     {.needs = {"--split"}});
    command.add_flag("--no-labels", &options->has_no_labels, "leave out the line and the labels",
                     {.needs = {"--split"}});
    command.footer(
        "A sheet scales the scene in linear light before the operators. Operators that measure "
        "the picture measure all of it. A split has the pixels of `tonewright apply`.\n"
        "Examples:\n"
        "  tonewright compare render.exr -o sheet.png --false-color\n"
        "  tonewright compare render.exr hable:white=4 hable:white=11.2 -o sheet.jpg\n"
        "  tonewright compare render.exr clamp agx_blender --split 0.5 -o split.png");
    command.action(
        [options] {
            const ResultLine line;
            picture_commands().compare(*options);
            line.print(fmt::format("compare: {} -> {}", options->in, options->file));
            return kOk;
        },
        &options->given);
}

void add_sheet(CommandLine& program) {
    auto options = std::make_shared<SheetOptions>();
    const Command command =
        program.add("sheet", "Pictures", "Arrange pictures with labels on a contact sheet.");
    command.argument("pictures", &options->pictures,
                     "LABEL=FILE: label and display-encoded picture", {.is_required = true});
    command.title("Output");
    command.add("-o", "FILE", &options->file, "file to write", {.is_required = true});
    command.add("--columns", "N", &options->columns, "pictures in a row", {.range = {{1, 100}}});
    command.add("--cell-width", "N", &options->cell_width, "width of a picture in pixels",
                {.range = {{16, 16384}}});
    command.title("Pictures");
    add_picture_choice(command, options->choice);
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
    const Command command = program.add(
        "chart", "Pictures", "Write the synthetic HDR test chart, in scene-linear Rec.709.");
    command.title("Output");
    command.add("-o", "FILE", &options->file, "file to write (.exr)", {.is_required = true});
    command.add("--width", "N", &options->width, "width in pixels");
    command.add("--height", "N", &options->height, "height in pixels");
    command.add("-d", "TYPE", &options->type, "pixel type: half or float",
                {.suggest = one_of({"half", "float"})});
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
