// SPDX-License-Identifier: Apache-2.0
#include "image/canvas.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "base/stroke_font.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Bytes 10xxxxxx continue a UTF-8 character whose first byte was drawn.
bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

double squared_distance(double px, double py, const Stroke& s) {
    const double dx = static_cast<double>(s.x1) - static_cast<double>(s.x0);
    const double dy = static_cast<double>(s.y1) - static_cast<double>(s.y0);
    const double qx = px - static_cast<double>(s.x0);
    const double qy = py - static_cast<double>(s.y0);
    const double length = dx * dx + dy * dy;
    const double t = length > 0 ? std::clamp((qx * dx + qy * dy) / length, 0.0, 1.0) : 0.0;
    return (qx - t * dx) * (qx - t * dx) + (qy - t * dy) * (qy - t * dy);
}

}  // namespace

Canvas::Canvas(int width, int height, const Rgb& fill)
    : width_(width),
      height_(height),
      pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {}

void Canvas::text(std::string_view text, double x, double baseline, double cap_height,
                  const Rgb& color, Align align, double extra_width) {
    const double unit = cap_height / kCapHeight;  // pixels
    if (align == Align::center) x -= text_width(text, cap_height) / 2;
    if (align == Align::right) x -= text_width(text, cap_height);
    // Thinner strokes than a pixel would disappear.
    const double half_width = (std::max(kStrokeWidth * unit, 1.0) + extra_width) / 2;
    const double around = 1 + extra_width / 2;
    for (const char c : text) {
        if (continues_character(c)) continue;
        const Glyph& glyph = glyph_of(c);
        const auto advance = static_cast<double>(glyph.advance);
        const int x0 = std::max(0, static_cast<int>(std::floor(x - 2 * unit - around)));
        const int x1 = std::min(width_, static_cast<int>(std::ceil(x + advance * unit + around)));
        const int y0 = std::max(0, static_cast<int>(std::floor(baseline - 8.5 * unit - around)));
        const int y1 = std::min(height_, static_cast<int>(std::ceil(baseline + 3 * unit + around)));
        for (int py = y0; py < y1; ++py) {
            for (int px = x0; px < x1; ++px) {
                const double gx = (px + 0.5 - x) / unit;
                const double gy = (baseline - py - 0.5) / unit;
                double nearest = 1e9;
                for (const Stroke& s : glyph.strokes) {
                    nearest = std::min(nearest, squared_distance(gx, gy, s));
                }
                const double distance = std::sqrt(nearest) * unit;
                const auto cover =
                    static_cast<float>(std::clamp(half_width - distance + 0.5, 0.0, 1.0));
                if (cover <= 0) continue;
                Rgb& pixel = at(px, py);
                for (std::size_t i = 0; i < 3; ++i)
                    pixel[i] += cover * (color[i] - pixel[i]);
            }
        }
        x += advance * unit;
    }
}

void Canvas::strokes(std::span<const Stroke> lines, double width, const Rgb& color) {
    // For each pixel, the nearest line counts.
    struct Box {
        int x0, y0, x1, y1;
    };
    const double reach = width / 2 + 0.5;
    const auto box_of = [&](const Stroke& s) {
        const auto [x0, x1] = std::minmax({static_cast<double>(s.x0), static_cast<double>(s.x1)});
        const auto [y0, y1] = std::minmax({static_cast<double>(s.y0), static_cast<double>(s.y1)});
        return Box{std::max(0, static_cast<int>(std::floor(x0 - reach))),
                   std::max(0, static_cast<int>(std::floor(y0 - reach))),
                   std::min(width_, static_cast<int>(std::ceil(x1 + reach))),
                   std::min(height_, static_cast<int>(std::ceil(y1 + reach)))};
    };
    Box all = {width_, height_, 0, 0};
    for (const Stroke& s : lines) {
        const Box box = box_of(s);
        all = {std::min(all.x0, box.x0), std::min(all.y0, box.y0), std::max(all.x1, box.x1),
               std::max(all.y1, box.y1)};
    }
    if (all.x0 >= all.x1 || all.y0 >= all.y1) return;
    const auto columns = static_cast<std::size_t>(all.x1 - all.x0);
    std::vector<float> covers(columns * static_cast<std::size_t>(all.y1 - all.y0));
    const auto cover_at = [&](int x, int y) -> float& {
        return covers[static_cast<std::size_t>(y - all.y0) * columns +
                      static_cast<std::size_t>(x - all.x0)];
    };
    for (const Stroke& s : lines) {
        const Box box = box_of(s);
        for (int y = box.y0; y < box.y1; ++y) {
            for (int x = box.x0; x < box.x1; ++x) {
                const double distance = std::sqrt(squared_distance(x + 0.5, y + 0.5, s));
                float& cover = cover_at(x, y);
                cover = std::max(cover, static_cast<float>(std::clamp(reach - distance, 0.0, 1.0)));
            }
        }
    }
    for (int y = all.y0; y < all.y1; ++y) {
        for (int x = all.x0; x < all.x1; ++x) {
            const float cover = cover_at(x, y);
            Rgb& pixel = at(x, y);
            for (std::size_t i = 0; i < 3; ++i)
                pixel[i] += cover * (color[i] - pixel[i]);
        }
    }
}

OIIO::ImageBuf Canvas::to_image(const OIIO::TypeDesc& type) const {
    OIIO::ImageBuf image(OIIO::ImageSpec(width_, height_, 3, type), OIIO::InitializePixels::No);
    image.set_pixels(image.roi(), OIIO::TypeFloat, pixels_.data());
    return image;
}

double text_width(std::string_view text, double cap_height) {
    double width = 0;
    for (const char c : text) {
        if (!continues_character(c)) width += static_cast<double>(glyph_of(c).advance);
    }
    return text.empty() ? 0 : (width - kLetterSpacing) * cap_height / kCapHeight;
}

std::string fit_text(std::string_view text, double cap_height, double width) {
    std::string fitted(text);
    for (std::size_t length = text.size(); text_width(fitted, cap_height) > width && length > 0;) {
        // Not within a character of several bytes.
        do
            --length;
        while (length > 0 && continues_character(text[length]));
        fitted = std::string(text.substr(0, length)) + "...";
    }
    return fitted;
}

TONEWRIGHT_NAMESPACE_END
