// SPDX-License-Identifier: Apache-2.0
#include "tonewright/verify.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "tonewright/image.h"

namespace tonewright {
namespace {

/// Every pixel up to a million, then every n-th.
std::vector<float> picture_pixels(const std::string& path) {
    const OIIO::ImageBuf image = read_picture(path);
    const int channels = image.nchannels();
    if (channels < 3)
        throw Error("verify: picture " + path + " has " + std::to_string(channels) +
                    " channels; expected 3");
    const auto& spec = image.spec();
    const auto step = static_cast<int>(spec.image_pixels() / 1000000 + 1);
    std::vector<float> pixel(static_cast<std::size_t>(channels));
    std::vector<float> rgb;
    int index = 0;
    for (int y = spec.y; y < spec.y + spec.height; ++y) {
        for (int x = spec.x; x < spec.x + spec.width; ++x) {
            if (index++ % step) continue;
            image.getpixel(x, y, pixel.data(), channels);
            rgb.insert(rgb.end(), pixel.begin(), pixel.begin() + 3);
        }
    }
    return rgb;
}

}  // namespace

void add_verify(CLI::App& program, int& exit_code) {
    struct Options {
        VerifyOptions verify;
        std::string picture;
        bool json = false;
        bool quick = false;
        bool no_gpu = false;
    };
    auto options = std::make_shared<Options>();
    CLI::App* command = program.add_subcommand(
        "verify", "the parity table: every form against the double reference");
    command->add_option("operators", options->verify.operators,
                        "default: all, with their presets and looks");
    command->add_option("--display", options->verify.displays, "displays; repeat for more")
        ->capture_default_str()
        ->allow_extra_args(false);
    command->add_option("--input", options->verify.input, "scene-linear space of the probes")
        ->capture_default_str();
    command->add_option("--config", options->verify.config_folder,
                        "folder of a config to check; default: a fresh one");
    command->add_option("--picture", options->picture, "picture whose pixels join the probes");
    command->add_flag("--quick", options->quick, "gamut lattices of 9 instead of 33 points a side");
    command->add_flag("--no-gpu", options->no_gpu, "leave OCIO's GPU path out");
    command->add_flag("--json", options->json, "for programs");
    command->footer(
        "max, 99.9 % and mean: errors of display code values over probes >= 0; max all: negatives "
        "and mixed\n"
        "signs included. beyond f32: where an error is beyond the bound, how far it exceeds what "
        "float32\n"
        "rounding before a cancelling matrix has to cost. Exit code 1 when a bound is exceeded.\n"
        "Example:\n  tonewright verify hable --display display_p3");
    command->callback([options, &exit_code] {
        VerifyOptions& verify_options = options->verify;
        verify_options.with_gpu = !options->no_gpu;
        if (options->quick) verify_options.lattice_edge = 9;
        if (!options->picture.empty()) verify_options.picture = picture_pixels(options->picture);
        bool has_heading = false;  // not before the names have proved good
        const auto print = [&](const ParityRow& row) {
            if (options->json) return;
            if (!has_heading) fmt::print("{}", parity_heading());
            has_heading = true;
            fmt::print("{}", format_row(row));
            std::fflush(stdout);
        };
        const std::vector<ParityRow> rows = verify(verify_options, print);
        std::size_t failed = 0;
        for (const ParityRow& row : rows)
            failed += row.is_ok ? 0 : 1;
        if (options->json) {
            nlohmann::ordered_json all = nlohmann::ordered_json::array();
            for (const ParityRow& r : rows) {
                all.push_back({{"operator", r.op},
                               {"display", r.display},
                               {"form", r.form},
                               {"lowering", r.lowering},
                               {"max", r.max},
                               {"p999", r.p999},
                               {"mean", r.mean},
                               {"max_all", r.max_all},
                               {"max_beyond_rounding", r.max_beyond_rounding},
                               {"bound", r.bound},
                               {"mixed_metric", r.is_mixed_metric},
                               {"ok", r.is_ok},
                               {"note", r.note}});
            }
            fmt::print("{}\n", all.dump(2));
        } else {
            fmt::print("{} comparisons, {} beyond their bound\n", rows.size(), failed);
        }
        if (failed) exit_code = kCheckFailed;
    });
}

}  // namespace tonewright
