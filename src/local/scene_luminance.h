// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "tonewright/local.h"

/// Measurements of local operators, bit-identical for any number of threads.
TONEWRIGHT_NAMESPACE_BEGIN

/// Relative luminance (0.2126, 0.7152, 0.0722) of every pixel, times `factor`.
[[nodiscard]] std::vector<float> luminance_of(const ScenePlanes& picture, float factor = 1);

/// exp(mean ln(delta + L)) of the measured pixels.
[[nodiscard]] double log_average(const ScenePlanes& picture, const std::vector<float>& luminance,
                                 double delta);

/// Width of a picture, or start of a row, as std::size_t, to avoid sign conversions.
[[nodiscard]] inline std::size_t index_of(const ScenePlanes& picture, int y, int x = 0) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
           static_cast<std::size_t>(x);
}

TONEWRIGHT_NAMESPACE_END
