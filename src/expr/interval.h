// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Between which values a result lies, ends included.
struct Interval {
    double lo = -std::numeric_limits<double>::infinity();
    double hi = std::numeric_limits<double>::infinity();
};

/// Where the result of an operation lies when its operands lie in a, b and c; both infinities where
/// that is not known. Not of constants, inputs and uniforms.
/// @param table    of a lookup
/// @param lattice  of a lattice
/// @throws Error   as Lattice::nodes()
[[nodiscard]] TONEWRIGHT_API Interval interval_of(ExprOp op, const Interval& a, const Interval& b,
                                                  const Interval& c, const Table* table,
                                                  const Lattice* lattice);

TONEWRIGHT_NAMESPACE_END
