// SPDX-License-Identifier: Apache-2.0
#include "plot/tone_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/format_number.h"
#include "plot/gray_curve.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

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
    Readings(const Display& display, PlotQuantity quantity)
        : display_(display), quantity_(quantity) {}

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
        if (quantity_ == PlotQuantity::code) return codes;
        std::vector<double> values = light_of(codes);
        for (double& v : values) {
            if (quantity_ == PlotQuantity::log)
                v = std::max(std::log10(std::max(v, 1e-30)), lowest_log());
        }
        return values;
    }
    [[nodiscard]] std::string text_of(double code) const {
        if (quantity_ == PlotQuantity::code) return fmt::format("{:.3f}", code);
        return light_text(light_of({code})[0]) + (display_.is_hdr ? " cd/m2" : "");
    }
    /// @param brightest  value of the lines
    [[nodiscard]] PlotScale scale(double brightest) const;

  private:
    [[nodiscard]] double lowest_log() const { return display_.is_hdr ? -3 : -2; }
    void add_codes(PlotScale& scale) const;

    const Display& display_;
    PlotQuantity quantity_;
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
    if (quantity_ == PlotQuantity::code) {
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
    if (quantity_ == PlotQuantity::light) {
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

void add_clamp(CurvePlot& plot, const View& clamp, const std::vector<double>& scene) {
    PlotLine line = {"no_tone_mapping",
                     "no tone mapping: clamp",
                     plot.theme == PlotTheme::dark ? "#767d85" : "#a8b0b9",
                     1.2,
                     {5, 3},
                     gray_codes(clamp, scene)};
    const bool is_there =
        std::any_of(plot.lines.begin(), plot.lines.end(), [&](const PlotLine& other) {
            return largest_difference(other.values, line.values) < kSameLine;
        });
    if (!is_there) plot.lines.push_back(std::move(line));
}

}  // namespace

CurvePlot plot_of(const ToneCurves& request) {
    const View& first = request.curves.front().view;
    const bool is_one = request.curves.size() == 1;
    const Display& display = find_display(first.display);
    const Readings readings(display, request.quantity);

    CurvePlot plot;
    plot.theme = request.theme;
    plot.names_grays = true;
    const std::vector<double> scene = scene_of(plot_stops());
    for (const auto& [id, view] : request.curves) {
        const std::size_t index = plot.lines.size();
        const std::string name = name_of(view.op);
        add_line(plot.lines,
                 {id, name, line_color(index, plot.theme), is_one ? 2.4 : 1.8, line_dashes(index),
                  gray_codes(view, scene)},
                 name);
    }
    if (request.clamp) add_clamp(plot, *request.clamp, scene);
    if (is_one && !first.op.op->is_diagnostic) {
        for (const double gray : {kMidGray, 1.0}) {
            const double code = gray_code(first, gray);
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

    plot.subtitle = request.quantity == PlotQuantity::code
                        ? display.title + " code value of scene-linear gray"
                        : fmt::format("{} of scene-linear gray on {}",
                                      request.quantity == PlotQuantity::log ? "log light" : "light",
                                      display.title);
    if (first.exposure_stops != 0)
        plot.subtitle += fmt::format(", {:+g} stops", first.exposure_stops);
    const std::string title = is_one ? name_of(first.op) : "Tone curves";
    plot.title = fit_title(request.title.empty() ? title : request.title, plot.subtitle.size());
    return plot;
}

TONEWRIGHT_NAMESPACE_END
