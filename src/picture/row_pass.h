// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/typedesc.h>

#include <cstddef>
#include <functional>

#include "picture/picture_spec.h"
#include "picture/row_tonemapper.h"

/// Tone mapping from file to file, in batches of rows. One thread reads the next batch, one tone
/// maps, and one writes the previous batch. The number of batches is small, so memory does not grow
/// with the picture.
TONEWRIGHT_NAMESPACE_BEGIN

/// Bytes that are read, processed and written at a time.
inline constexpr std::size_t kBatchBytes = std::size_t{16} << 20;

/// Rows of a batch: at least 64 (formats compress up to 32 rows together, and each thread of
/// OpenEXR takes one such block), a multiple of `step`, and at most the rows of the picture.
/// @param step    rows are read in multiples of it; at most `height`
/// @param height  rows of the picture
[[nodiscard]] TONEWRIGHT_API int rows_of_batch(std::size_t bytes_per_row, int step, int height,
                                               std::size_t batch_bytes = kBatchBytes);

/// One picture between two files.
struct RowPass {
    /// Reads or writes rows [ybegin, yend), interleaved and packed.
    using Rows = std::function<void(int ybegin, int yend, std::byte* pixels)>;

    PictureSpec source;
    PictureSpec result;  // in the type of `write`
    Rows read;
    Rows write;
    bool is_bottom_up = false;  // the last batch is written first
    int step = 1;               // rows of a batch
    int nthreads = 1;           // 1: one step after the other in the calling thread

    /// @throws Error  the first error of a step
    void run(const RowTonemapper& tonemapper) const;
};

TONEWRIGHT_NAMESPACE_END
