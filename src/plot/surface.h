// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "plot/curve_plot.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// About the width at which a page shows a plot: the unit of all coordinates is a pixel of a
/// picture this wide.
inline constexpr double kPlotWidth = 640;
inline constexpr double kDotRadius = 3.5;
/// Width of the page's color around words on lines, both sides together.
inline constexpr double kHaloWidth = 3;

/// sRGB colors of what is not data, `#rgb` or `#rrggbb`.
struct PlotColors {
    std::string_view page;
    std::string_view text;
    std::string_view frame;
    std::string_view grid;
    std::string_view patch_frame;  // around patches, which may be as light as the page
    std::string_view dot;
};
[[nodiscard]] const PlotColors& colors_of(PlotTheme theme);

/// The target of a plot: an SVG file, a PDF file, or pixels.
class PlotSurface {
  public:
    enum class Anchor : unsigned char { start, middle, end };
    struct TextStyle {
        Anchor anchor = Anchor::start;
        bool has_halo = false;  // in the page's color, in front of lines
        bool is_heading = false;
    };
    enum class Rule : unsigned char { grid, mark, tick };
    enum class Frame : unsigned char { graph, patches };
    struct Point {
        double x, y;
    };
    /// Horizontal or vertical.
    struct Segment {
        Point from, to;
    };
    /// From `left` to `right` of a row, in widths of a patch.
    struct Patch {
        std::string color;
        double left, right;
    };

    PlotSurface() = default;
    PlotSurface(const PlotSurface&) = delete;
    PlotSurface& operator=(const PlotSurface&) = delete;
    virtual ~PlotSurface() = default;

    /// One line of words, UTF-8, that starts, ends or has its middle at `at`, on the baseline.
    virtual void text(Point at, const TextStyle& style, std::string_view words) = 0;
    virtual void rules(Rule kind, std::span<const Segment> segments) = 0;
    virtual void frame(Frame kind, Point top_left, double width, double height) = 0;
    virtual void dot(Point center) = 0;
    /// The appearance of a line, for a legend.
    virtual void sample(const PlotLine& line, Point from, double length) = 0;

    /// Lines of data come between begin_lines() and end_group().
    virtual void begin_lines() = 0;
    virtual void line(const PlotLine& line, std::span<const Point> points) = 0;
    /// And rows of patches, which do not blend where they meet, after begin_patches().
    virtual void begin_patches(double height) = 0;
    /// @param left  middle of the row's left side; @param width  of a patch
    virtual void patches(Point left, double width, std::span<const Patch> row) = 0;
    virtual void end_group() = 0;
};

inline constexpr PlotSurface::TextStyle kPlain = {};
inline constexpr PlotSurface::TextStyle kHeading = {PlotSurface::Anchor::start, false, true};

/// The words of a plot in the stroke font.
struct Lettering {
    std::string ascii;
    /// The font has all characters: none became `?`.
    bool is_complete = true;
    double unit = 0;  // of the font's glyphs
    double stroke_width = 0;
    double width = 0;
};
[[nodiscard]] Lettering lettering_of(const PlotSurface::TextStyle& style, std::string_view words);
/// From the start of words to their anchor.
[[nodiscard]] double anchor_offset(const PlotSurface::TextStyle& style, const Lettering& letters);

/// Draws everything in front of the page's color.
void draw(const CurvePlot& plot, PlotSurface& surface);
void draw(const PatchChart& chart, PlotSurface& surface);
[[nodiscard]] double height_of(const CurvePlot& plot);
[[nodiscard]] double height_of(const PatchChart& chart);

/// Formulas for positions, for readers of a file: `x = 50 + 27 (stops from 0.18 + 10), y = ...`.
[[nodiscard]] std::string axes_of(const CurvePlot& plot);

/// At most two decimals, without trailing zeros.
[[nodiscard]] std::string two_decimals(double value);

TONEWRIGHT_NAMESPACE_END
