// SPDX-License-Identifier: Apache-2.0
//
// Plots as PDF 1.4 files (Adobe, "PDF Reference", third edition), in vectors. The fonts are among
// the fourteen that every reader has, so none is embedded. The file has no date, so the bytes are
// the same on every run.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>

#include "cli/curve_plot.h"
#include "cli/plot_surface.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Advances of space to tilde in thousandths of the size: Adobe, Core 14 AFM files, Helvetica.
constexpr std::array<int, 95> kHelvetica = {
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333,  278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667,  611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278,  556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500,  500, 334, 260, 334, 584};

/// A character that is not ASCII, in a font of the file.
struct Special {
    std::string_view utf8;
    const char* font;
    unsigned char code;
    int advance;
};
constexpr std::array<Special, 3> kSpecials = {{{"\u2212", "F", 0x80, 584},    // minus
                                               {"\u00d7", "F", 0xD7, 584},    // multiply
                                               {"\u2192", "S", 0xAE, 987}}};  // arrowright

/// Words in one font.
struct Run {
    const char* font;
    std::string codes;
};

std::string escaped(char c) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '(' || c == ')' || c == '\\') return {'\\', c};
    return byte < 0x80 ? std::string(1, c) : fmt::format("\\{:03o}", byte);
}

/// @param advance  gets the width of the words, in thousandths of the size
std::vector<Run> runs_of(std::string_view words, int& advance) {
    std::vector<Run> runs;
    const auto add = [&](const char* font, char code, int width) {
        if (runs.empty() || std::string_view(runs.back().font) != font) runs.push_back({font, ""});
        runs.back().codes += escaped(code);
        advance += width;
    };
    while (!words.empty()) {
        const auto special =
            std::find_if(kSpecials.begin(), kSpecials.end(),
                         [&](const Special& s) { return words.starts_with(s.utf8); });
        if (special != kSpecials.end()) {
            add(special->font, static_cast<char>(special->code), special->advance);
            words.remove_prefix(special->utf8.size());
            continue;
        }
        const auto byte = static_cast<unsigned char>(words.front());
        const bool is_ascii = byte >= 32 && byte < 127;
        if (is_ascii || byte >= 0xC0) {  // for each other character one ?, not one for each byte
            const char c = is_ascii ? words.front() : '?';
            add("F", c, kHelvetica.at(static_cast<std::size_t>(c - 32)));
        }
        words.remove_prefix(1);
    }
    return runs;
}

/// A page's contents. Coordinates are those of the plot; the page turns them over.
class PdfSurface : public PlotSurface {
  public:
    explicit PdfSurface(const PlotColors& colors) : colors_(colors) {}

    void text(Point at, const TextStyle& style, std::string_view words) override {
        const double size = style.is_heading ? 14 : 11;
        int advance = 0;
        const std::vector<Run> runs = runs_of(words, advance);
        double left = at.x;
        if (style.anchor == Anchor::middle) left -= advance * size / 2000;
        if (style.anchor == Anchor::end) left -= advance * size / 1000;
        const auto show = [&](int mode) {
            add("BT {} Tr 1 0 0 -1 {:.2f} {:.2f} Tm\n", mode, left, at.y);
            for (const Run& run : runs) {
                const bool is_bold = style.is_heading && run.font[0] == 'F';
                add("/{} {} Tf ({}) Tj\n", is_bold ? "B" : run.font, size, run.codes);
            }
            add("ET\n");
        };
        if (style.has_halo) {
            add("{} RG 3 w 1 j\n", color_of(colors_.page));
            show(1);
        }
        add("{} rg\n", color_of(colors_.text));
        show(0);
    }
    void rules(Rule kind, std::span<const Segment> segments) override {
        add("{} RG 1 w {} 0 d\n", color_of(kind == Rule::grid ? colors_.grid : colors_.frame),
            kind == Rule::mark ? "[2 3]" : "[]");
        for (const auto& [from, to] : segments)
            add("{:.2f} {:.2f} m {:.2f} {:.2f} l\n", from.x, from.y, to.x, to.y);
        add("S [] 0 d\n");
    }
    void frame(Frame kind, Point top_left, double width, double height) override {
        add("{} RG 1 w {:.2f} {:.2f} {:.2f} {:.2f} re S\n",
            color_of(kind == Frame::graph ? colors_.frame : colors_.patch_frame), top_left.x,
            top_left.y, width, height);
    }
    void dot(Point center) override {
        // A line without length, with round ends.
        add("{} RG {} w 1 J {:.2f} {:.2f} m {:.2f} {:.2f} l S 0 J\n", color_of(colors_.dot),
            2 * kDotRadius, center.x, center.y, center.x, center.y);
    }
    void sample(const PlotLine& line, Point from, double length) override {
        const std::array<Point, 2> ends = {{from, {from.x + length, from.y}}};
        this->line(line, ends);
    }
    void begin_lines() override { add("1 j\n"); }
    void line(const PlotLine& line, std::span<const Point> points) override {
        add("{} RG {} w [{}] 0 d\n", color_of(line.color), line.width, line.dashes);
        for (const Point& p : points)
            add("{:.2f} {:.2f} {}\n", p.x, p.y, &p == points.data() ? 'm' : 'l');
        add("S [] 0 d\n");
    }
    void begin_patches(double height) override { patch_height_ = height; }
    void patches(Point left, double width, std::span<const Patch> row) override {
        for (const Patch& patch : row) {
            add("{} rg {:.2f} {:.2f} {:.2f} {:.2f} re f\n", color_of(patch.color),
                left.x + patch.left * width, left.y - patch_height_ / 2,
                (patch.right - patch.left) * width, patch_height_);
        }
    }
    void end_group() override {}
    [[nodiscard]] std::string take() { return std::move(contents_); }

    /// `#rgb` or `#rrggbb` as three numbers.
    [[nodiscard]] static std::string color_of(std::string_view text) {
        const std::size_t digits = text.size() == 4 ? 1 : 2;
        std::string numbers;
        for (std::size_t c = 0; c < 3; ++c) {
            unsigned code = 0;
            const char* from = text.data() + 1 + c * digits;
            std::from_chars(from, from + digits, code, 16);
            numbers +=
                fmt::format("{}{:.4g}", c > 0 ? " " : "", (digits == 1 ? 17 * code : code) / 255.0);
        }
        return numbers;
    }

  private:
    template <typename... Args>
    void add(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(contents_), format, std::forward<Args>(args)...);
    }

    const PlotColors& colors_;
    double patch_height_ = 0;
    std::string contents_;
};

}  // namespace

std::string to_pdf(const CurvePlot& plot, double width) {
    const PlotColors& colors = colors_of(plot.theme);
    PdfSurface surface(colors);
    draw(plot, surface);
    // A pixel of the web is 1/96 inch, a unit of a page 1/72.
    const double scale = width / kPlotWidth * 72 / 96;
    const double height = height_of(plot);
    const std::string contents = fmt::format(
        "{:.5g} 0 0 {:.5g} 0 {:.2f} cm\n{} rg 0 0 {} {:.2f} re f\n{}", scale, -scale,
        height * scale, PdfSurface::color_of(colors.page), kPlotWidth, height, surface.take());
    int ignored = 0;
    std::string title;
    for (const Run& run : runs_of(plot.title, ignored))
        title += run.codes;
    const auto font = [](const char* name, const char* encoding) {
        return fmt::format("<< /Type /Font /Subtype /Type1 /BaseFont /{}{} >>", name, encoding);
    };
    constexpr const char* kLatin =
        " /Encoding << /Type /Encoding /BaseEncoding /WinAnsiEncoding /Differences [128 /minus] >>";
    const std::array<std::string, 8> objects = {
        "<< /Type /Catalog /Pages 2 0 R >>",
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        fmt::format("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.2f} {:.2f}] /Contents 4 0 R "
                    "/Resources << /Font << /F 5 0 R /B 6 0 R /S 7 0 R >> >> >>",
                    kPlotWidth * scale, height * scale),
        fmt::format("<< /Length {} >>\nstream\n{}endstream", contents.size(), contents),
        font("Helvetica", kLatin),
        font("Helvetica-Bold", kLatin),
        font("Symbol", ""),
        fmt::format("<< /Title ({}) /Producer (Tonewright) >>", title)};
    std::string file = "%PDF-1.4\n";
    std::string table = fmt::format("xref\n0 {}\n0000000000 65535 f \n", objects.size() + 1);
    for (std::size_t i = 0; i < objects.size(); ++i) {
        table += fmt::format("{:010} 00000 n \n", file.size());
        file += fmt::format("{} 0 obj\n{}\nendobj\n", i + 1, objects[i]);
    }
    return file + table +
           fmt::format("trailer\n<< /Size {} /Root 1 0 R /Info {} 0 R >>\nstartxref\n{}\n%%EOF\n",
                       objects.size() + 1, objects.size(), file.size());
}

TONEWRIGHT_NAMESPACE_END
