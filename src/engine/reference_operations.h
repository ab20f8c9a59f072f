// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "engine/tape.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Runs one operation of the reference over n values: all but inputs, constants and grids.
/// @param out  may be one of the operands
using RunInstruction = void (*)(const TapeInstruction& step, double* out, const double* a,
                                const double* b, const double* c, std::size_t n);

/// The operations for this processor. Their bits are the same for all processors.
[[nodiscard]] RunInstruction reference_operations();

TONEWRIGHT_NAMESPACE_END
