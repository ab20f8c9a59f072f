// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plot/curve_plot.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The vertical axis of tone curves: code values, their light in percent of white or in cd/m2, or
/// its logarithm.
enum class PlotQuantity : unsigned char { code, light, log };

/// Tone curves of views that have the same display and exposure.
struct ToneCurves {
    struct Curve {
        std::string id;  // of its element; unique in the plot
        View view;
    };
    /// Not empty; at most kMostCurves.
    std::vector<Curve> curves;
    /// No tone mapping, for comparison; none on HDR displays.
    std::optional<View> clamp = {};
    PlotQuantity quantity = PlotQuantity::code;
    PlotTheme theme = PlotTheme::light;
    /// Empty: the operator's, or "Tone curves".
    std::string title = {};
};
/// Colors and dashes differ up to this number.
inline constexpr std::size_t kMostCurves = 24;

/// @throws Error  the display has no encoding: `linear` or `native`
[[nodiscard]] CurvePlot plot_of(const ToneCurves& request);

TONEWRIGHT_NAMESPACE_END
