// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Ids of transforms in ACES Metadata Files, SMPTE ST 2067-50 and Academy S-2019-001: in both
/// directions. Source of all: OpenColorIO 2.5.1's Studio config v4.0.0, and for ACES 1 its Studio
/// config v2.2.0.

/// Ids between ACES2065-1 and a camera or ACES space.
/// @param name  name of the space in the ACES configs; the result is empty for others.
[[nodiscard]] std::vector<std::string> amf_ids_of_space(std::string_view name);

/// Id of the output transform of an OpenColorIO built-in style, in code values of a display.
/// @param style    OCIO style from ACES2065-1 to CIE XYZ D65; empty: the ids of all styles
/// @param display  id
[[nodiscard]] std::vector<std::string> amf_ids_of_output(std::string_view style,
                                                         std::string_view display);

TONEWRIGHT_NAMESPACE_END
