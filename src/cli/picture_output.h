// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tonewright/lut.h"

namespace tonewright {

/// Before anything is computed for a picture.
/// @throws Error  for a file type that does not hold the numbers as they are: lossy, or of other
///                depths.
void require_lut_picture(const std::string& path, int bits);

/// The set of `bake --all` into a folder: LUTs by application, thumbnails, README.md, MANIFEST.csv.
void write_shipped_luts(const std::string& folder);

/// A table as a picture file. @see make_lut_picture
/// @param bits  8, 16 or 32 (float)
void write_lut_picture(const Lut& lut, LutFormat format, const std::string& path, int bits);

/// A table from a picture file. @see read_lut_picture
[[nodiscard]] Lut load_lut_picture(const std::string& path);

}  // namespace tonewright
