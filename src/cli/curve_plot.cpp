// SPDX-License-Identifier: Apache-2.0
#include "cli/curve_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>

#include "tonewright/error.h"

namespace tonewright {
namespace {

// Everything in pixels of a picture 640 wide: about the width at which a page shows it.
constexpr double kWidth = 640;
constexpr double kLeft = 50;
constexpr double kStop = 27;  // width of one stop
constexpr int kLowestStop = -10;
constexpr int kHighestStop = 10;
constexpr double kRight = kLeft + kStop * (kHighestStop - kLowestStop);
constexpr double kMargin = 6;  // between a graph's frame and code values 0 and 1
constexpr double kLegendRow = 15;

constexpr const char* kFrame = "#8c959f";

double x_of(double stops) { return kLeft + kStop * (stops - kLowestStop); }

/// Where a graph is.
struct Graph {
    double top;  // of the scale's high end
    double height;
    PlotScale scale;

    [[nodiscard]] double unit() const { return height / (scale.high - scale.low); }
    [[nodiscard]] double y_of(double value) const { return top + unit() * (scale.high - value); }
    [[nodiscard]] double bottom() const { return top + height; }
};

/// At most two decimals, without trailing zeros.
std::string px(double value) {
    std::string text = fmt::format("{:.2f}", value);
    while (text.back() == '0')
        text.pop_back();
    if (text.back() == '.') text.pop_back();
    return text == "-0" ? "0" : text;
}

/// Douglas and Peucker 1973, with the distance along y: which points a line needs.
void mark_needed(const std::vector<double>& x, const std::vector<double>& y, std::size_t first,
                 std::size_t last, std::vector<bool>& is_needed) {
    constexpr double kTolerance = 0.2;
    std::size_t worst = first;
    double distance = kTolerance;
    for (std::size_t i = first + 1; i < last; ++i) {
        const double t = (x[i] - x[first]) / (x[last] - x[first]);
        const double d = std::fabs(y[first] + t * (y[last] - y[first]) - y[i]);
        if (d > distance) {
            distance = d;
            worst = i;
        }
    }
    if (worst == first) return;
    is_needed[worst] = true;
    mark_needed(x, y, first, worst, is_needed);
    mark_needed(x, y, worst, last, is_needed);
}

/// An SVG file being written.
class Svg {
  public:
    template <typename... Args>
    void add(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
    }
    void text(double x, double y, std::string_view style, std::string_view words) {
        add("<text x=\"{}\" y=\"{}\"{}>{}</text>\n", px(x), px(y), class_of(style),
            xml_escaped(words));
    }
    void path(std::string_view style, const std::string& d) {
        add("<path{} d=\"{}\"/>\n", class_of(style), d);
    }
    void curve(const PlotLine& line, const Graph& graph) {
        const std::vector<double>& stops = plot_stops();
        std::vector<double> x;
        std::vector<double> y;
        for (std::size_t i = 0; i < stops.size(); ++i) {
            x.push_back(x_of(stops[i]));
            y.push_back(std::round(100 * graph.y_of(line.codes.at(i))) / 100);
        }
        std::vector<bool> is_needed(x.size());
        is_needed.front() = is_needed.back() = true;
        mark_needed(x, y, 0, x.size() - 1, is_needed);
        std::string points;
        for (std::size_t i = 0; i < x.size(); ++i) {
            if (is_needed[i]) points += (points.empty() ? "" : " ") + px(x[i]) + "," + px(y[i]);
        }
        add("<polyline id=\"{}\"{} points=\"{}\"/>\n", xml_escaped(line.id), stroke(line), points);
    }
    [[nodiscard]] static std::string stroke(const PlotLine& line) {
        return fmt::format(
            " stroke=\"{}\" stroke-width=\"{}\"{}", line.color, px(line.width),
            line.dashes.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", line.dashes));
    }
    [[nodiscard]] std::string take() { return std::move(text_); }

  private:
    [[nodiscard]] static std::string class_of(std::string_view style) {
        return style.empty() ? "" : fmt::format(" class=\"{}\"", style);
    }
    std::string text_;
};

/// With a minus sign instead of a hyphen.
std::string tick_label(std::string text) {
    if (text.starts_with('-')) text.replace(0, 1, "\u2212");
    return text;
}

/// Scene-linear at a tick of the axis: two digits.
std::string scene_linear_at(int stops) {
    const double x = 0.18 * std::exp2(stops);
    const int digits = std::max(0, 1 - static_cast<int>(std::floor(std::log10(x))));
    return fmt::format("{:.{}f}", x, digits);
}

double light_of(double code) {  // IEC 61966-2-1
    return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
}

std::string vertical(double stops, double top, double bottom) {
    return fmt::format("M{} {}V{}", px(x_of(stops)), px(top), px(bottom));
}

/// Frame, grid and the numbers at the sides.
void draw_graph(Svg& svg, const Graph& graph, bool with_light) {
    const double top = graph.top - kMargin;
    const double bottom = graph.bottom() + kMargin;
    std::string grid;
    for (int stop = kLowestStop; stop <= kHighestStop; stop += 2)
        grid += vertical(stop, top, bottom);
    const PlotScale& scale = graph.scale;
    const auto steps = static_cast<int>(std::lround((scale.high - scale.low) / scale.step));
    for (int i = 0; i <= steps; ++i) {
        const double value = scale.low + i * scale.step;
        const double y = graph.y_of(value);
        grid += fmt::format("M{} {}H{}", px(kLeft), px(y), px(kRight));
        svg.text(kLeft - 5, y + 4, "e", tick_label(px(value)));
        if (with_light && value > 0) {
            const double percent = 100 * light_of(value);
            svg.text(kRight + 5, y + 4, "",
                     fmt::format("{:.{}f} %", percent, percent < 10 ? 1 : 0));
        }
    }
    svg.path("g", grid);
    svg.path("m", vertical(0, top, bottom) + vertical(std::log2(1 / 0.18), top, bottom));
    svg.add("<rect class=\"f\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", px(kLeft),
            px(top), px(kRight - kLeft), px(bottom - top));
}

/// A label of several names goes on in the next row rather than beyond so many letters.
constexpr std::size_t kLegendLetters = 36;

std::vector<std::string> wrapped(const std::string& label) {
    std::vector<std::string> rows = {""};
    std::size_t begin = 0;
    while (begin < label.size()) {
        const std::size_t comma = label.find(", ", begin);
        const std::size_t end = comma == std::string::npos ? label.size() : comma + 2;
        if (!rows.back().empty() && rows.back().size() + end - begin > kLegendLetters)
            rows.emplace_back();
        rows.back() += label.substr(begin, end - begin);
        begin = end;
    }
    return rows;
}

void draw_legend(Svg& svg, const std::vector<PlotLine>& lines, double top) {
    double y = top;
    for (const PlotLine& line : lines) {
        if (line.label.empty()) continue;
        svg.add("<path{} d=\"M{} {}h24\"/>\n", Svg::stroke(line), px(kLeft + 10), px(y - 4));
        for (const std::string& row : wrapped(line.label)) {
            svg.text(kLeft + 40, y, "h", row);
            y += kLegendRow;
        }
    }
}

std::string hex(const Vector3& code) {
    std::string text = "#";
    for (const double c : code)
        text += fmt::format("{:02x}", std::lround(255 * std::clamp(c, 0.0, 1.0)));
    return text;
}

/// A row of patches as high as the group that it stands in says; equal ones beside each other as
/// one.
/// @param with_half_ends  of the first patch its right half, of the last one its left half
void draw_patches(Svg& svg, std::span<const Vector3> codes, double x, double width, double y,
                  bool with_half_ends) {
    svg.add("<g transform=\"matrix({} 0 0 1 {} {})\">\n", px(width), px(x), px(y));
    const std::size_t count = codes.size();
    for (std::size_t i = 0; i < count;) {
        std::size_t end = i + 1;
        while (end < count && hex(codes[end]) == hex(codes[i]))
            ++end;
        const double left = static_cast<double>(i) + (with_half_ends && i == 0 ? 0.5 : 0);
        const double right = static_cast<double>(end) - (with_half_ends && end == count ? 0.5 : 0);
        svg.add("<path stroke=\"{}\" d=\"M{} 0h{}\"/>\n", hex(codes[i]), px(left),
                px(right - left));
        i = end;
    }
    svg.add("</g>\n");
}

constexpr double kPatchRow = 13;

/// Around patches, which may be as white as the page.
void draw_patch_frame(Svg& svg, double x, double y, double width, double height) {
    svg.add("<rect class=\"p\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", px(x - 0.5),
            px(y - 0.5), px(width + 1), px(height + 1));
}

/// Patches do not blend where they meet.
void begin_patches(Svg& svg, double height) {
    svg.add("<g stroke-width=\"{}\" shape-rendering=\"crispEdges\">\n", px(height));
}

double sweeps_height(std::size_t count) { return (kPatchRow + 2) * static_cast<double>(count) - 2; }

void draw_sweeps(Svg& svg, const std::vector<PatchRow>& sweeps, double top) {
    begin_patches(svg, kPatchRow);
    double y = top + kPatchRow / 2;
    for (const PatchRow& row : sweeps) {
        // Patches are centred on their stops: of the first and the last there is half.
        draw_patches(svg, row.codes, kLeft - kStop / 2, kStop, y, true);
        y += kPatchRow + 2;
    }
    svg.add("</g>\n");
    y = top;
    for (const PatchRow& row : sweeps) {
        draw_patch_frame(svg, kLeft, y, kRight - kLeft, kPatchRow);
        svg.text(kLeft - 5, y + kPatchRow / 2 + 4, "e", row.label);
        y += kPatchRow + 2;
    }
}

void draw_axis(Svg& svg, double top) {
    std::string ticks;
    for (int stop = kLowestStop; stop <= kHighestStop; stop += 2) {
        ticks += vertical(stop, top, top + 4);
        svg.text(x_of(stop), top + 16, "c",
                 tick_label(fmt::format("{}{}", stop > 0 ? "+" : "", stop)));
        svg.text(x_of(stop), top + 31, "c", scene_linear_at(stop));
    }
    svg.path("t", ticks);
    svg.text(kRight + 16, top + 16, "", "stops");
    svg.text(kRight + 16, top + 31, "", "scene");
}

/// The file around a body.
std::string file_of(const std::string& title, const std::string& description, double height,
                    const std::string& body) {
    Svg svg;
    svg.add(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
        "height=\"{1}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"11\">\n"
        "<title>{2}</title>\n<desc>{3}</desc>\n",
        px(kWidth), px(height), xml_escaped(title), xml_escaped(description));
    svg.add(
        "<style>text{{fill:#24292f}}.b{{font-size:14px;font-weight:bold}}"
        ".c{{text-anchor:middle}}.e{{text-anchor:end}}"
        ".h{{paint-order:stroke;stroke:#fff;stroke-width:3px;stroke-linejoin:round}}"
        ".g{{stroke:#e4e8ec}}.m{{stroke:{0};stroke-dasharray:2 3}}.t{{stroke:{0}}}"
        ".f{{fill:none;stroke:{0}}}.p{{fill:none;stroke:#d0d7de}}</style>\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        kFrame);
    return svg.take() + body + "</svg>\n";
}

}  // namespace

const std::vector<double>& plot_stops() {
    static const std::vector<double> stops = [] {
        constexpr double kStep = 0.5 / kStop;
        std::vector<double> all;
        const long count = std::lround((kHighestStop - kLowestStop) / kStep);
        for (long i = 0; i <= count; ++i)
            all.push_back(kLowestStop + static_cast<double>(i) * kStep);
        return all;
    }();
    return stops;
}

std::string line_color(std::size_t index) {
    // Okabe and Ito 2008; their yellow is darker here, to be seen on white.
    constexpr std::array kColors = {"#24292f", "#0072b2", "#d55e00", "#009e73",
                                    "#cc79a7", "#e69f00", "#56b4e9", "#9a8a00"};
    return kColors[index % kColors.size()];
}

std::string line_dashes(std::size_t index) {
    constexpr std::array kDashes = {"", "6 3", "2 2"};
    return kDashes[index / 8 % kDashes.size()];
}

std::string xml_escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

std::string to_svg(const CurvePlot& plot) {
    const bool has_lower = !plot.lower_lines.empty();
    const Graph upper{42, 220, {}};
    const Graph lower{upper.bottom() + 2 * kMargin + 10, 96, plot.lower_scale};
    const double graphs_end = (has_lower ? lower : upper).bottom() + kMargin;
    const double sweeps_end =
        graphs_end + (plot.sweeps.empty() ? 0 : 5 + sweeps_height(plot.sweeps.size()));

    Svg svg;
    svg.text(kLeft, 20, "b", plot.title);
    svg.text(kRight, 20, "e", plot.subtitle);
    svg.text(kLeft - 5, 28, "e", "code");
    svg.text(kRight + 5, 28, "", "light");
    draw_graph(svg, upper, true);
    svg.add("<g fill=\"none\" stroke-linejoin=\"round\">\n");
    // The first line is on top of the others.
    for (auto line = plot.lines.rbegin(); line != plot.lines.rend(); ++line)
        svg.curve(*line, upper);
    svg.add("</g>\n");
    draw_legend(svg, plot.lines, upper.top + 16);
    for (const PlotMark& mark : plot.marks) {
        const double y = upper.y_of(mark.code);
        svg.add("<circle cx=\"{}\" cy=\"{}\" r=\"3.5\"/>\n", px(x_of(mark.stops)), px(y));
        // Below the curve; above it where there is no room.
        if (y > upper.bottom() - 20) {
            svg.text(x_of(mark.stops) - 4, y - 9, "h e", mark.words);
        } else {
            svg.text(x_of(mark.stops) + 8, y + 15, "h", mark.words);
        }
    }
    if (has_lower) {
        draw_graph(svg, lower, false);
        svg.add("<g fill=\"none\" stroke-linejoin=\"round\">\n");
        for (auto line = plot.lower_lines.rbegin(); line != plot.lower_lines.rend(); ++line)
            svg.curve(*line, lower);
        svg.add("</g>\n");
        svg.text(kLeft + 10, lower.top + 12, "h", plot.lower_heading);
        draw_legend(svg, plot.lower_lines, lower.top + 28);
    }
    if (!plot.sweeps.empty()) draw_sweeps(svg, plot.sweeps, graphs_end + 5);
    draw_axis(svg, sweeps_end);
    std::string description =
        fmt::format("x = {} + {} (stops from 0.18 + {}), y = {} - {} code value", px(kLeft),
                    px(kStop), -kLowestStop, px(upper.y_of(0)), px(upper.unit()));
    if (has_lower) {
        description += fmt::format("; lower graph y = {} - {} value", px(lower.y_of(0)),
                                   shortest(lower.unit()));
    }
    return file_of(plot.title, description, sweeps_end + 38, svg.take());
}

std::string to_svg(const PatchChart& chart) {
    std::size_t columns = 0;
    for (const PatchBlock& block : chart.blocks)
        columns += block.columns.size();
    constexpr double kLabels = 205;
    constexpr double kEnd = kWidth - 14;
    constexpr double kGap = 12;
    const double width =
        std::floor((kEnd - kLabels - kGap * static_cast<double>(chart.blocks.size() - 1)) /
                   static_cast<double>(columns));
    constexpr double kFirstRow = 66;
    constexpr double kRowHeight = kPatchRow + 4;
    const double height = kRowHeight * static_cast<double>(chart.rows.size());

    Svg svg;
    svg.text(14, 20, "b", chart.title);
    svg.text(kEnd, 20, "e", chart.subtitle);
    double x = kLabels;
    std::size_t column = 0;
    for (const PatchBlock& block : chart.blocks) {
        const std::size_t count = block.columns.size();
        svg.text(x, 44, "", block.heading);
        for (std::size_t i = 0; i < count; ++i)
            svg.text(x + width * (static_cast<double>(i) + 0.5), 60, "c", block.columns[i]);
        begin_patches(svg, kRowHeight);
        for (std::size_t i = 0; i < chart.rows.size(); ++i) {
            draw_patches(svg, std::span(chart.rows[i].codes).subspan(column, count), x, width,
                         kFirstRow + kRowHeight * (static_cast<double>(i) + 0.5), false);
        }
        svg.add("</g>\n");
        draw_patch_frame(svg, x, kFirstRow, width * static_cast<double>(count), height);
        column += count;
        x += width * static_cast<double>(count) + kGap;
    }
    for (std::size_t i = 0; i < chart.rows.size(); ++i) {
        svg.text(14, kFirstRow + kRowHeight * (static_cast<double>(i) + 0.5) + 4, "",
                 chart.rows[i].label);
    }
    return file_of(chart.title, chart.subtitle, kFirstRow + height + 12, svg.take());
}

}  // namespace tonewright
