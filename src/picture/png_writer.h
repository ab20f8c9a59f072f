// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "picture/picture_spec.h"
#include "picture/row_files.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Begins a PNG file. Its chunks are those that OpenImageIO 2.4 writes for the attributes; the
/// pixels are compressed in blocks, in parallel. The bytes depend neither on the number of threads
/// nor on the division into write_rows().
///
/// `compression` and `png:compressionLevel` select zlib's strategy and level. Without them, each
/// block gets the strategy that suits it.
/// @param file     stays open; it belongs to the caller
/// @param threads  as for in_parallel()
/// @param chunks   whole chunks, which follow IHDR
/// @returns  null for a picture that this writer does not write as OpenImageIO does: more than 4
///           channels, a volume, associated alpha, dither, a selected filter, attributes that
///           OpenImageIO converts or libpng refuses
/// @throws FileError  the first bytes cannot be written
[[nodiscard]] std::unique_ptr<RowWriter> create_png(int file, const PictureSpec& spec,
                                                    unsigned threads, std::string_view chunks = {});

/// Opens a complete file by libpng.
/// @param spec  of the writer
/// @returns  the difference from what was to be written; empty if there is none
[[nodiscard]] std::string fault_of_png(const std::string& path, const PictureSpec& spec);

TONEWRIGHT_NAMESPACE_END
