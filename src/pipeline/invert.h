// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Samples of a function of one number, in order.
using Curve = std::function<std::vector<double>(const std::vector<double>& x)>;

/// Fall of a curve that should rise: from its highest value so far to the lowest one after it.
struct Fall {
    double x_from, y_from, x_to, y_to;
};

/// First fall by more than `noise` between the given positions, which ascend. Also finds its ends
/// between the positions.
[[nodiscard]] TONEWRIGHT_API std::optional<Fall> find_fall(const Curve& f,
                                                           const std::vector<double>& x,
                                                           double noise);

/// "from 0.731 at x = 4.02 to 0.728 at x = 4.31"
[[nodiscard]] TONEWRIGHT_API std::string to_string(const Fall& fall);

/// Stages that invert `pipeline` for inputs in +-kHalfMax. Inverts matrices. Uses the stated
/// inverse of a curve, or otherwise a numeric one: a table for the start, then Newton's method. If
/// several inputs have one output, the inverse is the smallest input.
/// @throws Error  "stage 3 is a cross-talk, which mixes channels", or if a curve is not monotone
[[nodiscard]] TONEWRIGHT_API Pipeline invert_stages(const Pipeline& pipeline);

TONEWRIGHT_NAMESPACE_END
