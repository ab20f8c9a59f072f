// SPDX-License-Identifier: Apache-2.0
#include "definition/primaries_names.h"

TONEWRIGHT_NAMESPACE_BEGIN

const std::vector<std::pair<std::string_view, Primaries>>& named_primaries() {
    static const std::vector<std::pair<std::string_view, Primaries>> all = {
        {"rec709", kRec709},
        {"rec2020", kRec2020},
        {"p3d65", kP3D65},
        {"ap0", kAP0},
        {"ap1", kAP1},
        {"egamut", kEGamut},
        {"awg3", kArriWideGamut3},
        {"awg4", kArriWideGamut4},
        {"sgamut3", kSGamut3},
        {"sgamut3cine", kSGamut3Cine},
        {"davinci_wg", kDaVinciWideGamut},
    };
    return all;
}

TONEWRIGHT_NAMESPACE_END
