// SPDX-License-Identifier: Apache-2.0
#include "plot/curve_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>

#include "base/format_number.h"
#include "plot/surface.h"
#include "tonewright/color.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Anchor = PlotSurface::Anchor;
using Patch = PlotSurface::Patch;
using Point = PlotSurface::Point;
using Rule = PlotSurface::Rule;
using Segment = PlotSurface::Segment;

constexpr PlotSurface::TextStyle kCentered = {Anchor::middle};
constexpr PlotSurface::TextStyle kAtEnd = {Anchor::end};
constexpr PlotSurface::TextStyle kOnLines = {Anchor::start, true};

constexpr double kLeft = 50;
constexpr double kStop = 27;  // width of one stop
constexpr int kLowestStop = -10;
constexpr int kHighestStop = 10;
constexpr double kRight = kLeft + kStop * (kHighestStop - kLowestStop);
constexpr double kMargin = 6;  // between a graph's frame and code values 0 and 1
constexpr double kLegendRow = 15;

double x_of(double stops) { return kLeft + kStop * (stops - kLowestStop); }

/// Scene-linear 1, in stops from mid gray.
const double kWhiteStops = std::log2(1 / 0.18);

/// Position of a graph.
struct Graph {
    double top;  // of the scale's high end
    double height;
    PlotScale scale;
    double left = kLeft;
    double width = kRight - kLeft;

    [[nodiscard]] double x_of(double stops) const {
        return left + width * (stops - kLowestStop) / (kHighestStop - kLowestStop);
    }
    [[nodiscard]] double unit() const { return height / (scale.high - scale.low); }
    [[nodiscard]] double y_of(double value) const { return top + unit() * (scale.high - value); }
    [[nodiscard]] double bottom() const { return top + height; }
};

/// Douglas and Peucker 1973, with the distance along y: selects the points that a line needs.
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

std::vector<Point> points_of(const PlotLine& line, const Graph& graph) {
    const std::vector<double>& stops = plot_stops();
    std::vector<double> x;
    std::vector<double> y;
    for (std::size_t i = 0; i < stops.size(); ++i) {
        x.push_back(std::round(100 * graph.x_of(stops[i])) / 100);
        y.push_back(std::round(100 * graph.y_of(line.values.at(i))) / 100);
    }
    std::vector<bool> is_needed(x.size());
    is_needed.front() = is_needed.back() = true;
    mark_needed(x, y, 0, x.size() - 1, is_needed);
    std::vector<Point> points;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (is_needed[i]) points.push_back({x[i], y[i]});
    }
    return points;
}

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

Segment vertical(double stops, double top, double bottom) {
    return {{x_of(stops), top}, {x_of(stops), bottom}};
}

/// Every step of the scale.
std::vector<PlotTick> even_ticks(const PlotScale& scale) {
    std::vector<PlotTick> ticks;
    const auto steps = static_cast<int>(std::lround((scale.high - scale.low) / scale.step));
    for (int i = 0; i <= steps; ++i) {
        const double value = scale.low + i * scale.step;
        ticks.push_back({value, tick_label(two_decimals(value)), ""});
    }
    return ticks;
}

/// sRGB code values, with their light at the right.
PlotScale srgb_scale() {
    PlotScale scale;
    scale.ticks = even_ticks(scale);
    for (PlotTick& tick : scale.ticks) {
        const double percent = 100 * evaluate(srgb_decode(Expr::input()), tick.value);
        if (percent > 0) tick.right = fmt::format("{:.{}f} %", percent, percent < 10 ? 1 : 0);
    }
    return scale;
}

/// Frame, grid and the numbers at the sides.
void draw_graph(PlotSurface& surface, const Graph& graph) {
    const double top = graph.top - kMargin;
    const double bottom = graph.bottom() + kMargin;
    std::vector<Segment> grid;
    for (int stop = kLowestStop; stop <= kHighestStop; stop += 2)
        grid.push_back(vertical(stop, top, bottom));
    const PlotScale& scale = graph.scale;
    for (const PlotTick& tick : scale.ticks.empty() ? even_ticks(scale) : scale.ticks) {
        const double y = graph.y_of(tick.value);
        if (!tick.left.empty()) {
            grid.push_back({{kLeft, y}, {kRight, y}});
            surface.text({kLeft - 5, y + 4}, kAtEnd, tick.left);
        }
        if (!tick.right.empty()) surface.text({kRight + 5, y + 4}, kPlain, tick.right);
    }
    surface.rules(Rule::grid, grid);
    surface.rules(Rule::mark, {{vertical(0, top, bottom), vertical(kWhiteStops, top, bottom)}});
    surface.frame(PlotSurface::Frame::graph, {kLeft, top}, kRight - kLeft, bottom - top);
}

void draw_lines(PlotSurface& surface, const std::vector<PlotLine>& lines, const Graph& graph) {
    surface.begin_lines();
    // The first line is on top of the others.
    for (auto line = lines.rbegin(); line != lines.rend(); ++line)
        surface.line(*line, points_of(*line, graph));
    surface.end_group();
}

/// A label of several names continues in the next row after this many letters.
constexpr std::size_t kLegendLetters = 36;

std::vector<std::string> wrapped(const std::string& label, std::size_t letters = kLegendLetters) {
    std::vector<std::string> rows = {""};
    std::size_t begin = 0;
    while (begin < label.size()) {
        const std::size_t comma = label.find(", ", begin);
        const std::size_t end = comma == std::string::npos ? label.size() : comma + 2;
        if (!rows.back().empty() && rows.back().size() + end - begin > letters) rows.emplace_back();
        rows.back() += label.substr(begin, end - begin);
        begin = end;
    }
    return rows;
}

/// @return the height of the rows
double draw_legend_entry(PlotSurface& surface, const PlotLine& line, double left, double y) {
    surface.sample(line, {left, y - 4}, 24);
    double height = 0;
    for (const std::string& row : wrapped(line.label)) {
        surface.text({left + 30, y + height}, kOnLines, row);
        height += kLegendRow;
    }
    return height;
}

void draw_legend(PlotSurface& surface, const std::vector<PlotLine>& lines, double top) {
    double y = top;
    for (const PlotLine& line : lines) {
        if (!line.label.empty()) y += draw_legend_entry(surface, line, kLeft + 10, y);
    }
}

std::string hex(const Vector3& code) {
    std::string text = "#";
    for (const double c : code)
        text += fmt::format("{:02x}", std::lround(255 * std::clamp(c, 0.0, 1.0)));
    return text;
}

/// A row of patches; equal neighbors are one patch.
/// @param with_half_ends  the first patch has its right half only, the last one its left half
void draw_patches(PlotSurface& surface, std::span<const Vector3> codes, Point left, double width,
                  bool with_half_ends) {
    std::vector<Patch> row;
    const std::size_t count = codes.size();
    for (std::size_t i = 0; i < count;) {
        std::size_t end = i + 1;
        while (end < count && hex(codes[end]) == hex(codes[i]))
            ++end;
        row.push_back({hex(codes[i]), static_cast<double>(i) + (with_half_ends && i == 0 ? 0.5 : 0),
                       static_cast<double>(end) - (with_half_ends && end == count ? 0.5 : 0)});
        i = end;
    }
    surface.patches(left, width, row);
}

constexpr double kPatchRow = 13;

// Layout of a chart of patches.
constexpr double kFirstRow = 66;
constexpr double kRowHeight = kPatchRow + 4;

/// Around patches, which may be as white as the page.
void draw_patch_frame(PlotSurface& surface, double x, double y, double width, double height) {
    surface.frame(PlotSurface::Frame::patches, {x - 0.5, y - 0.5}, width + 1, height + 1);
}

double sweeps_height(std::size_t count) { return (kPatchRow + 2) * static_cast<double>(count) - 2; }

void draw_sweeps(PlotSurface& surface, const std::vector<PatchRow>& sweeps, double top) {
    surface.begin_patches(kPatchRow);
    double y = top + kPatchRow / 2;
    for (const PatchRow& row : sweeps) {
        // Patches are centered on their stops, so the first and the last are half patches.
        draw_patches(surface, row.codes, {kLeft - kStop / 2, y}, kStop, true);
        y += kPatchRow + 2;
    }
    surface.end_group();
    y = top;
    for (const PatchRow& row : sweeps) {
        draw_patch_frame(surface, kLeft, y, kRight - kLeft, kPatchRow);
        surface.text({kLeft - 5, y + kPatchRow / 2 + 4}, kAtEnd, row.label);
        y += kPatchRow + 2;
    }
}

void draw_axis(PlotSurface& surface, double top) {
    std::vector<Segment> ticks;
    for (int stop = kLowestStop; stop <= kHighestStop; stop += 2) {
        ticks.push_back(vertical(stop, top, top + 4));
        surface.text({x_of(stop), top + 16}, kCentered,
                     tick_label(fmt::format("{}{}", stop > 0 ? "+" : "", stop)));
        surface.text({x_of(stop), top + 31}, kCentered, scene_linear_at(stop));
    }
    surface.rules(Rule::tick, ticks);
    surface.text({kRight + 16, top + 16}, kPlain, "stops");
    surface.text({kRight + 16, top + 31}, kPlain, "scene");
}

/// Too many lines for one graph and its legend: each line gets a small graph of its own, with the
/// first line in the background, instead of a legend.
constexpr std::size_t kMostLinesInside = 6;

/// A grid of small graphs, one for each line with a label.
class SmallGraphs {
  public:
    SmallGraphs(const CurvePlot& plot, const PlotScale& scale) : plot_(plot), scale_(scale) {
        for (const PlotLine& line : plot.lines) {
            if (!line.label.empty()) lines_.push_back(&line);
        }
        if (lines_.size() <= kMostLinesInside) lines_.clear();
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            if (i % kColumns == 0) label_rows_.push_back(1);
            label_rows_.back() =
                std::max(label_rows_.back(), wrapped(lines_[i]->label, kLetters).size());
        }
    }

    [[nodiscard]] bool empty() const { return lines_.empty(); }
    [[nodiscard]] double height() const {
        double height = 0;
        for (const std::size_t rows : label_rows_)
            height += row_height(rows);
        return height;
    }

    void draw(PlotSurface& surface, double top) const {
        double y = top;
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            const std::size_t rows = label_rows_[i / kColumns];
            const double labels = kLegendRow * static_cast<double>(rows);
            draw_one(surface, *lines_[i],
                     {y + labels + kInset, kHeight, scale_,
                      kLeft + static_cast<double>(i % kColumns) * (kWidth + kGap), kWidth});
            if (i % kColumns == kColumns - 1) y += row_height(rows);
        }
    }

  private:
    static constexpr std::size_t kColumns = 3;
    static constexpr std::size_t kLetters = 24;
    static constexpr double kGap = 15;
    static constexpr double kWidth = (kRight - kLeft - (kColumns - 1) * kGap) / kColumns;
    static constexpr double kHeight = 70;
    static constexpr double kInset = 3;  // between the frame and the ends of the scale

    static double row_height(std::size_t label_rows) {
        return kLegendRow * static_cast<double>(label_rows) + kHeight + 2 * kInset + 8;
    }

    void draw_one(PlotSurface& surface, const PlotLine& line, const Graph& graph) const {
        const double top = graph.top - kInset;
        const double bottom = graph.bottom() + kInset;
        const std::vector<std::string> words = wrapped(line.label, kLetters);
        double y = top - kLegendRow * static_cast<double>(words.size()) + 10;
        surface.sample(line, {graph.left, y - 4}, 18);
        for (const std::string& row : words) {
            surface.text({graph.left + 23, y}, kPlain, row);
            y += kLegendRow;
        }
        std::vector<Segment> marks;
        for (const double stops : {0.0, kWhiteStops})
            marks.push_back({{graph.x_of(stops), top}, {graph.x_of(stops), bottom}});
        surface.rules(Rule::mark, marks);
        surface.frame(PlotSurface::Frame::graph, {graph.left, top}, graph.width, bottom - top);
        surface.begin_lines();
        PlotLine first = *lines_.front();
        first.id = "small-" + line.id + "-first";
        first.color = std::string(colors_of(plot_.theme).frame);
        first.width = 1;
        first.dashes.clear();
        if (&line != lines_.front()) surface.line(first, points_of(first, graph));
        PlotLine own = line;
        own.id = "small-" + line.id;
        own.width = 1.8;
        surface.line(own, points_of(own, graph));
        surface.end_group();
    }

    const CurvePlot& plot_;
    const PlotScale& scale_;
    std::vector<const PlotLine*> lines_;
    std::vector<std::size_t> label_rows_;  // of each row of graphs
};

/// Positions of the parts of a plot.
struct Layout {
    Graph upper;
    Graph lower;
    SmallGraphs small;
    double sweeps_top;
    double axis_top;
    double small_top;
    double height;

    explicit Layout(const CurvePlot& plot)
        : upper{42, 220, plot.scale.ticks.empty() ? srgb_scale() : plot.scale},
          lower{upper.bottom() + 2 * kMargin + 24, 96, plot.lower_scale},
          small(plot, upper.scale) {
        const bool has_lower = !plot.lower_lines.empty();
        sweeps_top = (has_lower ? lower : upper).bottom() + kMargin + 5;
        axis_top =
            plot.sweeps.empty() ? sweeps_top - 5 : sweeps_top + sweeps_height(plot.sweeps.size());
        height = axis_top + 38;
        small_top = height + 8;
        if (!small.empty()) height = small_top + small.height();
    }
    Layout(const Layout&) = delete;
    Layout& operator=(const Layout&) = delete;
};

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

std::string line_color(std::size_t index, PlotTheme theme) {
    // Okabe and Ito 2008; on white their yellow is darker, on black their black and blue lighter.
    constexpr std::array kLight = {"#24292f", "#0072b2", "#d55e00", "#009e73",
                                   "#cc79a7", "#e69f00", "#56b4e9", "#9a8a00"};
    constexpr std::array kDark = {"#f2f4f6", "#2b8fd0", "#d55e00", "#009e73",
                                  "#cc79a7", "#e69f00", "#8fd0f5", "#f0e442"};
    return (theme == PlotTheme::light ? kLight : kDark)[index % kLight.size()];
}

std::vector<double> line_dashes(std::size_t index) {
    switch (index / 8 % 3) {
        case 0:
            return {};
        case 1:
            return {6, 3};
        default:
            return {2, 2};
    }
}

double height_of(const CurvePlot& plot) { return Layout(plot).height; }

void draw(const CurvePlot& plot, PlotSurface& surface) {
    const Layout layout(plot);
    const Graph& upper = layout.upper;
    surface.text({kLeft, 20}, kHeading, plot.title);
    surface.text({kRight, 20}, kAtEnd, plot.subtitle);
    surface.text({kLeft - 5, 28}, kAtEnd, upper.scale.left_heading);
    surface.text({kRight + 5, 28}, kPlain, upper.scale.right_heading);
    // Above the frame, where no curve is: the marks are above the two vertical lines.
    constexpr double kOverLine = 22;
    for (const PlotMark& mark : plot.marks) {
        const bool is_first = mark.stops <= 0;
        surface.text({x_of(mark.stops) + (is_first ? kOverLine : -kOverLine), 32},
                     is_first ? kAtEnd : kPlain, mark.words);
    }
    if (plot.names_grays && plot.marks.empty()) {
        surface.text({x_of(0), 32}, kCentered, "mid gray");
        surface.text({x_of(kWhiteStops), 32}, kCentered, "white");
    }
    draw_graph(surface, upper);
    draw_lines(surface, plot.lines, upper);
    if (layout.small.empty()) draw_legend(surface, plot.lines, upper.top + 16);
    for (const PlotMark& mark : plot.marks)
        surface.dot({x_of(mark.stops), upper.y_of(mark.value)});
    if (!plot.lower_lines.empty()) {
        const Graph& lower = layout.lower;
        draw_graph(surface, lower);
        draw_lines(surface, plot.lower_lines, lower);
        surface.text({kLeft, lower.top - kMargin - 5}, kPlain, plot.lower_heading);
        draw_legend(surface, plot.lower_lines, lower.top + 16);
    }
    if (!plot.sweeps.empty()) draw_sweeps(surface, plot.sweeps, layout.sweeps_top);
    draw_axis(surface, layout.axis_top);
    layout.small.draw(surface, layout.small_top);
}

std::string axes_of(const CurvePlot& plot) {
    const Layout layout(plot);
    std::string description =
        fmt::format("x = {} + {} (stops from 0.18 + {}), y = {} - {} {}", two_decimals(kLeft),
                    two_decimals(kStop), -kLowestStop, shortest(layout.upper.y_of(0)),
                    shortest(layout.upper.unit()), layout.upper.scale.quantity);
    if (!plot.lower_lines.empty()) {
        description +=
            fmt::format("; lower graph y = {} - {} value", two_decimals(layout.lower.y_of(0)),
                        shortest(layout.lower.unit()));
    }
    return description;
}

double height_of(const PatchChart& chart) {
    return kFirstRow + kRowHeight * static_cast<double>(chart.rows.size()) + 12;
}

void draw(const PatchChart& chart, PlotSurface& surface) {
    std::size_t columns = 0;
    for (const PatchBlock& block : chart.blocks)
        columns += block.columns.size();
    constexpr double kLabels = 205;
    constexpr double kEnd = kPlotWidth - 14;
    constexpr double kGap = 12;
    const double width =
        std::floor((kEnd - kLabels - kGap * static_cast<double>(chart.blocks.size() - 1)) /
                   static_cast<double>(columns));
    const double height = kRowHeight * static_cast<double>(chart.rows.size());

    surface.text({14, 20}, kHeading, chart.title);
    surface.text({kEnd, 20}, kAtEnd, chart.subtitle);
    double x = kLabels;
    std::size_t column = 0;
    for (const PatchBlock& block : chart.blocks) {
        const std::size_t count = block.columns.size();
        surface.text({x, 44}, kPlain, block.heading);
        for (std::size_t i = 0; i < count; ++i)
            surface.text({x + width * (static_cast<double>(i) + 0.5), 60}, kCentered,
                         block.columns[i]);
        surface.begin_patches(kRowHeight);
        for (std::size_t i = 0; i < chart.rows.size(); ++i) {
            draw_patches(surface, std::span(chart.rows[i].codes).subspan(column, count),
                         {x, kFirstRow + kRowHeight * (static_cast<double>(i) + 0.5)}, width,
                         false);
        }
        surface.end_group();
        draw_patch_frame(surface, x, kFirstRow, width * static_cast<double>(count), height);
        column += count;
        x += width * static_cast<double>(count) + kGap;
    }
    for (std::size_t i = 0; i < chart.rows.size(); ++i) {
        surface.text({14, kFirstRow + kRowHeight * (static_cast<double>(i) + 0.5) + 4}, kPlain,
                     chart.rows[i].label);
    }
}

TONEWRIGHT_NAMESPACE_END
