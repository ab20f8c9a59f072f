// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// One line: a 3D LUT rings, or is a code off on more than a twentieth of photographs; and the
/// remedy. Empty if neither, or for photographs if nothing helps.
/// @param is_for_application  the input is that of an application
[[nodiscard]] TONEWRIGHT_API std::string lut_warning(const std::string& file,
                                                     const LutRequest& request,
                                                     const BakedLut& baked,
                                                     bool is_for_application);

TONEWRIGHT_NAMESPACE_END
