// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "cli/picture_commands.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// --frames, --missing, --skip-existing, --jobs. @returns  the first
Option add_frame_options(const Command& command, FrameOptions& options) {
    const char* const group = "Frames of a shot";
    const Option frames = command.add(
        "--frames", options.frames,
        "frames such as 1001-1100, 1-9x2 or 1,5,10-20; IN and OUT have %04d, #### or @@@@ for the "
        "number");
    frames.value("RANGE").group(group);
    command
        .add_flag("--skip-existing", options.skip_existing,
                  "skip frames whose output is complete and up to date")
        .group(group)
        .needs(frames);
    command
        .add("--missing", options.missing,
             "missing input frames: `error`, `skip`, or `hold` (use the last earlier frame)")
        .value("ACTION")
        .suggest({"error", "skip", "hold"})
        .show_default()
        .group(group)
        .needs(frames);
    command
        .add("--jobs", options.jobs,
             "number of frames processed at a time; 0 is the number of threads")
        .value("N")
        .show_default()
        .range(0, 256)
        .group(group)
        .needs(frames);
    return frames;
}

/// Options for writing the file.
void add_file_options(const Command& command, ApplyOptions& options) {
    const char* const group = "Output";
    command.add("-d", options.type, "uint8, uint16, half or float; for DPX uint10, uint12")
        .value("TYPE")
        .suggest({"uint8", "uint10", "uint12", "uint16", "half", "float"})
        .group(group);
    command
        .add("--alpha", options.alpha,
             "`keep`, `ignore` (leave out), `opaque` (1) or `over:R,G,B` (put over code values)")
        .value("ACTION")
        .suggest({"keep", "ignore", "opaque", "over:0,0,0"})
        .show_default()
        .group(group);
    command.add_flag("--in-place", options.is_in_place, "allow the output to replace the input")
        .group(group);
    command
        .add("--compression", options.compression,
             "compression of the format, as in oiiotool: zip, dwaa:60, lzw, jpeg:90, ...")
        .value("NAME")
        .group(group);
    command
        .add("--quality", options.quality,
             "quality of JPEG, WebP, HEIC and DWA (default: the format's)")
        .value("N")
        .range(1, 100)
        .group(group);
    command
        .add("--subsampling", options.subsampling,
             "chroma of a JPEG: 4:4:4, 4:2:2, 4:2:0 or 4:1:1 (default 4:4:4 from quality 90 on, "
             "else 4:2:0)")
        .value("RATIO")
        .suggest({"4:4:4", "4:2:2", "4:2:0", "4:1:1"})
        .group(group);
    command
        .add_flag("--verify-output", options.verifies_output,
                  "read the written file and compare all pixels before it replaces the old one")
        .group(group);
    command
        .add_flag("--no-metadata", options.has_no_metadata,
                  "do not write version, operator, exposure and display into the file")
        .group(group);
}

}  // namespace

void add_apply(CommandLine& program) {
    auto options = std::make_shared<ApplyOptions>();
    const Command command = program.add("apply", "Tone map a picture or the frames of a shot.");
    command.group("Pictures");
    command
        .add("in", options->pictures,
             "pictures, folders or @FILE (one name a line); without -o, the last one is the output")
        .required();
    command.add("-o,--output", options->output, "picture to write, or folder for several pictures")
        .value("OUT")
        .group("Output");
    command.add("--format", options->format, "extension of the pictures in a folder")
        .value("EXT")
        .suggest({"exr", "png", "tif", "jpg", "webp", "dpx"})
        .group("Output");
    const Option op =
        command.add("--operator", options->op, "operator[:preset], file or formula (default AgX)");
    op.value("NAME").suggest(suggest_operators).group("Operator");
    options->input = "auto";
    add_view_options(command, *options);
    command.option("--input")
        .describe("color space (`tonewright list --inputs`), or `auto`, as the file says")
        .suggest(suggest_source_colors);
    command.option("--exposure").group("Exposure");
    const Option false_color =
        command.add_flag("--false-color", options->is_false_color,
                         "show exposure as colors, one for every stop (operator false_color)");
    false_color.group("Operator").excludes(op);
    const Option legend = command.add_flag("--legend", options->has_legend,
                                           "draw what the colors mean below the picture");
    legend.group("Operator").needs(false_color);
    command
        .add("--statistics", options->statistics,
             "operators measure each `picture`, the whole `sequence`, or use `defaults`")
        .value("NAME")
        .suggest({"picture", "sequence", "defaults"})
        .show_default()
        .group("Operator");
    command
        .add("--mix", options->mix,
             "share of the operator; the rest is a plain clamp, blended in code values")
        .value("SHARE")
        .show_default()
        .range(0.0, 1.0)
        .group("Operator");
    add_file_options(command, *options);
    command
        .add_flag("--dither", options->dither,
                  "dither 8-bit output by half a code value, alike in every frame")
        .group("Pictures");
    add_resize(command, options->resize, "Pictures");
    add_picture_input(command, options->picture);
    command.option("--max-pixels")
        .describe("most pixels of a picture (default 1e9) or of a window filled with black (1e8)");
    const Option metered = command
                               .add("--auto-exposure", options->metering.method,
                                    "meter the picture: log-average, histogram, mean or max; "
                                    "--exposure is added")
                               .value("METHOD")
                               .suggest({"log-average", "histogram", "mean", "max"})
                               .group("Exposure");
    const Option frames = add_frame_options(command, options->frames);
    for (const char* other : {"--frames", "--subimage", "--timeout"})
        legend.excludes(command.option(other));
    add_exposure_options(command, options->metering, &metered);
    add_shot_options(command, options->shot, frames, &metered);
    add_lut_options(
        command, options->lut, op,
        {"--set", "--look", "--display", "--reference-white", "--statistics", "--frames",
         "--false-color", "--mix", "--auto-exposure", "--subimage", "--dither", "--timeout"});
    command.common({"-o", "--format", "--operator", "--set", "--look", "--exposure",
                    "--auto-exposure", "--input", "--display", "-d", "--frames", "--skip-existing",
                    "--lut", "--input-encoding"});
    command.footer(
        "Examples:\n"
        "  tonewright apply render.exr out.png --operator hable --exposure 1\n"
        "  tonewright apply *.exr -o out/ --format png --operator \"AgX Punchy\"\n"
        "  tonewright apply shot.####.exr out.####.png --frames 1001-1100\n"
        "  tonewright apply render.exr out.png --lut agx.cube --input-encoding acescct");
    command.action([options, command] {
        options->given = command.given();
        return picture_commands().apply(*options);
    });
}

TONEWRIGHT_NAMESPACE_END
