// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Values of a function of one number, in order.
using Curve = std::function<std::vector<double>(const std::vector<double>& x)>;

/// Where a curve that should rise falls: from its highest value so far to its lowest behind it.
struct Fall {
    double x_from, y_from, x_to, y_to;
};

/// The first fall by more than `noise` between the given places, which ascend. Its two ends are
/// found between them, too.
[[nodiscard]] TONEWRIGHT_API std::optional<Fall> find_fall(const Curve& f,
                                                           const std::vector<double>& x,
                                                           double noise);

/// "from 0.731 at x = 4.02 to 0.728 at x = 4.31"
[[nodiscard]] TONEWRIGHT_API std::string to_string(const Fall& fall);

/// The stages that lead back from what `pipeline` puts out, with inputs limited to +-kHalfMax.
/// Matrices are inverted. A curve has the inverse that its source states, or else a numeric one: a
/// table gives the neighborhood, and Newton's method the rest. Where many inputs have one output,
/// the inverse gives the smallest of them.
/// @throws Error  "stage 3 is a cross-talk, which mixes channels", or where a curve is not monotone
[[nodiscard]] TONEWRIGHT_API Pipeline invert_stages(const Pipeline& pipeline);

TONEWRIGHT_NAMESPACE_END
