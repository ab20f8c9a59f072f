// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

inline std::vector<Pipeline> all_views(const OperatorVariant& variant) {
    std::vector<Pipeline> views;
    for (const char* input : {"lin_rec709", "lin_ap1"}) {
        for (const char* display : {"native", "linear", "srgb", "rec2020"}) {
            views.push_back(build_view(
                make_view(resolve_operator(variant.name, {}, variant.look), input, 0.3, display)));
        }
    }
    return views;
}

TONEWRIGHT_NAMESPACE_END
