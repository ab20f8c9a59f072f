// SPDX-License-Identifier: Apache-2.0
#include "lut/shaper.h"

#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::vector<float> shaper_table(const InputEncoding& encoding) {
    std::vector<double> light(kShaperSteps);
    const double lo = encoding.scene_lo;
    const double span = encoding.scene_hi - lo;
    for (std::size_t i = 0; i < light.size(); ++i)
        light[i] = lo + span * static_cast<double>(i) / (kShaperSteps - 1.0);
    // Not evaluate(), because 65,536 walks through the tree take a second.
    std::vector<double> code(light.size());
    ReferenceEngine({curve_stage(encoding.encode)})
        .run({light.data(), light.data(), light.data()}, {code.data(), code.data(), code.data()},
             light.size());
    return {code.begin(), code.end()};
}

TONEWRIGHT_NAMESPACE_END
