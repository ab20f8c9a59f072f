// SPDX-License-Identifier: Apache-2.0
//
// Input of a table for a picture, and the wanted result.
#pragma once

#include <span>
#include <vector>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Table input for scene-linear colors, interleaved RGB, as readers of the file compute it:
/// encoded, after a shaper as readers resample it. For a half-domain table: the colors themselves.
[[nodiscard]] std::vector<double> table_input(const Lut& lut, const LutRequest& request,
                                              std::span<const float> light);

/// Scene-linear values of encoded colors, interleaved RGB, as floats.
[[nodiscard]] std::vector<float> light_of(const InputEncoding& encoding,
                                          std::span<const double> code);

TONEWRIGHT_NAMESPACE_END
