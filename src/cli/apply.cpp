// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "cli/picture_commands.h"
#include "cli/shared_options.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// --frames, --missing, --skip-existing, --jobs. @returns  the first
Option add_frame_options(const Command& command, FrameOptions& options) {
    const Option frames = command.add(
        "--frames", options.frames,
        "frames such as 1001-1100, 1-9x2 (every second) or 1,5,10-20: `in` and `out` "
        "have %04d, #### (# is four digits, too) or @@@@ (as many digits; in the file's name) "
        "where "
        "the number stands. The exit code is 1 if any failed; the others are whole");
    command
        .add("--missing", options.missing,
             "frames whose `in` is not there: `error` (they fail), `skip` (they are left out) or "
             "`hold` (the nearest earlier frame that is there stands for them, as in players; it "
             "need not be of --frames; without one in the 1000 before they fail)")
        .show_default()
        .needs(frames);
    command
        .add_flag(
            "--skip-existing", options.skip_existing,
            "leave frames whose `out` is newer than `in`, has the size and pixel type that it "
            "would get and can be read to its end: goes on where a run was stopped. It does "
            "not know the options of that run: after a change of operator, exposure, display "
            "... leave it out, or remove the files")
        .needs(frames);
    command
        .add("--jobs", options.jobs,
             "frames at a time, each with memory of its own; the --threads are shared among "
             "them. 0 = as many as threads")
        .show_default()
        .range(0, 256)
        .needs(frames);
    return frames;
}

}  // namespace

void add_apply(CommandLine& program) {
    auto options = std::make_shared<ApplyOptions>();
    const Command command = program.add("apply", "tone map a picture, or the frames of a shot");
    command.add("in", options->in, "picture, any format that OpenImageIO reads").required();
    command.add("out", options->out, "picture to write; the extension says the format").required();
    const Option op = command.add("--operator", options->op, "operator, or operator:preset");
    const Option false_color =
        command.add_flag("--false-color", options->is_false_color,
                         "where the light is: a color for every stop, the operator false_color");
    false_color.excludes(op);
    const Option frames = add_frame_options(command, options->frames);
    options->input = "auto";
    add_view_options(command, *options);
    command.option("--input").describe(
        "what the input's numbers are: `auto`, what the picture says (`oiio:ColorSpace`, "
        "chromaticities, ...; linear Rec.709 where it says nothing), a scene-linear space, or "
        "sRGB, "
        "Rec709, Gamma2.2 or a display, whose code values are decoded");
    command.add("-d", options->type, "pixel type of the output: uint8, uint16, half or float");
    command
        .add("--statistics", options->statistics,
             "parameters that a picture has (its largest luminance, ...) and --set does "
             "not name: each `picture`'s own, those of the `sequence` of --frames, or "
             "`defaults`")
        .show_default();
    add_picture_input(command, options->picture);
    command.add_flag("--dither", options->dither,
                     "noise of half a code value against bands, in files of 8 bits; the same in "
                     "every frame");
    const Option metered = command
                               .add("--auto-exposure", options->metering.method,
                                    "exposure from the picture's light: log-average, "
                                    "histogram, mean or max; --exposure comes on top")
                               .group("Metering");
    add_exposure_options(command, options->metering, &metered);
    add_shot_options(command, options->shot, frames, &metered);
    add_lut_options(command, options->lut, op,
                    {"--set", "--look", "--display", "--reference-white", "--statistics",
                     "--frames", "--false-color", "--auto-exposure", "--subimage", "--dither"});
    command.footer(
        "Examples:\n"
        "  tonewright apply render.exr out.png --operator hable --exposure 1 -d uint8\n"
        "  tonewright apply shot.%04d.exr out.####.png --frames 1001-1100 --operator agx_blender\n"
        "  tonewright apply in.@@@@.exr out.@@@@.png --frames 1-99x2 --operator hable "
        "--skip-existing\n"
        "  tonewright apply render.exr out.png --lut agx.cube --input-encoding acescct -d uint8");
    command.action([options, command] {
        options->given = command.given();
        return picture_commands().apply(*options);
    });
}

TONEWRIGHT_NAMESPACE_END
