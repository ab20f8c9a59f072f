// SPDX-License-Identifier: Apache-2.0
#include "plot/cairo_surface.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "plot/surface.h"
#include "tonewright/error.h"

namespace tonewright {
namespace {

/// A horizontal line at half the height.
CurvePlot flat_plot(PlotTheme theme = PlotTheme::light) {
    CurvePlot plot;
    plot.theme = theme;
    plot.title = "Flat \u00d7";
    plot.lines = {{"flat", "flat", "#d55e00", 4, {}, {}}};
    plot.lines[0].values.assign(plot_stops().size(), 0.5);
    return plot;
}

using Color = std::array<int, 3>;

Color color_at(const PlotPixels& pixels, double x, double y) {
    const auto column = static_cast<std::size_t>(x * pixels.width / kPlotWidth);
    const auto row = static_cast<std::size_t>(y * pixels.width / kPlotWidth);
    const std::size_t at = 3 * (row * static_cast<std::size_t>(pixels.width) + column);
    return {pixels.rgb[at], pixels.rgb[at + 1], pixels.rgb[at + 2]};
}

TEST(CairoSurface, PdfIsTheSameOnEveryRunAndHasNoDate) {
    const std::string pdf = to_pdf(flat_plot(), 640);
    EXPECT_TRUE(pdf.starts_with("%PDF-1."));
    EXPECT_EQ(pdf, to_pdf(flat_plot(), 640));
    EXPECT_EQ(pdf.find("Date"), std::string::npos);
}

TEST(CairoSurface, PixelsHaveTheColorsOfThePlot) {
    for (const int width : {320, 640, 1000, 1280}) {
        const PlotPixels pixels = to_pixels(flat_plot(), width);
        EXPECT_EQ(pixels.width, width);
        EXPECT_NEAR(pixels.height, height_of(flat_plot()) * width / kPlotWidth, 0.5);
        ASSERT_EQ(pixels.rgb.size(), 3U * static_cast<unsigned>(pixels.width * pixels.height));
        EXPECT_EQ(color_at(pixels, 1, 1), (Color{255, 255, 255}));
        // Between the vertical lines of the grid; code value 0.5 is in the middle of a graph that
        // goes from 42 to 262.
        EXPECT_EQ(color_at(pixels, 400, 152), (Color{0xd5, 0x5e, 0x00})) << width;
    }
    const PlotPixels dark = to_pixels(flat_plot(PlotTheme::dark), 640);
    EXPECT_EQ(color_at(dark, 1, 1), (Color{0x1b, 0x1d, 0x20}));
}

TEST(CairoSurface, RulesAreWholePixels) {
    const Color frame = {0x8c, 0x95, 0x9f};
    for (const int width : {500, 640, 900, 1280, 1700}) {
        const PlotPixels pixels = to_pixels(flat_plot(), width);
        const std::size_t row = static_cast<std::size_t>(pixels.height) / 4;
        int count = 0;
        for (int x = 0; x < width / 8; ++x) {  // the frame's left side is at 50 of 640
            const std::size_t at =
                3 * (row * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
            count += Color{pixels.rgb[at], pixels.rgb[at + 1], pixels.rgb[at + 2]} == frame ? 1 : 0;
        }
        EXPECT_EQ(count, std::lround(width / kPlotWidth)) << width;
    }
}

TEST(CairoSurface, RefusesAPictureThatIsTooHigh) {
    CurvePlot plot;
    for (int i = 0; i < 80; ++i) {
        plot.lines.push_back(flat_plot().lines[0]);
        plot.lines.back().id += std::to_string(i);
    }
    try {
        (void)to_pixels(plot, 16384);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.problem().parameter, "width");
        EXPECT_TRUE(e.problem().expected.starts_with("at most ")) << e.what();
    }
}

}  // namespace
}  // namespace tonewright
