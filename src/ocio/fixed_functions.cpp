// SPDX-License-Identifier: Apache-2.0
#include "ocio/fixed_functions.h"

#include <algorithm>

#include "operators/color_modifiers.h"

TONEWRIGHT_NAMESPACE_BEGIN

const std::vector<FixedFunctions>& all_fixed_functions() {
    static const std::vector<FixedFunctions> all = [] {
        using Compression = ReferenceGamutCompression;
        std::vector<double> compression(Compression::limit.begin(), Compression::limit.end());
        compression.insert(compression.end(), Compression::threshold.begin(),
                           Compression::threshold.end());
        compression.push_back(Compression::power);
        const std::vector<FixedFunctionOp> glow_and_red = {{"ACES_Glow10"}, {"ACES_RedMod10"}};
        return std::vector<FixedFunctions>{
            {reference_gamut_compression(), {{"ACES_GamutComp13", compression}}},
            {rrt_glow_and_red_modifier(RrtSaturation::after_glow), glow_and_red},
            // The saturation of the dark: where all channels are below 0.01.
            {rrt_glow_and_red_modifier(RrtSaturation::before_glow), glow_and_red, false},
        };
    }();
    return all;
}

const FixedFunctions* find_fixed_functions(const CrossTalkStage& stage) {
    const auto& all = all_fixed_functions();
    const auto found = std::find_if(all.begin(), all.end(), [&](const FixedFunctions& row) {
        return std::equal(row.stage.f.begin(), row.stage.f.end(), stage.f.begin(), same);
    });
    return found == all.end() ? nullptr : &*found;
}

TONEWRIGHT_NAMESPACE_END
