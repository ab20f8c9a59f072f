// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A source color whose decoded light is limited like the input of every engine.
[[nodiscard]] SourceColor encoded_color(std::string name, Pipeline decode,
                                        const Primaries& primaries);

/// CIE XYZ whose gray is D65, without adaptation. Its X, Y and Z are no Primaries, because equal
/// amounts of them are no gray.
/// @param decode  stored numbers -> XYZ
[[nodiscard]] SourceColor xyz_color(std::string name, Pipeline decode);

/// The code values of a display.
[[nodiscard]] SourceColor color_of_display(const Display& display);

/// HLG code values -> light of a display of 1000 cd/m2 (ITU-R BT.2100-2, table 5), where 1.0 is
/// kUnitLuminance cd/m2.
/// @param luminance  weights of the channels
[[nodiscard]] Pipeline hlg_display_decode(const Vector3& luminance);

TONEWRIGHT_NAMESPACE_END
