// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

inline constexpr std::size_t kAgxNumbers = std::size_t{3} * 57 * 57 * 57;
/// The doubles that agx_cube::cube_nodes() gives for agx_cube::rec709_node(), as bytes, which the
/// build computes.
extern const char kAgxNodes[sizeof(double) * kAgxNumbers + 1];

TONEWRIGHT_NAMESPACE_END
