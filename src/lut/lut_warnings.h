// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tonewright/lut_applications.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// One line: a 3D LUT rings, or is a code off on more than a twentieth of photographs; and what
/// helps. Or a .cube has a 1D table whose domain ffmpeg does not read. Empty if neither, or if
/// nothing helps. @see render
/// @param host  the application whose input the LUT takes; null: none
[[nodiscard]] TONEWRIGHT_API std::string lut_warning(const std::string& file,
                                                     const LutRequest& request,
                                                     const BakedLut& baked,
                                                     const LutApplication* host);

TONEWRIGHT_NAMESPACE_END
