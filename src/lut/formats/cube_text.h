// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A .cube: a 1D LUT, a 3D LUT or both, and the range of each.
struct CubeText {
    struct Table {
        int size = 0;  // 0: there is none
        std::array<double, 3> lo = {0, 0, 0};
        std::array<double, 3> hi = {1, 1, 1};
        std::vector<float> rows;  // RGB triplets; of a 3D LUT red fastest
    };
    Table table;
    Table cube;
    /// One line about a keyword that is unknown and ignored; empty if there is none.
    std::string note;
};

TONEWRIGHT_NAMESPACE_END
