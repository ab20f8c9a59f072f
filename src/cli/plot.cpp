// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "cli/picture_commands.h"
#include "cli/plot.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"
#include "plot/tone_curves.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// `--set` and `--look` apply to all operators; an operator's own settings take precedence.
View view_of(const PlotOptions& options, const std::string& text) {
    const ResolvedOperator own = resolve_operator(text, {}, {}, operator_files());
    const ResolvedOperator op = with_defaults(own, options.settings(), options.look);
    warn_of(op);
    return make_view(op, options.input, options.exposure, options.display, options.reference_white);
}

ToneCurves request_of(const PlotOptions& options) {
    if (is_same_name(options.display, kLinearOutput) ||
        is_same_name(options.display, kNativeOutput)) {
        throw Error("plot: --display is " + options.display +
                    "; expected a display with an encoding, such as srgb");
    }
    if (options.operators.size() > kMostCurves) {
        throw Error(fmt::format("plot: number of operators is {}; expected at most {}",
                                options.operators.size(), kMostCurves));
    }
    ToneCurves request;
    request.quantity =
        static_cast<PlotQuantity>(find_choice("y", options.y, {"code", "light", "log"}));
    for (const std::string& text : options.operators) {
        View view = view_of(options, text);
        const bool is_there =
            std::any_of(request.curves.begin(), request.curves.end(),
                        [&](const auto& other) { return other.view.op.label == view.op.label; });
        if (!is_there) request.curves.push_back({operator_text(view.op), std::move(view)});
    }
    if (!find_display(options.display).is_hdr) {
        request.clamp =
            make_view(resolve_operator("clamp"), options.input, options.exposure, options.display);
    }
    request.theme = options.is_dark ? PlotTheme::dark : PlotTheme::light;
    request.title = options.title;
    return request;
}

}  // namespace

std::string write_plot(const PlotOptions& options) {
    const CurvePlot plot = plot_of(request_of(options));
    const std::string extension = extension_of(options.file);
    const bool is_vector = extension == ".svg" || extension == ".pdf";
    const int width = options.width > 0 ? options.width : is_vector ? 640 : 1280;
    if (extension == ".svg") {
        write_text_atomically(options.file, to_svg(plot, width));
    } else {
        picture_commands().write_plot(plot, options.file, width);
    }
    return plot.title;
}

void add_plot(CommandLine& program) {
    auto options = std::make_shared<PlotOptions>();
    const Command command = program.add("plot", "Operators", "Plot the tone curves of operators.");
    command.argument("operators", &options->operators,
                     "NAME[:PRESET][:PARAMETER=VALUE...][:look=LOOK]",
                     {.suggest = suggest_operators, .is_required = true});
    command.title("Plot");
    command.add("-o", "FILE", &options->file,
                "file to write: .svg, .pdf, or a picture such as .png", {.is_required = true});
    command.add("--y", "NAME", &options->y,
                "vertical axis: `code` (code values), `light` (percent of white or cd/m2) or `log`",
                {.suggest = one_of({"code", "light", "log"})});
    command.add("--title", "TEXT", &options->title, "title of the plot");
    command.add("--width", "N", &options->width,
                "width in pixels (default 640 for SVG and PDF, 1280 for pictures)",
                {.range = {{320, 16384}}});
    command.add_flag("--dark", &options->is_dark, "draw for a dark page");
    add_view_options(command, *options);
    command.footer(
        "The plot shows grays from -10 to +10 stops around 0.18. An operator that tints gray is "
        "plotted by the luminance of the result. --set and --look apply to all operators.\n"
        "Examples:\n"
        "  tonewright plot hable agx_sobotka aces_13 -o curves.svg\n"
        "  tonewright plot hable:white=4 hable --y log -o white.png\n"
        "  tonewright plot aces_20 gt7 --display rec2100_pq -o hdr.svg");
    command.action([options] {
        const ResultLine line;
        const std::string title = write_plot(*options);
        line.print(fmt::format("plot: {}: {}", options->file, title));
        return kOk;
    });
}

TONEWRIGHT_NAMESPACE_END
