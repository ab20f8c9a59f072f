// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A DDS volume as a 3D LUT of 2 to 129 nodes a side, red along its width: R9G9B9E5, or RGBA of
/// half or single floats, with the header of Direct3D 10 or a format's code.
/// @param path  for errors
/// @throws FileError  for anything else; truncated; NaN and infinities.
[[nodiscard]] TONEWRIGHT_API Lut parse_dds(const std::string& path, std::string_view bytes);

TONEWRIGHT_NAMESPACE_END
