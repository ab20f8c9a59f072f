// SPDX-License-Identifier: Apache-2.0
#include "plot/curve_plot.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "plot/surface.h"

namespace tonewright {
namespace {

/// Records what is drawn.
class Recorder : public PlotSurface {
  public:
    void text(Point /*at*/, const TextStyle& /*style*/, std::string_view text) override {
        words.emplace(text);
    }
    void rules(Rule /*kind*/, std::span<const Segment> /*segments*/) override {}
    void frame(Frame kind, Point /*at*/, double /*width*/, double /*height*/) override {
        graphs += kind == Frame::graph ? 1 : 0;
    }
    void dot(Point center) override { dots.push_back(center); }
    void sample(const PlotLine& line, Point /*from*/, double /*length*/) override {
        samples.push_back(line.id);
    }
    void begin_lines() override { ++open; }
    void line(const PlotLine& line, std::span<const Point> points) override {
        lines.push_back({line.id, {points.begin(), points.end()}});
    }
    void begin_patches(double /*height*/) override { ++open; }
    void patches(Point /*left*/, double /*width*/, std::span<const Patch> row) override {
        rows.emplace_back(row.begin(), row.end());
    }
    void end_group() override { --open; }

    struct Line {
        std::string id;
        std::vector<Point> points;
    };
    std::multiset<std::string> words;
    std::vector<Line> lines;
    std::vector<std::string> samples;
    std::vector<Point> dots;
    std::vector<std::vector<Patch>> rows;
    int graphs = 0;
    int open = 0;  // groups
};

/// Straight lines from 0 to 1.
CurvePlot plot_of_lines(std::size_t count) {
    CurvePlot plot;
    plot.title = "Title";
    for (std::size_t i = 0; i < count; ++i) {
        const std::string name = "line" + std::to_string(i);
        plot.lines.push_back({name, name, line_color(i), 1.5, line_dashes(i), {}});
        for (const double stops : plot_stops())
            plot.lines.back().values.push_back((stops + 10) / 20);
    }
    return plot;
}

TEST(CurvePlot, StraightLineHasTwoPoints) {
    Recorder surface;
    draw(plot_of_lines(1), surface);
    ASSERT_EQ(surface.lines.size(), 1);
    const std::vector<PlotSurface::Point>& points = surface.lines[0].points;
    ASSERT_EQ(points.size(), 2);
    EXPECT_LT(points[0].x, points[1].x);
    EXPECT_GT(points[0].y, points[1].y) << "y goes down";
    EXPECT_TRUE(surface.words.contains("Title"));
    EXPECT_EQ(surface.open, 0);
}

TEST(CurvePlot, FirstLineIsOnTopOfTheOthers) {
    Recorder surface;
    draw(plot_of_lines(3), surface);
    EXPECT_EQ(surface.lines.back().id, "line0");
    EXPECT_EQ(surface.samples, (std::vector<std::string>{"line0", "line1", "line2"}));
}

TEST(CurvePlot, ManyLinesHaveSmallGraphsInsteadOfALegend) {
    Recorder few;
    draw(plot_of_lines(6), few);
    EXPECT_EQ(few.graphs, 1);
    Recorder many;
    draw(plot_of_lines(7), many);
    EXPECT_EQ(many.graphs, 8);
    EXPECT_EQ(many.samples.size(), 7);
    EXPECT_GT(height_of(plot_of_lines(7)), height_of(plot_of_lines(6)) + 200);
}

TEST(CurvePlot, MarkIsADotOnTheLineWithWords) {
    CurvePlot plot = plot_of_lines(1);
    plot.marks = {{0, 0.5, "here"}};
    Recorder surface;
    draw(plot, surface);
    ASSERT_EQ(surface.dots.size(), 1);
    const std::vector<PlotSurface::Point>& points = surface.lines[0].points;
    EXPECT_NEAR(surface.dots[0].x, (points[0].x + points[1].x) / 2, 0.01);
    EXPECT_NEAR(surface.dots[0].y, (points[0].y + points[1].y) / 2, 0.01);
    EXPECT_TRUE(surface.words.contains("here"));
}

TEST(CurvePlot, EqualNeighborsAreOnePatch) {
    PatchChart chart;
    chart.title = "Colors";
    chart.blocks = {{"block", {"a", "b", "c"}}};
    chart.rows = {{"row", {{0, 0, 0}, {0, 0, 0.001}, {1, 0.5, 0}}}};
    Recorder surface;
    draw(chart, surface);
    ASSERT_EQ(surface.rows.size(), 1);
    ASSERT_EQ(surface.rows[0].size(), 2);
    EXPECT_EQ(surface.rows[0][0].color, "#000000");
    EXPECT_EQ(surface.rows[0][0].right, 2);
    EXPECT_EQ(surface.rows[0][1].color, "#ff8000");
    EXPECT_TRUE(surface.words.contains("row"));
    EXPECT_EQ(surface.open, 0);
}

TEST(CurvePlot, ColorsAndDashesTellLinesApart) {
    std::set<std::pair<std::string, std::vector<double>>> styles;
    for (std::size_t i = 0; i < 24; ++i)
        styles.insert({line_color(i), line_dashes(i)});
    EXPECT_EQ(styles.size(), 24);
}

TEST(Svg, IsTheSameOnEveryRunAndEscapesWords) {
    CurvePlot plot = plot_of_lines(2);
    plot.title = "<A> & \"B\"";
    const std::string svg = to_svg(plot);
    EXPECT_EQ(svg, to_svg(plot));
    EXPECT_NE(svg.find("<title>&lt;A&gt; &amp; &quot;B&quot;</title>"), std::string::npos);
    EXPECT_NE(svg.find("<polyline id=\"line1\""), std::string::npos);
    EXPECT_NE(svg.find("<desc>" + axes_of(plot) + "</desc>"), std::string::npos);
}

TEST(PlotSurface, NumbersHaveAtMostTwoDecimals) {
    EXPECT_EQ(two_decimals(1), "1");
    EXPECT_EQ(two_decimals(0.5), "0.5");
    EXPECT_EQ(two_decimals(1.006), "1.01");
    EXPECT_EQ(two_decimals(-0.001), "0");
}

TEST(PlotSurface, WordsAreWrittenInTheLettersOfTheFont) {
    const Lettering letters = lettering_of(kPlain, "\u22122 \u2192 3\u00d7");
    EXPECT_EQ(letters.ascii, "-2 -> 3x");
    EXPECT_TRUE(letters.is_complete);
    EXPECT_GT(letters.width, 20);
    const Lettering other = lettering_of(kHeading, "\u00c9t\u00e9");
    EXPECT_EQ(other.ascii, "?t?");
    EXPECT_FALSE(other.is_complete);
    EXPECT_GT(other.stroke_width, letters.stroke_width);
    EXPECT_EQ(anchor_offset({PlotSurface::Anchor::end}, letters), letters.width);
    EXPECT_EQ(anchor_offset({PlotSurface::Anchor::middle}, letters), letters.width / 2);
}

}  // namespace
}  // namespace tonewright
