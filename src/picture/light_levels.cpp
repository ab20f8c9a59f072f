// SPDX-License-Identifier: Apache-2.0
#include "picture/light_levels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN

void LightLevelMeter::add(const float* pixels, std::size_t count, std::size_t channels,
                          const OIIO::TypeDesc& type, int alpha) {
    const bool is_gray = channels < 3;
    const float most = type == OIIO::TypeDesc::UINT8 ? 255 : 65535;
    std::vector<float> rgb(3 * count);
    for (std::size_t i = 0; i < count; ++i) {
        const float* pixel = pixels + i * channels;
        const bool is_hidden = alpha >= 0 && pixel[alpha] <= 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const float code = is_hidden ? 0 : pixel[is_gray ? 0 : c];
            rgb[3 * i + c] = std::round(std::clamp(code, 0.0F, 1.0F) * most) / most;
        }
    }
    to_light_.run_rgb(rgb.data(), rgb.data(), count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto light =
            static_cast<double>(std::max({rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]}));
        largest_ = std::max(largest_, light);
        sum_ += light;
    }
    count_ += static_cast<double>(count);
}

TONEWRIGHT_NAMESPACE_END
