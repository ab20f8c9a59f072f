// SPDX-License-Identifier: Apache-2.0
#include "local/scene_luminance.h"

#include <algorithm>
#include <cmath>

TONEWRIGHT_NAMESPACE_BEGIN

std::vector<float> luminance_of(const ScenePlanes& picture, float factor) {
    std::vector<float> luminance(picture.rgb[0].size());
    const auto width = static_cast<std::size_t>(picture.width);
    const float r_weight = factor * static_cast<float>(kRec709Weights[0]);
    const float g_weight = factor * static_cast<float>(kRec709Weights[1]);
    const float b_weight = factor * static_cast<float>(kRec709Weights[2]);
    picture.for_rows(picture.height, [&](int begin, int end) {
        const std::size_t first = index_of(picture, begin);
        const std::size_t count = static_cast<std::size_t>(end - begin) * width;
        const float* r = &picture.rgb[0][first];
        const float* g = &picture.rgb[1][first];
        const float* b = &picture.rgb[2][first];
        float* to = &luminance[first];
        for (std::size_t i = 0; i < count; ++i)
            to[i] = r_weight * r[i] + g_weight * g[i] + b_weight * b[i];
    });
    return luminance;
}

double log_average(const ScenePlanes& picture, const std::vector<float>& luminance, double delta) {
    struct Row {
        double sum = 0;
        std::size_t count = 0;
    };
    const auto height = static_cast<std::size_t>(picture.height);
    const auto width = static_cast<std::size_t>(picture.width);
    const bool all_count = std::none_of(picture.counts.begin(), picture.counts.end(),
                                        [](std::uint8_t counts) { return counts != 0; });
    std::vector<Row> rows(height);
    picture.for_rows(picture.height, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            Row& row = rows[static_cast<std::size_t>(y)];
            const std::size_t first = index_of(picture, y);
            for (std::size_t i = first; i < first + width; ++i) {
                if (!all_count && picture.counts[i] == 0) continue;
                row.sum += std::log(delta + static_cast<double>(luminance[i]));
                ++row.count;
            }
        }
    });
    Row all;
    for (const Row& row : rows) {
        all.sum += row.sum;
        all.count += row.count;
    }
    return std::exp(all.sum / static_cast<double>(all.count));
}

TONEWRIGHT_NAMESPACE_END
