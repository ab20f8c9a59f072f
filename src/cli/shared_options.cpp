// SPDX-License-Identifier: Apache-2.0
#include "cli/shared_options.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_view_options(const Command& command, ViewOptions& options) {
    command.add("--set", options.set, "operator parameter, name=value; repeat for more")
        .one_value_each();
    command.add("--look", options.look, "look of the operator");
    command.add("--exposure", options.exposure, "stops, before the operator").show_default();
    command.add("--input", options.input, "scene-linear space of the input").show_default();
    command
        .add("--display", options.display,
             "display, or `linear` (display-linear Rec.709, unclamped), or `native` (the "
             "operator's own output)")
        .show_default();
    command
        .add("--reference-white", options.reference_white,
             "what an HDR display shows light 1 at, cd/m2; 203 as BT.2408 has it")
        .show_default();
}

void add_lut_options(const Command& command, LutOptions& options, const Option& op,
                     const std::vector<std::string>& others) {
    const Option lut = command.add("--lut", options.file,
                                   "instead of an operator a LUT, anybody's: through "
                                   "OpenColorIO .cube, .clf, .ctf, .csp, .3dl, "
                                   ".spi1d, .spi3d, .lut, .itx, .spimtx and .cc, ICC device "
                                   "links (.icc), raw floats (.raw), Hald "
                                   "CLUTs and strips (pictures)");
    lut.excludes(op);
    for (const std::string& other : others)
        lut.excludes(command.option(other));
    command
        .add("--interpolation", options.interpolation,
             "between the nodes of a cube: tetrahedral, trilinear, or auto: what the file says, "
             "else tetrahedral")
        .show_default()
        .needs(lut);
    command
        .add("--input-encoding", options.encoding,
             "what the LUT expects (see `tonewright bake --help`): the light is encoded so; "
             "without it colors go in as they are")
        .needs(lut);
    command
        .add("--lut-space", options.space,
             "scene-linear space that the LUT's input is of; default: its encoding's own")
        .needs(lut);
}

void add_picture_input(const Command& command, PictureInput& options) {
    command
        .add("--threads", options.threads,
             "threads that read, compute and write; 0 = all cores, 1 = one after the other")
        .show_default()
        .range(0, 1024);
    command
        .add("--subimage", options.subimage, "which part of a multi-part file (view, page), from 0")
        .show_default()
        .range(0, 1 << 20);
    const Option yes = command.add_flag(
        "--unpremult", options.unpremult,
        "divide color by alpha first (`apply` multiplies after); default: as the picture says");
    command.add_flag("--no-unpremult", options.no_unpremult, "take color as it is").excludes(yes);
}

void add_exposure_options(const Command& command, ExposureOptions& options, const Option* method) {
    const auto add = [&](const char* name, auto& value, const char* help) {
        const Option option = command.add(name, value, help);
        if (method) option.needs(*method);
        option.group("Metering");
        return option;
    };
    add(method ? "--meter-region" : "--region,--meter-region", options.region,
        "pixels that count: x,y,width,height; default: all");
    add("--delta", options.delta,
        "added to each luminance inside the logarithm of the log average, and the least metered "
        "luminance")
        .show_default();
    add("--percentiles", options.percentiles,
        "the histogram's average is that of the pixels between, such as 40,95")
        .show_default();
    add("--histogram-range", options.histogram_range, "log2 of luminance").show_default();
    add("--histogram-bins", options.histogram_bins, "the first is black").show_default();
    const Option exact = command.add_flag(
        "--exact", options.exact,
        "percentiles and the average between them from all luminances, not from bins");
    exact.group("Metering");
    if (method) exact.needs(*method);
    add("--key", options.key,
        "what the metered luminance becomes, or `auto`; default: 0.18, of max: 1");
    add("--calibration", options.calibration,
        "`key`, or `9.6`: as a camera that saturates at 9.6 times the metered luminance")
        .show_default();
    add("--compensation", options.compensation, "stops on top of what is metered").show_default();
    add("--exposure-limits", options.limits,
        "stops that the metered exposure is held between, before compensation")
        .show_default();
}

void add_shot_options(const Command& command, ShotOptions& options, const Option& frames,
                      const Option* method) {
    const char* const group = "Metering of shots";
    const Option adapt = command.add_flag("--adapt", options.adapt,
                                          "exposure follows the light of the shot, as an eye does");
    adapt.needs(frames).group(group);
    if (method) adapt.needs(*method);
    const auto add = [&](const char* name, auto& value, const char* help, const Option& needed) {
        return command.add(name, value, help).needs(needed).group(group);
    };
    add("--adapt-up", options.up,
        "speed towards more light, per second; default: 1.1, of 0.98: a factor, 1", adapt);
    add("--adapt-down", options.down, "speed towards less light; default: as --adapt-up's", adapt);
    add("--adapt-form", options.form,
        "`exponential`: 1 - e^(-speed dt), or `0.98`: 1 - 0.98^(30 speed dt)", adapt)
        .show_default();
    add("--fps", options.fps, "frames per second", adapt).show_default();
    add("--adapt-start", options.start,
        "exposure of the first frame, stops; default: what it is metered at", adapt);
    add("--meter-frames", options.meter_frames,
        "the whole shot, where --frames is a part of it: all parts have the same exposures",
        frames);
    command
        .add("--meter-cache", options.cache,
             "file to keep what was metered in; frames that have changed since are metered "
             "again")
        .group(group);
}

TONEWRIGHT_NAMESPACE_END
