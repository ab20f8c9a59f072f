// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "tonewright/local.h"

/// What local operators measure of a picture, the same to the last bit for any threads.
TONEWRIGHT_NAMESPACE_BEGIN

/// Relative luminance (0.2126, 0.7152, 0.0722) of every pixel, times `factor`.
[[nodiscard]] std::vector<float> luminance_of(const ScenePlanes& picture, float factor = 1);

/// exp(mean ln(delta + L)) of the pixels that count.
[[nodiscard]] double log_average(const ScenePlanes& picture, const std::vector<float>& luminance,
                                 double delta);

/// The width of a picture, or where a row begins, without conversions of signs all over.
[[nodiscard]] inline std::size_t index_of(const ScenePlanes& picture, int y, int x = 0) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
           static_cast<std::size_t>(x);
}

TONEWRIGHT_NAMESPACE_END
