// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "cli/picture_commands.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// --frames, --missing, --skip-existing, --jobs.
void add_frame_options(const Command& command, FrameOptions& options) {
    command.title("Frames of a shot");
    command.add(
        "--frames", "RANGE", &options.frames,
        "frames such as 1001-1100, 1-9x2 or 1,5,10-20; IN and OUT have %04d, #### or @@@@ for the "
        "number");
    command.add_flag("--skip-existing", &options.skip_existing,
                     "skip frames whose output is complete and up to date",
                     {.needs = {"--frames"}});
    command.add("--missing", "ACTION", &options.missing,
                "missing input frames: `error`, `skip`, or `hold` (use the last earlier frame)",
                {.suggest = one_of({"error", "skip", "hold"}), .needs = {"--frames"}});
    command.add("--jobs", "N", &options.jobs,
                "frames at a time, each with about 40 MB; 0 is the number of threads",
                {.range = {{0, 256}}, .needs = {"--frames"}});
}

/// Options for writing the file.
void add_file_options(const Command& command, ApplyOptions& options) {
    command.title("Output");
    command.add("-d", "TYPE", &options.type, "uint8, uint16, half or float; for DPX uint10, uint12",
                {.suggest = one_of({"uint8", "uint10", "uint12", "uint16", "half", "float"})});
    command.add("--alpha", "ACTION", &options.alpha,
                "`keep`, `ignore` (leave out), `opaque` (1) or `over:R,G,B` (put over code values)",
                {.suggest = one_of({"keep", "ignore", "opaque", "over:0,0,0"})});
    command.add_flag("--in-place", &options.is_in_place, "allow the output to replace the input");
    command.add("--compression", "NAME", &options.compression,
                "compression of the format, as in oiiotool: zip, dwaa:60, lzw, jpeg:90, ...");
    command.add("--quality", "N", &options.quality,
                "quality of JPEG, WebP, HEIC and DWA (default: the format's)",
                {.range = {{1, 100}}});
    command.add("--subsampling", "RATIO", &options.subsampling,
                "chroma of a JPEG: 4:4:4, 4:2:2, 4:2:0 or 4:1:1 (default 4:4:4 from quality 90 on, "
                "else 4:2:0)",
                {.suggest = one_of({"4:4:4", "4:2:2", "4:2:0", "4:1:1"})});
    command.add_flag("--verify-output", &options.verifies_output,
                     "read the written file and compare all pixels before it replaces the old one");
    command.add_flag("--no-metadata", &options.has_no_metadata,
                     "do not write version, operator, exposure and display into the file");
}

}  // namespace

void add_apply(CommandLine& program) {
    auto options = std::make_shared<ApplyOptions>();
    const Command command =
        program.add("apply", "Pictures", "Tone map a picture or the frames of a shot.");
    command.argument(
        "in", &options->pictures,
        "pictures, folders or @FILE (one name a line); without -o, the last one is the output",
        {.is_required = true});
    command.title("Output");
    command.add("-o,--output", "OUT", &options->output,
                "picture to write, or folder for several pictures");
    command.add("--format", "EXT", &options->format, "extension of the pictures in a folder",
                {.suggest = one_of({"exr", "png", "tif", "jpg", "webp", "dpx"})});
    command.title("Operator");
    command.add("--operator", "NAME", &options->op,
                "operator[:preset], file or formula (default AgX)", {.suggest = suggest_operators});
    options->input = "auto";
    add_view_options(command, *options, "Exposure");
    command.describe("--input",
                     "color space (`tonewright list --inputs`), or `auto`, as the file says",
                     suggest_source_colors);
    command.title("Operator");
    command.add_flag("--false-color", &options->is_false_color,
                     "show exposure as colors, one for every stop (operator false_color)",
                     {.excludes = {"--operator"}});
    command.add_flag("--legend", &options->has_legend,
                     "draw what the colors mean below the picture", {.needs = {"--false-color"}});
    command.add("--statistics", "NAME", &options->statistics,
                "operators measure each `picture`, the whole `sequence`, or use `defaults`",
                {.suggest = one_of({"picture", "sequence", "defaults"})});
    command.add("--mix", "SHARE", &options->mix,
                "share of the operator; the rest is a plain clamp, blended in code values",
                {.range = {{0.0, 1.0}}});
    add_file_options(command, *options);
    add_progress(command);
    command.title("Pictures");
    command.add_flag("--dither", &options->dither,
                     "dither 8-bit output by half a code value, alike in every frame");
    add_resize(command, options->resize);
    add_picture_input(command, options->picture);
    command.describe(
        "--max-pixels",
        "most pixels of a picture (default 1e9) or of a window filled with black (1e8)");
    command.title("Exposure");
    command.add("--auto-exposure", "METHOD", &options->metering.method,
                "meter the picture: log-average, histogram, mean or max; "
                "--exposure is added",
                {.suggest = one_of({"log-average", "histogram", "mean", "max"})});
    add_frame_options(command, options->frames);
    command.exclude("--legend", {"--frames", "--subimage", "--timeout"});
    add_exposure_options(command, options->metering, {"--auto-exposure"});
    add_shot_options(command, options->shot, {"--auto-exposure"});
    add_lut_options(command, options->lut,
                    {"--operator", "--set", "--look", "--display", "--reference-white",
                     "--statistics", "--frames", "--false-color", "--mix", "--auto-exposure",
                     "--subimage", "--dither", "--timeout"});
    command.common({"-o", "--format", "--operator", "--set", "--look", "--exposure",
                    "--auto-exposure", "--input", "--display", "-d", "--frames", "--skip-existing",
                    "--lut", "--input-encoding"});
    command.footer(
        "Examples:\n"
        "  tonewright apply render.exr out.png --operator hable --exposure 1\n"
        "  tonewright apply *.exr -o out/ --format png --operator \"AgX Punchy\"\n"
        "  tonewright apply shot.####.exr out.####.png --frames 1001-1100\n"
        "  tonewright apply render.exr out.png --lut agx.cube --input-encoding acescct");
    command.action(
        [options]() -> int {
            if (row_commands().apply(*options)) return kOk;
            return picture_commands().apply(*options);
        },
        &options->given);
}

TONEWRIGHT_NAMESPACE_END
