// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "plot/curve_plot.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

inline constexpr double kMidGray = 0.18;

/// Red, green and blue.
using Planes = std::array<std::vector<double>, 3>;

/// The pipeline's result for `color` times each number of `exposures`, in double.
[[nodiscard]] Planes codes_of(const Pipeline& pipeline, const Vector3& color,
                              std::span<const double> exposures);

/// Code value of each scene-linear gray on the view's display. If the result is tinted, that of the
/// gray with the same luminance.
[[nodiscard]] std::vector<double> gray_codes(const View& view, std::span<const double> scene);
[[nodiscard]] double gray_code(const View& view, double scene);

/// Scene-linear values of stops from mid gray.
[[nodiscard]] std::vector<double> scene_of(const std::vector<double>& stops);

[[nodiscard]] double largest_difference(const std::vector<double>& a, const std::vector<double>& b);

/// Largest difference of lines that look the same, in code values.
inline constexpr double kSameLine = 0.001;

/// Adds a line, or adds a name to the label of a line that looks the same.
void add_line(std::vector<PlotLine>& lines, PlotLine line, const std::string& short_name);

TONEWRIGHT_NAMESPACE_END
