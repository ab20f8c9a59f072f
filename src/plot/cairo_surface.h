// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plot/curve_plot.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The plot as a PDF file of one page, in vectors, with words that readers can search. The same
/// bytes on every run.
/// @param width  of the page, in pixels of 1/96 inch
[[nodiscard]] std::string to_pdf(const CurvePlot& plot, double width);

/// 8-bit R, G, B, from the top left.
struct PlotPixels {
    int width, height;
    std::vector<std::uint8_t> rgb;
};
/// @throws Error  the picture is higher than cairo can draw
[[nodiscard]] PlotPixels to_pixels(const CurvePlot& plot, int width);

TONEWRIGHT_NAMESPACE_END
