// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tonewright/local.h"
#include "tonewright/registry.h"
#include "unit/noise.h"

TONEWRIGHT_NAMESPACE_BEGIN

inline ScenePlanes make_light(int width, int height, float peak = 20) {
    ScenePlanes picture;
    picture.width = width;
    picture.height = height;
    const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    std::uint32_t seed = 0;
    for (std::vector<float>& plane : picture.rgb) {
        for (std::size_t i = 0; i < count; ++i) {
            const float n = noise(seed++);
            plane.push_back(i % 7 == 0 ? 0 : peak * n * n * n * n);
        }
    }
    return picture;
}

inline std::array<std::vector<float>, 3> run(const Operator& op, ScenePlanes picture,
                                             const Settings& settings = {}) {
    run_local_operator(resolve_picture_operator(op.id, settings), picture);
    return picture.rgb;
}

TONEWRIGHT_NAMESPACE_END
