// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/curve_plot.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Before anything is computed for a picture.
/// @throws Error  for a file type that does not hold the numbers as they are: lossy, or of other
///                depths.
void require_lut_picture(const std::string& path, int bits);

/// The set of `bake --all` into a folder: LUTs by application, thumbnails, README.md, MANIFEST.csv.
void write_shipped_luts(const std::string& folder);

/// A table as a picture file. @see make_lut_picture
/// @param bits  8, 16 or 32 (float)
void write_lut_picture(const Lut& lut, LutFormat format, const std::string& path, int bits);

/// A plot as a picture file.
/// @param width  pixels
void write_plot_picture(const CurvePlot& plot, const std::string& path, int width);

/// A table from a picture file. @see read_lut_picture
[[nodiscard]] Lut load_lut_picture(const std::string& path);

TONEWRIGHT_NAMESPACE_END
