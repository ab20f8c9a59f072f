// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lut/shipped_set.h"
#include "tonewright/generated_files.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Fills in the `contents` of LUTs that are pictures, and the thumbnails.
/// @throws Error  OpenImageIO cannot write PNG
[[nodiscard]] TONEWRIGHT_API std::vector<GeneratedFile> make_shipped_files(
    std::vector<ShippedLut>& luts);

TONEWRIGHT_NAMESPACE_END
