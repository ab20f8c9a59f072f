// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "image/picture_file.h"
#include "picture/row_tonemapper.h"
#include "tonewright/sequence.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The number of threads: 0 is OIIO's `threads` attribute, whose 0 is all cores.
[[nodiscard]] TONEWRIGHT_API int thread_count(int nthreads);

/// The same options for rows.
[[nodiscard]] const RowTonemapper& rows_of(const Tonemapper& tonemapper);

/// The size, channels and metadata of a picture's result, untiled, without its pixels.
/// @throws Error  a picture that cannot be tone mapped
[[nodiscard]] TONEWRIGHT_API OIIO::ImageSpec result_spec(const Tonemapper& tonemapper,
                                                         const OIIO::ImageSpec& source);

/// tonemap_file(), with batches of about this size.
/// @throws Error  without the picture's name
TONEWRIGHT_API void tonemap_in_batches(const Tonemapper& tonemapper, const std::string& in,
                                       const std::string& out, const WriteOptions& write,
                                       const ReadOptions& read, int nthreads,
                                       std::size_t batch_bytes);

/// Checks that no output replaces an input, also through links. In place, a picture may replace
/// itself, but never another.
/// @throws Error
TONEWRIGHT_API void check_overwriting(const std::vector<FrameFiles>& files, bool is_in_place);

TONEWRIGHT_NAMESPACE_END
