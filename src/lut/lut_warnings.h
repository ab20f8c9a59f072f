// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// One line: why a 3D LUT does not follow its operator in saturated highlights, and the remedy.
/// Empty if it follows.
[[nodiscard]] TONEWRIGHT_API std::string ringing_warning(const std::string& file,
                                                         const LutRequest& request,
                                                         const BakedLut& baked);

TONEWRIGHT_NAMESPACE_END
