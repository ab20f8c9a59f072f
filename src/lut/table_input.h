// SPDX-License-Identifier: Apache-2.0
//
// What goes into a table when a picture goes through it, and what it should show.
#pragma once

#include <span>
#include <vector>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Table input of scene-linear light, interleaved RGB, as a reader of the file has it: encoded, and
/// behind a shaper as readers resample it. Of a half-domain table: the light itself.
[[nodiscard]] std::vector<double> table_input(const Lut& lut, const LutRequest& request,
                                              std::span<const float> light);

/// Scene-linear light of encoded colors, interleaved RGB, as floats.
[[nodiscard]] std::vector<float> light_of(const InputEncoding& encoding,
                                          std::span<const double> code);

TONEWRIGHT_NAMESPACE_END
