// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tonewright/lut.h"

namespace tonewright {

/// The OpenColorIO config of the whole registry, profile 2.1: `config.ocio`, `luts/*.clf` named by
/// their contents, `probe.csv` (expected code values for check_config.py), README.md, MANIFEST.csv.
///
/// Scene reference ACES2065-1, display reference CIE XYZ D65. Every operator is a view transform
/// and a view of every display; descriptions carry the measured error.
/// @throws Error  when a name would break a host (over 63 bytes, twice the same).
[[nodiscard]] std::vector<GeneratedFile> make_config();

/// Name of the config's space for an input space id: "lin_rec709" -> "Linear Rec.709 (sRGB)".
[[nodiscard]] std::string config_space_name(std::string_view input_id);

}  // namespace tonewright
