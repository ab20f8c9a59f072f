// SPDX-License-Identifier: Apache-2.0
#include "cli/shared_options.h"
#include "cli/suggestions.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_operator_options(const Command& command, ViewOptions& options) {
    const char* const op = "Operator";
    command.add("--set", options.set, "operator parameter; repeat for more")
        .value("NAME=VALUE")
        .suggest(suggest_settings)
        .one_value_each()
        .group(op);
    command.add("--look", options.look, "look of the operator")
        .value("NAME")
        .suggest(suggest_looks)
        .group(op);
}

void add_view_options(const Command& command, ViewOptions& options) {
    const char* const color = "Color";
    add_operator_options(command, options);
    command.add("--exposure", options.exposure, "exposure before the operator, in stops")
        .value("STOPS")
        .show_default()
        .group("Operator");
    command.add("--input", options.input, "scene-linear color space of the input")
        .value("SPACE")
        .suggest(suggest_spaces)
        .show_default()
        .group(color);
    command
        .add("--display", options.display,
             "display, `linear` (unclamped Rec.709) or `native` (output of the operator)")
        .value("NAME")
        .suggest(suggest_displays)
        .show_default()
        .group(color);
    add_input_units(command, options.input_units, options.reference_white, color);
    command.option("--reference-white")
        .describe("luminance of scene-linear 1.0 in absolute inputs and on HDR displays");
}

void add_input_units(const Command& command, std::string& units, double& reference_white,
                     const char* group) {
    command
        .add("--input-units", units, "units of linear input: `relative` (1.0 is white) or `cd/m2`")
        .value("UNITS")
        .suggest({"relative", "cd/m2"})
        .show_default()
        .group(group);
    command
        .add("--reference-white", reference_white,
             "luminance that becomes 1.0, of PQ, HLG and cd/m2")
        .value("CD/M2")
        .show_default()
        .group(group);
}

void add_lut_input_options(const Command& command, LutOptions& options, const char* group) {
    command
        .add("--input-encoding", options.encoding,
             "encoding that the LUT expects (see `bake --help`), or `none` (default: that of the "
             "LUT's header)")
        .value("NAME")
        .suggest(suggest_encodings)
        .group(group);
    command
        .add("--lut-space", options.space,
             "scene-linear space of the LUT's input (default: that of its encoding)")
        .value("SPACE")
        .suggest(suggest_spaces)
        .group(group);
}

void add_lut_options(const Command& command, LutOptions& options, const Option& op,
                     const std::vector<std::string>& others) {
    const char* const group = "LUT, or LUT as the operator";
    const Option lut =
        command.add("--lut", options.file, "LUT file (.cube, .clf, .csp, .icc, Hald CLUT, ...)");
    lut.value("FILE").group(group).excludes(op);
    for (const std::string& other : others)
        lut.excludes(command.option(other));
    add_lut_input_options(command, options, group);
    command
        .add("--interpolation", options.interpolation,
             "between grid points: tetrahedral, trilinear, or auto, as the file says")
        .value("NAME")
        .suggest({"tetrahedral", "trilinear", "auto"})
        .show_default()
        .group(group)
        .needs(lut);
}

Option add_max_pixels(const Command& command, std::optional<double>& value) {
    return command
        .add("--max-pixels", value, "most pixels that a picture may declare (default 1e9)")
        .value("N")
        .range(1, 1e12);
}

void add_resize(const Command& command, std::string& resize, const char* group) {
    command
        .add("--resize", resize,
             "resize first, in linear light (Lanczos): 1920x1080, 1920 (the width) or 50%")
        .value("SIZE")
        .suggest({"1920x1080", "1920", "50%"})
        .group(group);
}

void add_picture_choice(const Command& command, PictureChoice& choice, const char* group) {
    command
        .add("--layer", choice.layer,
             "layer of an EXR file (default: R, G, B, else the first that is a picture)")
        .value("NAME")
        .group(group);
    command
        .add("--subimage", choice.subimage,
             "part or page: its name or its number from 0 (default: the first picture)")
        .value("N")
        .group(group);
    add_max_pixels(command, choice.max_pixels).group(group);
}

void add_picture_input(const Command& command, PictureInput& options) {
    const char* const group = "Pictures";
    command.add("--threads", options.threads, "number of threads; 0 uses all cores")
        .value("N")
        .show_default()
        .range(0, 1024)
        .group(group);
    command
        .add("--timeout", options.timeout,
             "seconds that a picture may take; each gets a process of its own (default: no limit)")
        .value("SECONDS")
        .range(0.1, 1e6)
        .group(group);
    add_picture_choice(command, options, group);
    const Option yes =
        command.add_flag("--unpremult", options.unpremult,
                         "divide color by alpha first (default: if the alpha is associated)");
    yes.group(group);
    command.add_flag("--no-unpremult", options.no_unpremult, "do not un-premultiply color")
        .group(group)
        .excludes(yes);
}

void add_exposure_options(const Command& command, ExposureOptions& options, const Option* method) {
    const char* group = "Exposure";
    const auto add = [&](const char* name, auto& value, const char* value_name, const char* help) {
        const Option option = command.add(name, value, help);
        if (method) option.needs(*method);
        option.value(value_name).group(group);
        return option;
    };
    add("--key", options.key, "VALUE",
        "target for the metered luminance, or `auto` (default 0.18; 1 with `max`)");
    add("--compensation", options.compensation, "STOPS", "stops on top of the metered exposure")
        .show_default();
    add("--exposure-limits", options.limits, "LOW,HIGH",
        "limits of the metered exposure, in stops, before compensation")
        .show_default();
    add("--calibration", options.calibration, "VALUE",
        "`key`, or 9.6: a camera that saturates at 9.6 times the metered luminance")
        .show_default();
    add(method ? "--meter-region" : "--region,--meter-region", options.region, "X,Y,W,H",
        "metered pixels: x, y, width, height (default: all)");
    group = "Metering";
    add("--delta", options.delta, "VALUE",
        "added to each luminance inside the logarithm; also the least metered luminance")
        .show_default();
    add("--percentiles", options.percentiles, "LOW,HIGH",
        "percentiles between which `histogram` averages, such as 40,95")
        .show_default();
    add("--histogram-range", options.histogram_range, "LOW,HIGH",
        "range in log2 of luminance (default -8,3.5, and more if needed)");
    add("--histogram-bins", options.histogram_bins, "N",
        "number of histogram bins in that range; the first holds black")
        .show_default();
    const Option exact =
        command.add_flag("--exact", options.exact,
                         "compute percentiles and averages from all luminances, not from bins");
    exact.group(group);
    if (method) exact.needs(*method);
}

void add_shot_options(const Command& command, ShotOptions& options, const Option& frames,
                      const Option* method) {
    const char* const group = "Exposure of shots";
    const Option adapt = command.add_flag("--adapt", options.adapt,
                                          "adapt exposure from frame to frame, as an eye does");
    adapt.needs(frames).group(group);
    if (method) adapt.needs(*method);
    const auto add = [&](const char* name, auto& value, const char* value_name, const char* help,
                         const Option& needed) {
        return command.add(name, value, help).value(value_name).needs(needed).group(group);
    };
    add("--adapt-up", options.up, "SPEED",
        "adaptation speed when the scene gets brighter, per second (default 1.1; 1 with "
        "`--adapt-form 0.98`)",
        adapt);
    add("--adapt-down", options.down, "SPEED",
        "adaptation speed when the scene gets darker (default: as --adapt-up)", adapt);
    add("--adapt-form", options.form, "NAME",
        "`exponential` (1 - e^(-speed dt)) or `0.98` (1 - 0.98^(30 speed dt))", adapt)
        .suggest({"exponential", "0.98"})
        .show_default();
    add("--adapt-start", options.start, "STOPS",
        "exposure of the first frame (default: its metered exposure)", adapt);
    add("--fps", options.fps, "N", "frames per second", adapt).show_default();
    add("--meter-frames", options.meter_frames, "RANGE",
        "frames of the whole shot, if --frames names only some of them", frames);
    command
        .add("--meter-cache", options.cache,
             "file that keeps metered luminances; changed frames are metered again")
        .value("FILE")
        .group(group);
}

TONEWRIGHT_NAMESPACE_END
