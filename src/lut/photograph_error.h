// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Error on the colors of photograph_light() in the view's input primaries.
/// @param shown           output of the LUT, interleaved RGB
/// @param wanted          output of the reference
/// @param encoding        of the input; colors that it does not hold are left out. Null: holds all
[[nodiscard]] TONEWRIGHT_API PhotographError photograph_error(const View& view,
                                                              std::vector<double> shown,
                                                              std::vector<double> wanted,
                                                              const InputEncoding* encoding);

TONEWRIGHT_NAMESPACE_END
