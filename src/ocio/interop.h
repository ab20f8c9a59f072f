// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Ids of transforms in ACES Metadata Files, SMPTE ST 2067-50 and Academy S-2019-001: "from" one to
/// the other and back. Source of all: OpenColorIO 2.5.1's Studio config v4.0.0, and for ACES 1 its
/// Studio config v2.2.0.

/// Of a space of cameras or of ACES and ACES2065-1.
/// @param name  the space's, as the ACES configs have it; empty result for others.
[[nodiscard]] std::vector<std::string> amf_ids_of_space(std::string_view name);

/// Of the output transform that OpenColorIO's built-in style is, in a display's code values.
/// @param style    OCIO's, of a transform from ACES2065-1 to CIE XYZ D65; empty: of all of them
/// @param display  id
[[nodiscard]] std::vector<std::string> amf_ids_of_output(std::string_view style,
                                                         std::string_view display);

TONEWRIGHT_NAMESPACE_END
