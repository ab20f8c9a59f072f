// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

using Rgb = std::array<float, 3>;

inline Rgb gray_of(double value) {
    const auto v = static_cast<float>(value);
    return {v, v, v};
}

/// A float RGB picture in memory, for drawing. Coordinates are pixels; (0, 0) is the top left
/// corner of the first pixel, whose center is (0.5, 0.5). Drawing outside has no effect.
class TONEWRIGHT_API Canvas {
  public:
    Canvas(int width, int height, const Rgb& fill);

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    [[nodiscard]] Rgb& at(int x, int y) {
        return pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                       static_cast<std::size_t>(x)];
    }

    /// Colors the pixels [x0, x1) x [y0, y1) with `color_at(u, v)`, where (u, v) in (0, 1) is the
    /// place of the pixel's center in the rectangle, v downwards.
    template <class ColorAt>
    void paint(int x0, int y0, int x1, int y1, ColorAt&& color_at) {
        for (int y = y0 < 0 ? 0 : y0; y < y1 && y < height_; ++y) {
            const double v = (y + 0.5 - y0) / (y1 - y0);
            for (int x = x0 < 0 ? 0 : x0; x < x1 && x < width_; ++x) {
                at(x, y) = color_at((x + 0.5 - x0) / (x1 - x0), v);
            }
        }
    }
    void fill(int x0, int y0, int x1, int y1, const Rgb& color) {
        paint(x0, y0, x1, y1, [&](double, double) { return color; });
    }

    enum class Align : unsigned char { left, center, right };
    /// Draws one line of text (printable ASCII; `?` for each other character), antialiased. `align`
    /// gives the meaning of `x`, `baseline` is the line below the letters, `cap_height` the height
    /// of capitals.
    void text(std::string_view text, double x, double baseline, double cap_height, const Rgb& color,
              Align align = Align::left);

    /// The picture in the given pixel type, R, G, B.
    [[nodiscard]] OIIO::ImageBuf to_image(const OIIO::TypeDesc& type) const;

  private:
    int width_;
    int height_;
    std::vector<Rgb> pixels_;
};

/// Width of a line of text in pixels.
[[nodiscard]] TONEWRIGHT_API double text_width(std::string_view text, double cap_height);
/// The text, or its longest beginning that fits into `width` with "..." after it.
[[nodiscard]] TONEWRIGHT_API std::string fit_text(std::string_view text, double cap_height,
                                                  double width);

TONEWRIGHT_NAMESPACE_END
