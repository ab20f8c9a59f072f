// SPDX-License-Identifier: Apache-2.0
#include "image/canvas.h"

#include <algorithm>
#include <cmath>
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
                  const Rgb& color, Align align) {
    const double unit = cap_height / kCapHeight;  // pixels
    if (align == Align::center) x -= text_width(text, cap_height) / 2;
    if (align == Align::right) x -= text_width(text, cap_height);
    // Thinner strokes than a pixel would disappear.
    const double half_width = std::max(kStrokeWidth * unit, 1.0) / 2;
    for (const char c : text) {
        if (continues_character(c)) continue;
        const Glyph& glyph = glyph_of(c);
        const auto advance = static_cast<double>(glyph.advance);
        const int x0 = std::max(0, static_cast<int>(std::floor(x - 2 * unit - 1)));
        const int x1 = std::min(width_, static_cast<int>(std::ceil(x + advance * unit + 1)));
        const int y0 = std::max(0, static_cast<int>(std::floor(baseline - 8.5 * unit - 1)));
        const int y1 = std::min(height_, static_cast<int>(std::ceil(baseline + 3 * unit + 1)));
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
