// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "tonewright/pipeline.h"

/// Operators that look at a pixel's surroundings, on planes of floats. tonemap() of image.h runs
/// them on pictures of any kind; this header needs no other library.
TONEWRIGHT_NAMESPACE_BEGIN

/// Divides [0, count) into parts, calls body(begin, end) for each, from any threads, and returns
/// when all are done. The division changes no bit of the result.
using RowLoop = std::function<void(int count, const std::function<void(int begin, int end)>& body)>;

/// One part, in the calling thread.
TONEWRIGHT_API void run_rows_in_turn(int count,
                                     const std::function<void(int begin, int end)>& body);

/// A picture in memory, on which a local operator works in place.
struct ScenePlanes {
    int width = 0;   // at least 1
    int height = 0;  // at least 1
    /// Red, green and blue of Rec.709, row by row without gaps: scene-linear before exposure,
    /// within [0, 65504], or [0, 65504 / exposure] for exposures below 1. They become the
    /// operator's output: finite, not negative.
    std::array<std::vector<float>, 3> rgb;
    /// 0: the pixel is left out of statistics, because its alpha is 0. Empty, or all 0: all pixels
    /// count.
    std::vector<std::uint8_t> counts = {};
    /// Factor on light, > 0. Statistics describe the picture without it.
    float exposure = 1;
    RowLoop for_rows = run_rows_in_turn;
};

/// Runs a local operator.
/// @param op      as resolve_picture_operator() gives it
/// @throws Error  the operator is not local, or the planes do not have the picture's size
TONEWRIGHT_API void run_local_operator(const ResolvedOperator& op, ScenePlanes& picture);

TONEWRIGHT_NAMESPACE_END
