// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "tonewright/color.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A typical color of pictures, linear Rec.709: brightness log-uniform over 15 stops, channels
/// about half a stop apart.
[[nodiscard]] inline Vector3 draw_picture_color(SampleRandom& random) {
    const double stops = std::log2(0.18) + random.uniform(-9, 6.2);
    Vector3 color{};
    for (double& channel : color) {
        // Box-Muller: a normal distribution with sigma 0.6 stops.
        const double radius = std::sqrt(-2 * std::log(1 - random.uniform(0, 1)));
        const double angle = 2 * std::numbers::pi * random.uniform(0, 1);
        channel = std::exp2(stops + 0.6 * radius * std::cos(angle));
    }
    return color;
}

TONEWRIGHT_NAMESPACE_END
