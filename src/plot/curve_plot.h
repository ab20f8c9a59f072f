// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tonewright/color.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Stops from mid gray of the points of a plot's lines: -10..+10, half a pixel apart.
[[nodiscard]] const std::vector<double>& plot_stops();

/// One line of a plot.
struct PlotLine {
    std::string id;     // of its element; unique in the plot
    std::string label;  // in the legend; empty: left out
    std::string color;
    double width = 1.5;
    std::vector<double> dashes;  // and gaps in turn; empty: a solid line
    std::vector<double> values;  // display code values as a rule, one for each of plot_stops()
};

/// A number at the side of a graph.
struct PlotTick {
    double value;
    std::string left;   // with a line across the graph; empty: neither
    std::string right;  // empty: none
};

/// Numbers and texts at the sides of a graph.
struct PlotScale {
    double low = 0;
    double high = 1;
    double step = 0.2;
    std::vector<PlotTick> ticks = {};  // empty: one every step, at the left
    std::string left_heading = "code";
    std::string right_heading = "light";
    std::string quantity = "code value";  // meaning of the values
};

/// A point of a line, with a text above the graph.
struct PlotMark {
    double stops;
    double value;
    std::string words;
};

/// Display code values of one color, shown with the color itself.
struct PatchRow {
    std::string label;
    std::vector<Vector3> codes;
};

/// The background of a plot: lines and text have colors that are readable on it.
enum class PlotTheme : unsigned char { light, dark };

/// Displayed values over stops. Empty parts are left out.
struct CurvePlot {
    PlotTheme theme = PlotTheme::light;
    std::string title;
    std::string subtitle;
    /// Without ticks: sRGB code values, with their display-linear values at the right.
    PlotScale scale;
    bool names_grays = false;  // above the lines at mid gray and white, where no marks are
    /// With labels: a legend in an empty part of the graph, at the left; with more than six lines,
    /// a small graph for each.
    std::vector<PlotLine> lines;
    /// At most one up to mid gray and one above, because their labels are side by side.
    std::vector<PlotMark> marks;
    /// A second, lower graph over the same stops.
    std::string lower_heading;
    PlotScale lower_scale;
    std::vector<PlotLine> lower_lines;
    /// One patch for every whole stop, in line with the graphs above.
    std::vector<PatchRow> sweeps;
};

/// One scene color at several exposures: patches beside each other under a heading.
struct PatchBlock {
    std::string heading;
    std::vector<std::string> columns;
};

/// Rows of patches: the same colors through several operators.
struct PatchChart {
    std::string title;
    std::string subtitle;
    std::vector<PatchBlock> blocks;
    std::vector<PatchRow> rows;  // each with the patches of all blocks
};

/// The plot as a standalone SVG file: no script, no font, no link; the same bytes on every run. A
/// line has the fewest points that keep it within a fifth of a pixel of its values.
/// @param width  default width on a page
[[nodiscard]] std::string to_svg(const CurvePlot& plot, double width = 640);
[[nodiscard]] std::string to_svg(const PatchChart& chart);
/// Color `index` of a set that color-blind readers can tell apart (Okabe and Ito 2008), and the
/// dashes of its line: from the ninth on, the colors repeat, dashed.
[[nodiscard]] std::string line_color(std::size_t index, PlotTheme theme = PlotTheme::light);
[[nodiscard]] std::vector<double> line_dashes(std::size_t index);

TONEWRIGHT_NAMESPACE_END
