// SPDX-License-Identifier: Apache-2.0
#include "lut/fit_key.h"

#include <array>
#include <cmath>
#include <vector>

#include "base/number_cache.h"
#include "base/random.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::string key_of_pipeline(const Pipeline& pipeline) {
    constexpr std::size_t kColors = 8192;
    SampleRandom random(1);
    std::array<std::vector<double>, 3> planes;
    for (auto& plane : planes)
        plane.resize(kColors);
    for (std::size_t i = 0; i < kColors; ++i) {
        // Scene values of all magnitudes, and uniform numbers in [0, 1].
        for (auto& plane : planes)
            plane[i] = i % 4 == 0 ? random.uniform(0, 1) : std::exp2(random.uniform(-14, 14));
        if (i % 16 == 1) planes[random.bits() % 3][i] = 0;
    }
    const std::array<double*, 3> at = {planes[0].data(), planes[1].data(), planes[2].data()};
    ReferenceEngine(pipeline).run({at[0], at[1], at[2]}, at, kColors);
    std::vector<double> all = planes[0];
    all.insert(all.end(), planes[1].begin(), planes[1].end());
    all.insert(all.end(), planes[2].begin(), planes[2].end());
    return key_of_numbers(all);
}

std::string key_of_primaries(const Primaries& p) {
    return key_of_numbers({p.red.x, p.red.y, p.green.x, p.green.y, p.blue.x, p.blue.y,
                           p.whitepoint.x, p.whitepoint.y});
}

TONEWRIGHT_NAMESPACE_END
