// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Largest measured errors of code values with implementations of shader languages, including
/// negatives: "2.0e-07 GLSL (llvmpipe), 1.1e-07 C (GCC, Clang)". Empty if not measured.
/// @param definition  hash of the view's definition on the display sRGB
[[nodiscard]] std::string measured_errors(std::string_view definition);

TONEWRIGHT_NAMESPACE_END
