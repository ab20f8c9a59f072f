// SPDX-License-Identifier: Apache-2.0
#include "cli/apply_frames.h"
#include "cli/command.h"
#include "cli/frames.h"
#include "cli/lut_input.h"
#include "cli/picture_input.h"
#include "image/source_picture.h"
#include "tonewright/engine.h"
#include "tonewright/image.h"

namespace tonewright {
namespace {

TonemapOptions::Statistics parse_statistics(const std::string& text) {
    if (text == "picture") return TonemapOptions::Statistics::from_picture;
    if (text == "defaults") return TonemapOptions::Statistics::defaults;
    const std::vector<std::string> names = {"picture", "defaults"};
    throw Error("apply: statistics is " + text + "; expected " + join_choices(names) +
                did_you_mean(text, names));
}

struct Options : ViewOptions {
    std::string in;
    std::string out;
    FrameOptions frames;
    std::string type;
    std::string statistics = "picture";
    int threads = 0;
    bool is_false_color = false;
    bool unpremult = false;
    bool no_unpremult = false;
    LutOptions lut;

    [[nodiscard]] TonemapOptions::Unpremult alpha() const {
        if (unpremult) return TonemapOptions::Unpremult::yes;
        if (no_unpremult) return TonemapOptions::Unpremult::no;
        return TonemapOptions::Unpremult::automatic;
    }
    [[nodiscard]] OIIO::TypeDesc pixel_type() const {
        return type.empty() ? OIIO::TypeDesc(OIIO::TypeUnknown) : parse_pixel_type(type);
    }
};

void apply_lut(const Options& options, const CLI::App& command) {
    Pipeline before = before_lut(command, options.lut, options, source_color({}, options.input));
    const LutFile lut = open_lut(options.lut.file, options.lut.interpolation);
    const OIIO::TypeDesc type = options.pixel_type();
    const QuietStderr quiet;
    const OIIO::ImageBuf source = read_image(options.in);
    if (!before.empty()) {
        before =
            before_lut(command, options.lut, options, source_color(source.spec(), options.input));
    }
    const SimdEngine encode(before);
    OIIO::ImageBuf result;
    const auto map = [&](const float* in, float* out, std::size_t count) {
        if (before.empty()) {
            lut.run_rgb(in, out, count);
            return;
        }
        std::vector<float> code(3 * count);
        encode.run_rgb(in, code.data(), count);
        lut.run_rgb(code.data(), out, count);
    };
    if (!map_colors(result, source, map, options.alpha(), {}, options.threads))
        throw Error("apply: " + options.in + ": " + result.geterror());
    write_image_atomically(result, options.out, type);
}

}  // namespace

void add_apply(CLI::App& program, int& exit_code) {
    auto options = std::make_shared<Options>();
    CLI::App* command =
        program.add_subcommand("apply", "tone map a picture, or the frames of a shot");
    command->add_option("in", options->in, "picture, any format that OpenImageIO reads")
        ->required();
    command->add_option("out", options->out, "picture to write; the extension says the format")
        ->required();
    CLI::Option* op =
        command->add_option("--operator", options->op, "operator, or operator:preset");
    CLI::Option* false_color =
        command->add_flag("--false-color", options->is_false_color,
                          "where the light is: a color for every stop, the operator false_color");
    false_color->excludes(op);
    add_frame_options(*command, options->frames);
    options->input = kAutoInput;
    add_view_options(*command, *options);
    command->get_option("--input")->description(
        "what the input's numbers are: `auto`, what the picture says (`oiio:ColorSpace`, "
        "chromaticities, ...; linear Rec.709 where it says nothing), a scene-linear space, or "
        "sRGB, "
        "Rec709, Gamma2.2 or a display, whose code values are decoded");
    command->add_option("-d", options->type,
                        "pixel type of the output: uint8, uint16, half or float");
    command
        ->add_option("--statistics", options->statistics,
                     "parameters that a picture has (its largest luminance, ...) and --set does "
                     "not name: `picture` or `defaults`")
        ->capture_default_str();
    command
        ->add_option(
            "--threads", options->threads,
            "threads that read, tone map and write; 0 = all cores, 1 = one after the other")
        ->capture_default_str()
        ->check(CLI::Range(0, 1024));
    CLI::Option* yes = command->add_flag(
        "--unpremult", options->unpremult,
        "divide color by alpha before, multiply after; default: as the picture says");
    command->add_flag("--no-unpremult", options->no_unpremult, "take color as it is")
        ->excludes(yes);
    add_lut_options(*command, options->lut, op,
                    {"--set", "--look", "--display", "--reference-white", "--statistics",
                     "--frames", "--false-color"});
    command->footer(
        "Examples:\n"
        "  tonewright apply render.exr out.png --operator hable --exposure 1 -d uint8\n"
        "  tonewright apply shot.%04d.exr out.####.png --frames 1001-1100 --operator agx_blender\n"
        "  tonewright apply in.@@@@.exr out.@@@@.png --frames 1-99x2 --operator hable "
        "--skip-existing\n"
        "  tonewright apply render.exr out.png --lut agx.cube --input-encoding acescct -d uint8");
    command->callback([options, command, &exit_code] {
        OIIO::attribute("threads", options->threads);
        // OpenEXR has threads of its own; there, 0 is all cores and less is none.
        OIIO::attribute("exr_threads", options->threads == 1 ? -1 : options->threads);
        if (!options->lut.file.empty()) {
            apply_lut(*options, *command);
            return;
        }
        if (options->is_false_color) options->op = "false_color";
        if (options->op.empty()) {
            throw Error(
                "apply: operator is missing; expected --operator with an id of `tonewright list`, "
                "or --lut FILE");
        }
        TonemapOptions tonemap;
        tonemap.op = options->op;
        tonemap.settings = options->settings();
        tonemap.look = options->look;
        tonemap.exposure_stops = options->exposure;
        tonemap.input = options->input;
        tonemap.display = options->display;
        tonemap.reference_white = options->reference_white;
        tonemap.unpremult = options->alpha();
        tonemap.statistics = parse_statistics(options->statistics);
        const Tonemapper tonemapper(tonemap);  // a wrong name is told before a large file is read
        const OIIO::TypeDesc type = options->pixel_type();
        if (command->count("--frames") > 0) {
            exit_code = apply_to_frames(tonemapper, options->in, options->out, options->frames,
                                        type, options->threads);
            return;
        }
        try {
            const QuietStderr quiet;
            tonemap_file(tonemapper, options->in, options->out, type, options->threads);
        } catch (const FileError& e) {
            if (!is_frame_pattern(options->in)) throw;
            throw FileError(std::string(e.what()) + "; for the frames of a shot: --frames 1-100");
        }
    });
}

}  // namespace tonewright
