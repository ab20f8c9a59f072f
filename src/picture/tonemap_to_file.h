// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "picture/file_writer.h"
#include "picture/picture_spec.h"
#include "picture/row_files.h"
#include "picture/row_pass.h"
#include "picture/row_tonemapper.h"
#include "tonewright/picture_options.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A picture that is read a few rows at a time, and its result.
struct PictureToFile {
    const PictureSpec& source;
    RowPass::Rows read;
    int row_step = 1;         // rows are read in multiples of it
    const std::string& path;  // of the source
    bool writes_provenance = false;
    const std::string& resize;  // of ReadOptions, for the provenance
    int nthreads = 1;
    std::size_t batch_bytes = kBatchBytes;
};
/// Tone maps all rows, and completes the file.
/// @throws Error  the first error of a step
TONEWRIGHT_API void tonemap_to_file(const RowTonemapper& tonemapper, const PictureToFile& picture,
                                    FileWriter& file);

/// tonemap_file() for files that need no OpenImageIO: OpenEXR to OpenEXR, PNG or JPEG, row by row.
/// @param rows      of open_exr() for `in`; null: not such a file
/// @param header    receives the header of the picture, before anything is converted
/// @param nthreads  1 or more
/// @returns  false for a picture, a format or a conversion that needs OpenImageIO. Nothing was
///           written, but `read` and `write` may have got messages.
/// @throws Error  also what only OpenImageIO can do
[[nodiscard]] TONEWRIGHT_API bool tonemap_own_file(
    const RowTonemapper& tonemapper, std::unique_ptr<RowReader> rows, const std::string& in,
    const std::string& out, const WriteOptions& write, const ReadOptions& read,
    const std::function<void(const PictureSpec&)>& header, int nthreads);

TONEWRIGHT_NAMESPACE_END
