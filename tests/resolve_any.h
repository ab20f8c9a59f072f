// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// resolve_operator() that also finds known defects, which no name finds elsewhere.
inline ResolvedOperator resolve_any(std::string_view text, const Settings& settings = {},
                                    std::string_view look = {}) {
    for (const Operator& defect : known_defects()) {
        if (defect.id == text) return resolve(defect, nullptr, settings, look);
    }
    return resolve_operator(text, settings, look);
}

TONEWRIGHT_NAMESPACE_END
