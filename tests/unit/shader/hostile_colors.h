// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "base/random.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Numbers that break shaders: 0, denormals, the largest half float, far beyond it, infinity; all
/// signs, all combinations.
inline std::vector<float> hostile_colors(std::size_t random_count) {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    const std::vector<float> values = {0.0F,    -0.0F,   1e-45F, 1e-38F, 1e-30F, 1e-10F,
                                       0.18F,   1.0F,    16.3F,  65504,  1e30F,  kInf,
                                       -1e-45F, -1e-10F, -0.2F,  -65504, -1e30F, -kInf};
    std::vector<float> rgb;
    for (const float r : values) {
        for (const float g : values) {
            for (const float b : values)
                rgb.insert(rgb.end(), {r, g, b});
        }
    }
    SampleRandom random(19);
    for (std::size_t i = 0; i < 3 * random_count; ++i) {
        const auto x = static_cast<float>(std::exp2(random.uniform(-149, 127)));
        rgb.push_back(random.uniform(0, 1) < 0.3 ? -x : x);
    }
    return rgb;
}

TONEWRIGHT_NAMESPACE_END
