// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tonewright/lut.h"

namespace tonewright {

/// Raw floats: RGB triplets, little-endian, red fastest, of a cube of 2 to 129 points a side.
/// @param path  for errors
/// @throws FileError  another number of bytes; NaN and infinities.
[[nodiscard]] Lut parse_raw_lut(const std::string& path, std::string_view bytes);

}  // namespace tonewright
