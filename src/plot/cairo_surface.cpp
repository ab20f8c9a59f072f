// SPDX-License-Identifier: Apache-2.0
//
// Only the module of the picture commands links this file: cairo's 15 libraries would delay the
// start of every command.
#include "plot/cairo_surface.h"

#include <cairo-pdf.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <new>

#include "base/stroke_font.h"
#include "plot/surface.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

template <auto kDestroy>
struct Destroy {
    template <class T>
    void operator()(T* object) const {
        kDestroy(object);
    }
};
using Surface = std::unique_ptr<cairo_surface_t, Destroy<cairo_surface_destroy>>;
using Context = std::unique_ptr<cairo_t, Destroy<cairo_destroy>>;
using Font = std::unique_ptr<cairo_font_face_t, Destroy<cairo_font_face_destroy>>;

void require_success(cairo_status_t status) {
    if (status == CAIRO_STATUS_NO_MEMORY) throw std::bad_alloc();
    if (status != CAIRO_STATUS_SUCCESS) {
        throw Error(Problem{.kind = Problem::Kind::internal,
                            .what = std::string("cairo: ") + cairo_status_to_string(status)});
    }
}

/// Draws a line of ASCII text that begins at (0, 0), in the units of the glyphs.
void stroke_words(cairo_t* cairo, std::string_view ascii, double stroke_width) {
    double left = 0;
    for (const char c : ascii) {
        const Glyph& glyph = glyph_of(c);
        Stroke last = {};
        for (const Stroke& s : glyph.strokes) {
            const bool continues = &s != glyph.strokes.data() && s.x0 == last.x1 && s.y0 == last.y1;
            if (!continues)
                cairo_move_to(cairo, left + static_cast<double>(s.x0), static_cast<double>(s.y0));
            cairo_line_to(cairo, left + static_cast<double>(s.x1), static_cast<double>(s.y1));
            last = s;
        }
        left += static_cast<double>(glyph.advance);
    }
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_width(cairo, stroke_width);
    cairo_stroke(cairo);
}

/// Size of the font of PDF files, in the units of the glyphs.
constexpr double kFontSize = 10;

/// A glyph of that font; its code is the character.
template <bool kIsHeading>
cairo_status_t draw_glyph(cairo_scaled_font_t* /*font*/, unsigned long code, cairo_t* cairo,
                          cairo_text_extents_t* extents) {
    const char character = static_cast<char>(code);
    const Lettering letters = lettering_of(kIsHeading ? kHeading : kPlain, {});
    cairo_scale(cairo, 1 / kFontSize, -1 / kFontSize);
    stroke_words(cairo, {&character, 1}, letters.stroke_width / letters.unit);
    extents->x_advance = static_cast<double>(glyph_of(character).advance) / kFontSize;
    return CAIRO_STATUS_SUCCESS;
}

Font font_of(cairo_user_scaled_font_render_glyph_func_t draw) {
    Font font(cairo_user_font_face_create());
    cairo_user_font_face_set_render_glyph_func(font.get(), draw);
    return font;
}

class CairoSurface : public PlotSurface {
  public:
    /// @param scale  of the plot on the surface
    CairoSurface(cairo_surface_t* surface, double scale, PlotTheme theme)
        : cairo_(cairo_create(surface)),
          has_pixels_(cairo_surface_get_type(surface) == CAIRO_SURFACE_TYPE_IMAGE),
          pixel_(1 / scale),
          colors_(colors_of(theme)) {
        cairo_scale(cairo_.get(), scale, scale);
        set_color(colors_.page);
        cairo_paint(cairo_.get());
    }

    void text(Point at, const TextStyle& style, std::string_view words) override {
        const Lettering letters = lettering_of(style, words);
        const double left = at.x - anchor_offset(style, letters);
        const auto stroke = [&](std::string_view color, double width) {
            set_color(color);
            cairo_save(cairo_.get());
            cairo_translate(cairo_.get(), left, at.y);
            cairo_scale(cairo_.get(), letters.unit, -letters.unit);
            stroke_words(cairo_.get(), letters.ascii, width / letters.unit);
            cairo_restore(cairo_.get());
        };
        if (style.has_halo) stroke(colors_.page, letters.stroke_width + kHaloWidth);
        if (has_pixels_) {
            stroke(colors_.text, std::max(letters.stroke_width, pixel_));
            return;
        }
        // Readers search and copy the words of a font.
        set_color(colors_.text);
        cairo_set_font_face(cairo_.get(), (style.is_heading ? heading_ : plain_).get());
        cairo_set_font_size(cairo_.get(), kFontSize * letters.unit);
        cairo_move_to(cairo_.get(), left, at.y);
        cairo_show_text(cairo_.get(), letters.ascii.c_str());
        cairo_new_path(cairo_.get());  // it begins behind the words otherwise
    }
    void rules(Rule kind, std::span<const Segment> segments) override {
        set_color(kind == Rule::grid ? colors_.grid : colors_.frame);
        for (const auto& [from, to] : segments) {
            cairo_move_to(cairo_.get(), from.x, from.y);
            cairo_line_to(cairo_.get(), to.x, to.y);
        }
        if (kind == Rule::mark) set_dashes({2, 3});
        stroke_whole_pixels();
        set_dashes({});
    }
    void frame(Frame kind, Point top_left, double width, double height) override {
        set_color(kind == Frame::graph ? colors_.frame : colors_.patch_frame);
        cairo_rectangle(cairo_.get(), top_left.x, top_left.y, width, height);
        stroke_whole_pixels();
    }
    void dot(Point center) override {
        set_color(colors_.dot);
        cairo_arc(cairo_.get(), center.x, center.y, kDotRadius, 0, 7);  // more than a turn
        cairo_fill(cairo_.get());
    }
    void sample(const PlotLine& line, Point from, double length) override {
        const std::array<Point, 2> ends = {{from, {from.x + length, from.y}}};
        this->line(line, ends);
    }
    void begin_lines() override { cairo_set_line_join(cairo_.get(), CAIRO_LINE_JOIN_ROUND); }
    void line(const PlotLine& line, std::span<const Point> points) override {
        set_color(line.color);
        for (const Point& p : points)
            cairo_line_to(cairo_.get(), p.x, p.y);
        set_dashes(line.dashes);
        cairo_set_line_width(cairo_.get(), line.width);
        cairo_stroke(cairo_.get());
        set_dashes({});
    }
    void begin_patches(double height) override {
        patch_height_ = height;
        cairo_set_antialias(cairo_.get(), CAIRO_ANTIALIAS_NONE);
    }
    void patches(Point left, double width, std::span<const Patch> row) override {
        for (const Patch& patch : row) {
            set_color(patch.color);
            cairo_rectangle(cairo_.get(), left.x + patch.left * width, left.y - patch_height_ / 2,
                            (patch.right - patch.left) * width, patch_height_);
            cairo_fill(cairo_.get());
        }
    }
    void end_group() override {
        cairo_set_antialias(cairo_.get(), CAIRO_ANTIALIAS_DEFAULT);
        cairo_set_line_join(cairo_.get(), CAIRO_LINE_JOIN_MITER);
    }

    /// The first error of all calls.
    [[nodiscard]] cairo_status_t status() const { return cairo_status(cairo_.get()); }

  private:
    /// @param text  `#rgb` or `#rrggbb`
    void set_color(std::string_view text) {
        const std::size_t digits = text.size() == 4 ? 1 : 2;
        std::array<double, 3> color{};
        for (std::size_t c = 0; c < 3; ++c) {
            unsigned code = 0;
            const char* from = text.data() + 1 + c * digits;
            std::from_chars(from, from + digits, code, 16);
            color[c] = (digits == 1 ? 17 * code : code) / 255.0;
        }
        cairo_set_source_rgb(cairo_.get(), color[0], color[1], color[2]);
    }
    void set_dashes(const std::vector<double>& lengths) {
        cairo_set_dash(cairo_.get(), lengths.data(), static_cast<int>(lengths.size()), 0);
    }
    /// Draws the path one unit wide; as sharp lines, where the surface has pixels.
    void stroke_whole_pixels() {
        cairo_set_line_width(cairo_.get(),
                             has_pixels_ ? pixel_ * std::max(1.0, std::round(1 / pixel_)) : 1);
        cairo_set_antialias(cairo_.get(), CAIRO_ANTIALIAS_NONE);
        cairo_stroke(cairo_.get());
        cairo_set_antialias(cairo_.get(), CAIRO_ANTIALIAS_DEFAULT);
    }

    Context cairo_;
    bool has_pixels_;
    double pixel_;  // its size
    const PlotColors& colors_;
    Font plain_ = font_of(draw_glyph<false>);
    Font heading_ = font_of(draw_glyph<true>);
    double patch_height_ = 0;
};

void draw(const CurvePlot& plot, cairo_surface_t* surface, double scale) {
    require_success(cairo_surface_status(surface));
    CairoSurface target(surface, scale, plot.theme);
    draw(plot, target);
    require_success(target.status());
}

std::string draw_pdf(const CurvePlot& plot, double width) {
    std::string file;
    const auto append = [](void* to, const unsigned char* data, unsigned size) {
        try {
            static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), size);
        } catch (const std::bad_alloc&) {
            return CAIRO_STATUS_NO_MEMORY;
        }
        return CAIRO_STATUS_SUCCESS;
    };
    // A pixel of the web is 1/96 inch, a unit of a page 1/72.
    const double scale = width / kPlotWidth * 72 / 96;
    const Surface surface(cairo_pdf_surface_create_for_stream(append, &file, kPlotWidth * scale,
                                                              height_of(plot) * scale));
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, plot.title.c_str());
    // No date.
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, nullptr);
    draw(plot, surface.get(), scale);
    cairo_surface_finish(surface.get());
    require_success(cairo_surface_status(surface.get()));
    return file;
}

}  // namespace

std::string to_pdf(const CurvePlot& plot, double width) {
    std::string file = draw_pdf(plot, width);
    // If memory runs out while cairo writes the fonts, the file is damaged, and cairo reports
    // success. A second file has other bytes then.
    if (draw_pdf(plot, width) != file) throw std::bad_alloc();
    return file;
}

PlotPixels to_pixels(const CurvePlot& plot, int width) {
    constexpr double kHighest = 32767;  // of cairo
    const double scale = width / kPlotWidth;
    const double height = std::round(height_of(plot) * scale);
    if (height > kHighest) {
        throw Error(Problem{.parameter = "width",
                            .value = fmt::to_string(width),
                            .expected = fmt::format("at most {:.0f} for this plot",
                                                    std::floor(width * kHighest / height))});
    }
    PlotPixels pixels = {width, static_cast<int>(height), {}};
    const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, pixels.height));
    draw(plot, surface.get(), scale);
    cairo_surface_flush(surface.get());
    require_success(cairo_surface_status(surface.get()));
    const unsigned char* row = cairo_image_surface_get_data(surface.get());
    const int stride = cairo_image_surface_get_stride(surface.get());
    pixels.rgb.reserve(3 * static_cast<std::size_t>(width) *
                       static_cast<std::size_t>(pixels.height));
    for (int y = 0; y < pixels.height; ++y, row += stride) {
        const auto* pixel = reinterpret_cast<const std::uint32_t*>(row);
        for (int x = 0; x < width; ++x) {
            for (const unsigned shift : {16U, 8U, 0U})
                pixels.rgb.push_back(static_cast<std::uint8_t>(pixel[x] >> shift));
        }
    }
    return pixels;
}

TONEWRIGHT_NAMESPACE_END
