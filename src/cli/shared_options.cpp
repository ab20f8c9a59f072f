// SPDX-License-Identifier: Apache-2.0
#include "cli/shared_options.h"

#include "cli/messages.h"
#include "cli/suggestions.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_operator_argument(const Command& command, std::string& op, bool is_required) {
    command.argument("operator", &op, "operator, operator:preset, .tone file, LUT or formula",
                     {.suggest = suggest_operators, .is_required = is_required});
}

void add_operator_options(const Command& command, ViewOptions& options) {
    command.title("Operator");
    command.add("--set", "NAME=VALUE", &options.set, "operator parameter; repeat for more",
                {.suggest = suggest_settings, .takes_one_each = true});
    command.add("--look", "NAME", &options.look, "look of the operator",
                {.suggest = suggest_looks});
}

void add_view_options(const Command& command, ViewOptions& options, const char* exposure_title) {
    add_operator_options(command, options);
    command.title(exposure_title);
    command.add("--exposure", "STOPS", &options.exposure, "exposure before the operator, in stops");
    command.title("Color");
    command.add("--input", "SPACE", &options.input, "scene-linear color space of the input",
                {.suggest = suggest_spaces});
    command.add("--display", "NAME", &options.display,
                "display, `linear` (unclamped Rec.709) or `native` (output of the operator)",
                {.suggest = suggest_displays});
    add_input_units(command, options.input_units, options.reference_white);
    command.describe("--reference-white",
                     "luminance of scene-linear 1.0 in absolute inputs and on HDR displays");
}

void add_input_units(const Command& command, std::string& units, double& reference_white) {
    command.add("--input-units", "UNITS", &units,
                "units of linear input: `relative` (1.0 is white) or `cd/m2`",
                {.suggest = one_of({"relative", "cd/m2"})});
    command.add("--reference-white", "CD/M2", &reference_white,
                "luminance that becomes 1.0, of PQ, HLG and cd/m2");
}

void add_light_options(const Command& command, LightOptions& options) {
    command.add("--input", "SPACE", &options.input,
                "color space (`tonewright list --inputs`), or `auto`, as the file says",
                {.suggest = suggest_source_colors});
    add_input_units(command, options.units, options.reference_white);
}

void add_lut_input_options(const Command& command, LutOptions& options) {
    command.add(
        "--input-encoding", "NAME", &options.encoding,
        "encoding that the LUT expects (see `bake --help`), or `none` (default: that of the "
        "LUT's header)",
        {.suggest = suggest_encodings});
    command.add("--lut-space", "SPACE", &options.space,
                "scene-linear space of the LUT's input (default: that of its encoding)",
                {.suggest = suggest_spaces});
}

void add_lut_options(const Command& command, LutOptions& options,
                     const std::vector<std::string>& others) {
    command.title("LUT, or LUT as the operator");
    command.add("--lut", "FILE", &options.file,
                "LUT file (.cube, .clf, .csp, .icc, Hald CLUT, ...)", {.excludes = others});
    add_lut_input_options(command, options);
    command.add("--interpolation", "NAME", &options.interpolation,
                "between grid points: tetrahedral, trilinear, or auto, as the file says",
                {.suggest = one_of({"tetrahedral", "trilinear", "auto"}), .needs = {"--lut"}});
}

void add_progress(const Command& command) {
    command.title("Output");
    command.add("--progress", "FORM", &message_options().progress,
                "`bar` on a terminal, `none`, or lines on standard output: `json`, `openjd`",
                {.choices = {"bar", "none", "json", "openjd"}});
}

void add_resize(const Command& command, std::string& resize) {
    command.add("--resize", "SIZE", &resize,
                "resize first, in linear light (Lanczos): 1920x1080, 1920 (the width) or 50%",
                {.suggest = one_of({"1920x1080", "1920", "50%"})});
}

void add_picture_choice(const Command& command, PictureChoice& choice) {
    command.add("--layer", "NAME", &choice.layer,
                "layer of an EXR file (default: R, G, B, else the first that is a picture)");
    command.add("--subimage", "N", &choice.subimage,
                "part or page: its name or its number from 0 (default: the first picture)");
    command.add("--max-pixels", "N", &choice.max_pixels,
                "most pixels that a picture may declare (default 1e9)", {.range = {{1, 1e12}}});
}

void add_picture_input(const Command& command, PictureInput& options) {
    command.title("Pictures");
    command.add("--threads", "N", &options.threads, "number of threads; 0 uses all cores",
                {.range = {{0, 1024}}});
    command.add(
        "--timeout", "SECONDS", &options.timeout,
        "seconds that a picture may take; each gets a process of its own (default: no limit)",
        {.range = {{0.1, 1e6}}});
    add_picture_choice(command, options);
    command.add_flag("--unpremult", &options.unpremult,
                     "divide color by alpha first (default: if the alpha is associated)");
    command.add_flag("--no-unpremult", &options.no_unpremult, "do not un-premultiply color",
                     {.excludes = {"--unpremult"}});
}

void add_exposure_options(const Command& command, ExposureOptions& options,
                          const std::vector<std::string>& needs) {
    const auto add = [&](const char* name, const char* value, OptionVariable variable,
                         const char* help) {
        command.add(name, value, variable, help, {.needs = needs});
    };
    command.title("Exposure");
    add("--key", "VALUE", &options.key,
        "target for the metered luminance, or `auto` (default 0.18; 1 with `max`)");
    add("--compensation", "STOPS", &options.compensation, "stops on top of the metered exposure");
    add("--exposure-limits", "LOW,HIGH", &options.limits,
        "limits of the metered exposure, in stops, before compensation");
    add("--calibration", "VALUE", &options.calibration,
        "`key`, or 9.6: a camera that saturates at 9.6 times the metered luminance");
    add(needs.empty() ? "--region,--meter-region" : "--meter-region", "X,Y,W,H", &options.region,
        "metered pixels: x, y, width, height (default: all)");
    command.title("Metering");
    add("--delta", "VALUE", &options.delta,
        "added to each luminance inside the logarithm; also the least metered luminance");
    add("--percentiles", "LOW,HIGH", &options.percentiles,
        "percentiles between which `histogram` averages, such as 40,95");
    add("--histogram-range", "LOW,HIGH", &options.histogram_range,
        "range in log2 of luminance (default -8,3.5, and more if needed)");
    add("--histogram-bins", "N", &options.histogram_bins,
        "number of histogram bins in that range; the first holds black");
    command.add_flag("--exact", &options.exact,
                     "compute percentiles and averages from all luminances, not from bins",
                     {.needs = needs});
}

void add_shot_options(const Command& command, ShotOptions& options,
                      std::vector<std::string> needs) {
    needs.emplace_back("--frames");
    command.title("Exposure of shots");
    command.add_flag("--adapt", &options.adapt,
                     "adapt exposure from frame to frame, as an eye does", {.needs = needs});
    command.add("--adapt-up", "SPEED", &options.up,
                "adaptation speed when the scene gets brighter, per second (default 1.1; 1 with "
                "`--adapt-form 0.98`)",
                {.needs = {"--adapt"}});
    command.add("--adapt-down", "SPEED", &options.down,
                "adaptation speed when the scene gets darker (default: as --adapt-up)",
                {.needs = {"--adapt"}});
    command.add("--adapt-form", "NAME", &options.form,
                "`exponential` (1 - e^(-speed dt)) or `0.98` (1 - 0.98^(30 speed dt))",
                {.suggest = one_of({"exponential", "0.98"}), .needs = {"--adapt"}});
    command.add("--adapt-start", "STOPS", &options.start,
                "exposure of the first frame (default: its metered exposure)",
                {.needs = {"--adapt"}});
    command.add("--fps", "N", &options.fps, "frames per second", {.needs = {"--adapt"}});
    command.add("--meter-frames", "RANGE", &options.meter_frames,
                "frames of the whole shot, if --frames names only some of them",
                {.needs = {"--frames"}});
    command.add("--meter-cache", "FILE", &options.cache,
                "file that keeps metered luminances; changed frames are metered again");
}

TONEWRIGHT_NAMESPACE_END
