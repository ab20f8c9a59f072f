// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "picture/row_files.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Writes an OpenEXR file of one part in rows, with the attributes that OpenImageIO 2.4 writes for
/// the same spec. Rows of float become half floats where the file has those.
/// @param file     a descriptor, open for writing and empty; the caller closes it
/// @param threads  that encode blocks of rows; 0: as many as are idle
/// @returns  null for a spec that this writer leaves to OpenImageIO: tiles, deep pixels, channels
///           of different types, B44(A), DWAA and DWAB, rows from the last to the first
/// @throws FileError  as RowWriter::write_rows()
[[nodiscard]] std::unique_ptr<RowWriter> create_exr(int file, const PictureSpec& spec,
                                                    unsigned threads);

TONEWRIGHT_NAMESPACE_END
