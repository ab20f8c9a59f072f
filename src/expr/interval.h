// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Closed interval of a result.
struct Interval {
    double lo = -std::numeric_limits<double>::infinity();
    double hi = std::numeric_limits<double>::infinity();
};

/// Interval of the result of an operation for operands in a, b and c; infinite if unknown. Not for
/// constants, inputs and uniforms.
/// @param table    for a lookup
/// @param grid  for a Grid
/// @throws Error   as Grid::nodes()
[[nodiscard]] TONEWRIGHT_API Interval interval_of(ExprOp op, const Interval& a, const Interval& b,
                                                  const Interval& c, const Table* table,
                                                  const Grid* grid);

TONEWRIGHT_NAMESPACE_END
