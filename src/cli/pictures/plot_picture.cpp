// SPDX-License-Identifier: Apache-2.0
//
// Plots as pixels.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <sstream>

#include "cli/pictures/commands.h"
#include "cli/plot_surface.h"
#include "image/canvas.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// `#rgb` or `#rrggbb` as code values.
Rgb parse_color(std::string_view text) {
    Rgb color{};
    const std::size_t digits = text.size() == 4 ? 1 : 2;
    for (std::size_t c = 0; c < 3; ++c) {
        unsigned code = 0;
        const char* from = text.data() + 1 + c * digits;
        std::from_chars(from, from + digits, code, 16);
        color[c] = static_cast<float>(digits == 1 ? 17 * code : code) / 255;
    }
    return color;
}

class CanvasSurface : public PlotSurface {
  public:
    CanvasSurface(Canvas& canvas, double scale, const PlotColors& colors)
        : canvas_(canvas), scale_(scale), colors_(colors) {}

    void text(Point at, const TextStyle& style, std::string_view words) override {
        const Lettering letters = lettering_of(style, words);
        const auto align = static_cast<Canvas::Align>(style.anchor);
        const auto draw = [&](std::string_view color, double extra) {
            canvas_.text(letters.ascii, at.x * scale_, at.y * scale_, letters.cap_height * scale_,
                         parse_color(color), align, extra * scale_);
        };
        if (style.has_halo) draw(colors_.page, kHaloWidth);
        draw(colors_.text, letters.extra_width);
    }
    void rules(Rule kind, std::span<const Segment> segments) override {
        const Rgb color = parse_color(kind == Rule::grid ? colors_.grid : colors_.frame);
        for (const Segment& s : segments) {
            if (kind != Rule::mark) {
                rule(s.from, s.to, color);
                continue;
            }
            constexpr double kDash = 2;
            constexpr double kGap = 3;
            for (double y = s.from.y; y < s.to.y; y += kDash + kGap)
                rule({s.from.x, y}, {s.from.x, std::min(y + kDash, s.to.y)}, color);
        }
    }
    void frame(Frame kind, Point p, double width, double height) override {
        const Rgb color = parse_color(kind == Frame::graph ? colors_.frame : colors_.patch_frame);
        const double right = p.x + width;
        const double bottom = p.y + height;
        rule(p, {right, p.y}, color);
        rule({p.x, bottom}, {right, bottom}, color);
        rule(p, {p.x, bottom}, color);
        rule({right, p.y}, {right, bottom}, color);
    }
    void dot(Point center) override {
        const Stroke point = stroke_of(center, center);
        canvas_.strokes({&point, 1}, 2 * kDotRadius * scale_, parse_color(colors_.dot));
    }
    void sample(const PlotLine& line, Point from, double length) override {
        const std::array<Point, 2> ends = {{from, {from.x + length, from.y}}};
        this->line(line, ends);
    }
    void begin_lines() override {}
    void line(const PlotLine& line, std::span<const Point> points) override {
        canvas_.strokes(line.dashes.empty() ? solid(points) : dashed(line, points),
                        line.width * scale_, parse_color(line.color));
    }
    void begin_patches(double height) override { patch_height_ = height; }
    void patches(Point left, double width, std::span<const Patch> row) override {
        for (const Patch& patch : row) {
            canvas_.fill(whole(left.x + patch.left * width), whole(left.y - patch_height_ / 2),
                         whole(left.x + patch.right * width), whole(left.y + patch_height_ / 2),
                         parse_color(patch.color));
        }
    }
    void end_group() override {}

  private:
    [[nodiscard]] int whole(double at) const { return static_cast<int>(std::lround(at * scale_)); }
    [[nodiscard]] Stroke stroke_of(Point from, Point to) const {
        const auto f = [&](double v) { return static_cast<float>(v * scale_); };
        return {f(from.x), f(from.y), f(to.x), f(to.y)};
    }
    /// A horizontal or vertical line of whole pixels.
    void rule(Point from, Point to, const Rgb& color) {
        const int width = std::max(1, static_cast<int>(std::lround(scale_)));
        const auto first = [&](double at) {
            return static_cast<int>(std::lround(at * scale_ - width / 2.0));
        };
        const bool is_vertical = from.x == to.x;
        canvas_.fill(first(from.x), first(from.y), is_vertical ? first(to.x) + width : whole(to.x),
                     is_vertical ? whole(to.y) : first(to.y) + width, color);
    }
    [[nodiscard]] std::vector<Stroke> solid(std::span<const Point> points) const {
        std::vector<Stroke> strokes;
        for (std::size_t i = 1; i < points.size(); ++i)
            strokes.push_back(stroke_of(points[i - 1], points[i]));
        return strokes;
    }
    /// Lengths of dashes and gaps in turn; ends of strokes are round, and reach into the gaps.
    [[nodiscard]] std::vector<Stroke> dashed(const PlotLine& line,
                                             std::span<const Point> points) const {
        std::vector<double> lengths;
        std::istringstream list(line.dashes);
        for (double length = 0; list >> length;)
            lengths.push_back(length);
        std::vector<Stroke> strokes;
        std::size_t part = 0;
        double left = lengths[0];  // of this dash or gap
        for (std::size_t i = 1; i < points.size(); ++i) {
            const Point a = points[i - 1];
            const Point b = points[i];
            const double length = std::hypot(b.x - a.x, b.y - a.y);
            const auto between = [&](double t) {
                return Point{a.x + (b.x - a.x) * t / length, a.y + (b.y - a.y) * t / length};
            };
            for (double at = 0; at < length;) {
                const double end = std::min(at + left, length);
                if (part % 2 == 0) {
                    const double cap = std::min(line.width / 2, (end - at) / 2);
                    strokes.push_back(stroke_of(between(at + (at > 0 ? cap : 0)),
                                                between(end - (end < length ? cap : 0))));
                }
                left -= end - at;
                at = end;
                if (left < 1e-9) left = lengths[++part % lengths.size()];
            }
        }
        return strokes;
    }

    Canvas& canvas_;
    double scale_;
    const PlotColors& colors_;
    double patch_height_ = 0;
};

}  // namespace

void write_plot_picture(const CurvePlot& plot, const std::string& path, int width) {
    const double scale = width / kPlotWidth;
    const PlotColors& colors = colors_of(plot.theme);
    Canvas canvas(width, static_cast<int>(std::lround(height_of(plot) * scale)),
                  parse_color(colors.page));
    CanvasSurface surface(canvas, scale, colors);
    draw(plot, surface);
    OIIO::ImageBuf picture = canvas.to_image(OIIO::TypeDesc::UINT8);
    picture.specmod().attribute("oiio:ColorSpace", "sRGB");
    write_image_atomically(picture, path, OIIO::TypeDesc::UINT8);
}

TONEWRIGHT_NAMESPACE_END
