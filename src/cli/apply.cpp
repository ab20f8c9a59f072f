// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/picture_input.h"
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

}  // namespace

void add_apply(CLI::App& program, int&) {
    struct Options : ViewOptions {
        std::string in;
        std::string out;
        std::string type;
        std::string statistics = "picture";
        int threads = 0;
        bool unpremult = false;
        bool no_unpremult = false;
    };
    auto options = std::make_shared<Options>();
    CLI::App* command = program.add_subcommand("apply", "tone map a picture");
    command->add_option("in", options->in, "picture, any format that OpenImageIO reads")
        ->required();
    command->add_option("out", options->out, "picture to write; the extension says the format")
        ->required();
    command->add_option("--operator", options->op, "operator, or operator:preset")->required();
    add_view_options(*command, *options);
    command->add_option("-d", options->type,
                        "pixel type of the output: uint8, uint16, half or float");
    command
        ->add_option("--statistics", options->statistics,
                     "parameters that a picture has (its largest luminance, ...) and --set does "
                     "not name: `picture` or `defaults`")
        ->capture_default_str();
    command->add_option("--threads", options->threads, "0 = all cores")
        ->capture_default_str()
        ->check(CLI::Range(0, 1024));
    CLI::Option* yes = command->add_flag(
        "--unpremult", options->unpremult,
        "divide color by alpha before, multiply after; default: as the picture says");
    command->add_flag("--no-unpremult", options->no_unpremult, "take color as it is")
        ->excludes(yes);
    command->footer(
        "Example:\n  tonewright apply render.exr out.png --operator hable --exposure 1 -d uint8");
    command->callback([options] {
        TonemapOptions tonemap;
        tonemap.op = options->op;
        tonemap.settings = options->settings();
        tonemap.look = options->look;
        tonemap.exposure_stops = options->exposure;
        tonemap.input = options->input;
        tonemap.display = options->display;
        tonemap.reference_white = options->reference_white;
        if (options->unpremult) tonemap.unpremult = TonemapOptions::Unpremult::yes;
        if (options->no_unpremult) tonemap.unpremult = TonemapOptions::Unpremult::no;
        tonemap.statistics = parse_statistics(options->statistics);
        const Tonemapper tonemapper(tonemap);  // a wrong name is told before a large file is read
        const OIIO::TypeDesc type = options->type.empty() ? OIIO::TypeDesc(OIIO::TypeUnknown)
                                                          : parse_pixel_type(options->type);
        const OIIO::ImageBuf source = read_picture(options->in);
        OIIO::ImageBuf result;
        if (!tonemapper(result, source, {}, options->threads)) {
            throw Error("apply: " + options->in + ": " + result.geterror());
        }
        write_image_atomically(result, options->out, type);
    });
}

}  // namespace tonewright
