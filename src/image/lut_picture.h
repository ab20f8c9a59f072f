// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <string>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A 3D LUT as a picture of its nodes. `hald`: n = level^2 points a side in a square of level^3
/// pixels a side, red fastest, then green, then blue, line by line. `strip`: n pictures of n x n
/// side by side, blue from one to the next, red to the right, green downwards.
/// @throws Error  another format
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf make_lut_picture(const Lut& lut, LutFormat format);

/// Writes such a picture. An old file is replaced when the new one is complete.
/// @param bits  8, 16 or 32 (float)
/// @throws FileError  the file cannot be written
TONEWRIGHT_API void write_lut_picture(const Lut& lut, LutFormat format, const std::string& path,
                                      int bits);

/// The 3D LUT of such a picture: its size distinguishes the two layouts.
/// @throws FileError  missing, truncated, of another size (before its pixels are read), with alpha
///                    below 1, NaN or infinities
[[nodiscard]] TONEWRIGHT_API Lut read_lut_picture(const std::string& path);
/// The same of a picture in memory. @param path  of its file, for messages
[[nodiscard]] TONEWRIGHT_API Lut lut_of_picture(const OIIO::ImageBuf& picture,
                                                const std::string& path);

/// Reads LUTs that are pictures for load_operator(). Other files go to `next`. @see table_reader()
[[nodiscard]] TONEWRIGHT_API TableReader picture_table_reader(TableReader next = {});

TONEWRIGHT_NAMESPACE_END
