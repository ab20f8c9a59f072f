// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "picture/picture_spec.h"
#include "picture/row_files.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Begins a JPEG file of 8 bits with the bytes that OpenImageIO 2.4 writes. `compression` and
/// `CompressionQuality` give the quality (98 without them), `jpeg:subsampling` the resolution of
/// chroma. A profile that needs several segments is whole, unlike OpenImageIO's.
/// @param file     stays open; it belongs to the caller
/// @param threads  that convert rows, as for in_parallel()
/// @returns  null for a picture that this writer does not write so: other channels than gray or
///           RGB, dither, attributes that jpeg_metadata() does not know
/// @throws FileError  the first bytes cannot be written, or libjpeg refuses the picture
[[nodiscard]] std::unique_ptr<RowWriter> create_jpeg(int file, const PictureSpec& spec,
                                                     unsigned threads);

/// Opens a complete file by libjpeg.
/// @param spec  of the writer
/// @returns  the difference from what was to be written; empty if there is none
[[nodiscard]] std::string fault_of_jpeg(const std::string& path, const PictureSpec& spec);

TONEWRIGHT_NAMESPACE_END
