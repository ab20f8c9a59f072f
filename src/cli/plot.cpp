// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/atomic_file.h"
#include "base/format_number.h"
#include "base/strings.h"
#include "cli/picture_commands.h"
#include "cli/plot.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"
#include "plot/curve_plot.h"
#include "plot/gray_curve.h"
#include "tonewright/lut.h"
#include "tonewright/ocio.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The vertical axis of the plot.
enum class Quantity : unsigned char { code, light, log };

Quantity parse_quantity(const std::string& text) {
    return static_cast<Quantity>(find_choice("y", text, {"code", "light", "log"}));
}

/// Display-linear 1: white in percent, or cd/m2 on HDR displays.
constexpr double kUnit = 100;
static_assert(kUnit == kUnitLuminance);

// Smallest distance between numbers on the two sides, as a fraction of the graph's height.
constexpr double kTickDistance = 0.055;

std::vector<double> decades(double lowest, double highest) {
    std::vector<double> all;
    for (double d = lowest; d <= highest * 1.001; d *= 10)
        all.push_back(d);
    return all;
}

/// A display's numbers: code values, and their light in percent of white, or in cd/m2 on an HDR
/// display.
class Readings {
  public:
    Readings(const Display& display, Quantity quantity) : display_(display), quantity_(quantity) {}

    [[nodiscard]] std::string light_text(double light) const {
        const std::string number =
            light < 1000 ? fmt::format("{:.3g}", light) : fmt::format("{:.0f}", light);
        return display_.is_hdr ? number : number + " %";
    }
    [[nodiscard]] std::vector<double> light_of(const std::vector<double>& codes) const {
        std::vector<double> light = codes_of(display_.decode, {1, 1, 1}, codes)[0];
        for (double& l : light)
            l *= kUnit;
        return light;
    }
    [[nodiscard]] double code_of(double light) const {
        return codes_of(display_.encode, {1, 1, 1}, {{light / kUnit}})[0][0];
    }
    /// The plotted value of a code value. Logarithms end at the ends of the scale.
    [[nodiscard]] std::vector<double> values_of(const std::vector<double>& codes) const {
        if (quantity_ == Quantity::code) return codes;
        std::vector<double> values = light_of(codes);
        for (double& v : values) {
            if (quantity_ == Quantity::log)
                v = std::max(std::log10(std::max(v, 1e-30)), lowest_log());
        }
        return values;
    }
    [[nodiscard]] std::string text_of(double code) const {
        if (quantity_ == Quantity::code) return fmt::format("{:.3f}", code);
        return light_text(light_of({code})[0]) + (display_.is_hdr ? " cd/m2" : "");
    }
    /// @param brightest  value of the lines
    [[nodiscard]] PlotScale scale(double brightest) const;

  private:
    [[nodiscard]] double lowest_log() const { return display_.is_hdr ? -3 : -2; }
    void add_codes(PlotScale& scale) const;

    const Display& display_;
    Quantity quantity_;
};

/// At the right, if there is room.
void Readings::add_codes(PlotScale& scale) const {
    const std::vector<double> codes = {0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1};
    const std::vector<double> values = values_of(codes);
    double last = scale.low;
    for (std::size_t i = 0; i < codes.size(); ++i) {
        if (values[i] > scale.high || values[i] - last < kTickDistance * (scale.high - scale.low))
            continue;
        scale.ticks.push_back({values[i], "", fmt::format("{:g}", codes[i])});
        last = values[i];
    }
    scale.right_heading = "code";
}

PlotScale Readings::scale(double brightest) const {
    const std::string light = display_.is_hdr ? "cd/m2" : "light";
    PlotScale scale;
    if (quantity_ == Quantity::code) {
        scale.right_heading = light;
        for (int i = 0; i <= 5; ++i) {
            const double code = i / 5.0;
            scale.ticks.push_back({code, fmt::format("{:g}", code), ""});
            if (!display_.is_hdr && i > 0) {
                const double percent = light_of({code})[0];
                scale.ticks.back().right = fmt::format("{:.{}f} %", percent, percent < 10 ? 1 : 0);
            }
        }
        if (display_.is_hdr) {
            for (const double nits : decades(0.1, display_.largest_light * kUnit))
                scale.ticks.push_back({code_of(nits), "", light_text(nits)});
        }
        return scale;
    }
    scale.left_heading = light;
    scale.quantity = display_.is_hdr ? "cd/m2" : "percent of white";
    if (quantity_ == Quantity::light) {
        const std::vector<double> ends = {kUnit, 200, 500, 1000, 2000, 5000, 10000};
        scale.high = *std::find_if(ends.begin(), ends.end() - 1,
                                   [&](double end) { return end >= 0.999 * brightest; });
        for (int i = 0; i <= 5; ++i) {
            const double value = scale.high * i / 5;
            scale.ticks.push_back({value, light_text(value), ""});
        }
    } else {
        scale.quantity = "log10 of " + scale.quantity;
        scale.low = lowest_log();
        scale.high = display_.is_hdr ? std::max(2.0, std::ceil(brightest - 0.001)) : 2;
        for (const double value : decades(std::pow(10, scale.low), std::pow(10, scale.high)))
            scale.ticks.push_back({std::log10(value), light_text(value), ""});
    }
    add_codes(scale);
    return scale;
}

/// `--set` and `--look` apply to all operators; an operator's own settings take precedence.
View view_of(const PlotOptions& options, const std::string& text) {
    const ResolvedOperator own = resolve_operator(text, {}, {}, operator_files());
    const ResolvedOperator op = with_defaults(own, options.settings(), options.look);
    warn_of(op);
    return make_view(op, options.input, options.exposure, options.display, options.reference_white);
}

/// "Hable (Uncharted 2), white=4"
std::string name_of(const ResolvedOperator& op) {
    const std::string rest = op.label.substr(op.op->id.size());
    return op.op->title + (rest.empty() ? "" : ", " + rest.substr(1));
}

/// Beside a heading of `words` letters; about what Helvetica takes.
std::string fit_title(const std::string& title, std::size_t words) {
    constexpr double kWidth = 530;
    constexpr double kLetter = 5.3;
    constexpr double kTitleLetter = 7.4;
    const auto longest =
        static_cast<std::size_t>((kWidth - kLetter * static_cast<double>(words)) / kTitleLetter);
    return title.size() <= longest ? title : title.substr(0, longest - 2) + "...";
}

/// Distinct colors and dashes.
constexpr std::size_t kMostLines = 24;

CurvePlot plot_of(const PlotOptions& options) {
    if (is_same_name(options.display, kLinearOutput) ||
        is_same_name(options.display, kNativeOutput)) {
        throw Error("plot: --display is " + options.display +
                    "; expected a display with an encoding, such as srgb");
    }
    if (options.operators.size() > kMostLines) {
        throw Error(fmt::format("plot: number of operators is {}; expected at most {}",
                                options.operators.size(), kMostLines));
    }
    const Quantity quantity = parse_quantity(options.y);
    std::vector<View> views;
    for (const std::string& text : options.operators) {
        View view = view_of(options, text);
        const bool is_there = std::any_of(views.begin(), views.end(), [&](const View& other) {
            return other.op.label == view.op.label;
        });
        if (!is_there) views.push_back(std::move(view));
    }
    const Display& display = find_display(views[0].display);
    const Readings readings(display, quantity);

    CurvePlot plot;
    plot.theme = options.is_dark ? PlotTheme::dark : PlotTheme::light;
    plot.names_grays = true;
    const std::vector<double> scene = scene_of(plot_stops());
    const auto line_of = [&](const View& view) {
        const std::size_t index = plot.lines.size();
        return PlotLine{
            operator_text(view.op),        name_of(view.op),   line_color(index, plot.theme),
            views.size() == 1 ? 2.4 : 1.8, line_dashes(index), gray_codes(view, scene)};
    };
    for (const View& view : views)
        add_line(plot.lines, line_of(view), name_of(view.op));
    if (!display.is_hdr) {
        const View clamp =
            make_view(resolve_operator("clamp"), options.input, options.exposure, options.display);
        PlotLine line = {"no_tone_mapping",       "no tone mapping: clamp", "#a8b0b9", 1.2, {5, 3},
                         gray_codes(clamp, scene)};
        if (options.is_dark) line.color = "#767d85";
        const bool is_there =
            std::any_of(plot.lines.begin(), plot.lines.end(), [&](const PlotLine& other) {
                return largest_difference(other.values, line.values) < kSameLine;
            });
        if (!is_there) plot.lines.push_back(std::move(line));
    }
    if (views.size() == 1 && !views[0].op.op->is_diagnostic) {
        for (const double gray : {kMidGray, 1.0}) {
            const double code = gray_code(views[0], gray);
            plot.marks.push_back(
                {std::log2(gray / kMidGray), readings.values_of({code})[0],
                 fmt::format("{} \u2192 {}", shortest(gray), readings.text_of(code))});
        }
    }
    double brightest = readings.values_of({0})[0];
    for (PlotLine& line : plot.lines) {
        line.values = readings.values_of(line.values);
        brightest = std::max(brightest, *std::max_element(line.values.begin(), line.values.end()));
    }
    plot.scale = readings.scale(brightest);

    plot.subtitle =
        quantity == Quantity::code
            ? display.title + " code value of scene-linear gray"
            : fmt::format("{} of scene-linear gray on {}",
                          quantity == Quantity::log ? "log light" : "light", display.title);
    if (options.exposure != 0) plot.subtitle += fmt::format(", {:+g} stops", options.exposure);
    const std::string title = views.size() == 1 ? name_of(views[0].op) : "Tone curves";
    plot.title = fit_title(options.title.empty() ? title : options.title, plot.subtitle.size());
    return plot;
}

}  // namespace

std::string write_plot(const PlotOptions& options) {
    const CurvePlot plot = plot_of(options);
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
