// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "picture/row_files.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Opens an OpenEXR file: rows and tiles, one or several parts, the first level of each. Names,
/// order and types of channels, and all attributes are those of OpenImageIO 2.4. Where channels
/// differ in type, rows are float, and whole numbers are divided by 2^32 - 1.
/// @param threads  that decode blocks of rows; 0: as many as are idle
/// @returns  null if the file is not an OpenEXR file that this reader reads as OpenImageIO does:
///           deep, with subsampled channels, compressed by B44(A) or DWAA/DWAB, unfinished, or
///           damaged at its beginning
[[nodiscard]] std::unique_ptr<RowReader> open_exr(const std::string& path, unsigned threads);

/// The header of an OpenEXR file of luminance and chroma, with channels R, G and B instead.
/// @returns  nothing for other files
[[nodiscard]] std::optional<PictureSpec> luminance_chroma_spec(const std::string& path);

TONEWRIGHT_NAMESPACE_END
