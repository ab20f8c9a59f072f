// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

enum class Ktx2Texel : unsigned char { half, single };

/// A file of KTX 2.0 (Khronos): a volume of RGBA floats, one level, without supercompression. A
/// depth of 1 gives a 2D texture.
/// @param rgba   x running fastest
/// @param notes  text of the key `Tonewright`, lines of it; may be empty
[[nodiscard]] std::string ktx2_file(const std::vector<float>& rgba, const std::array<int, 3>& size,
                                    Ktx2Texel texel, const std::string& notes);

TONEWRIGHT_NAMESPACE_END
