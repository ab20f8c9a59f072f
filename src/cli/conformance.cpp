// SPDX-License-Identifier: Apache-2.0
#include "tasks/conformance.h"

#include <fmt/format.h>

#include <memory>

#include "base/format_number.h"
#include "cli/lut_input.h"
#include "cli/messages.h"
#include "cli/shared_options.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Options : ViewOptions {
    LutOptions lut;
    std::string folder;
};

int run_conformance(Options& options) {
    take_lut_options("conformance", options.lut, options, LutOption::no);
    const auto [colors, tolerance] =
        write_conformance_kit({options.view(), options.folder}, {.warn = warn});
    print_result(fmt::format("{}: {} colors of {}, tolerance in float {}; README.md has the steps",
                             options.folder, colors, options.op, rounded_up(tolerance)));
    return kOk;
}

}  // namespace

void add_conformance(CommandLine& program) {
    auto options = std::make_shared<Options>();
    options->display = kLinearOutput;
    const Command command =
        program.add("conformance", "LUTs, shaders and configs",
                    "Write tests of an engine's own function: colors, tolerances and runners.");
    add_operator_argument(command, options->op, true);
    command.title("Output");
    command.add("-o", "FOLDER", &options->folder,
                "folder to write: colors.csv, runners and README.md", {.is_required = true});
    add_view_options(command, *options);
    command.title("LUT as the operator");
    add_lut_input_options(command, options->lut);
    command.footer(
        "The folder needs no Tonewright. It tests functions in JavaScript, GLSL, WGSL, HLSL and C, "
        "and results of any other program. Parameters that `apply` measures from the picture keep "
        "their defaults.\n"
        "Examples:\n"
        "  tonewright conformance khronos_neutral -o neutral_kit\n"
        "  tonewright conformance agx_blender --look punchy --display srgb -o agx_kit");
    command.action([options] { return run_conformance(*options); }, &options->given);
}

TONEWRIGHT_NAMESPACE_END
