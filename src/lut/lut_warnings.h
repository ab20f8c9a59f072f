// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Why a 3D LUT does not follow its operator in saturated lights, and what helps, in one line.
/// Empty: it follows.
[[nodiscard]] TONEWRIGHT_API std::string ringing_warning(const std::string& file,
                                                         const LutRequest& request,
                                                         const BakedLut& baked);

TONEWRIGHT_NAMESPACE_END
