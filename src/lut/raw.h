// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Raw floats: RGB triplets, little-endian, red fastest, of a 3D LUT with 2 to 129 nodes a side.
/// @param path  for errors
/// @throws FileError  another number of bytes; NaN and infinities.
[[nodiscard]] TONEWRIGHT_API Lut parse_raw_lut(const std::string& path, std::string_view bytes);

TONEWRIGHT_NAMESPACE_END
