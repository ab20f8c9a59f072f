// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tonewright/lut.h"

namespace tonewright {

/// The files of the LUTs, those that are pictures and the thumbnails included: what a picture
/// format's `contents` lack is filled in.
/// @throws Error  when OpenImageIO cannot write PNG.
[[nodiscard]] std::vector<GeneratedFile> make_shipped_files(std::vector<ShippedLut>& luts);

}  // namespace tonewright
