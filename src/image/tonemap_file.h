// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "image/picture_file.h"
#include "tonewright/image.h"

namespace tonewright {

/// The spec of rows [ybegin, yend) of a picture, untiled.
[[nodiscard]] OIIO::ImageSpec spec_of_rows(const OIIO::ImageSpec& picture, int ybegin, int yend);

/// What the result of a picture will be, untiled, without its pixels.
/// @throws Error  a picture that cannot be tone mapped
[[nodiscard]] OIIO::ImageSpec result_spec(const Tonemapper& tonemapper,
                                          const OIIO::ImageSpec& source);

/// measure_scene() of a file, in batches of about this size.
/// @throws FileError, Error
[[nodiscard]] SceneStatistics measure_file(const std::string& path, int subimage,
                                           const TonemapOptions& options, int nthreads,
                                           std::size_t batch_bytes = kBatchBytes);

/// tonemap_file(), with batches of about this size.
/// @throws Error  without the picture's name
void tonemap_in_batches(const Tonemapper& tonemapper, const std::string& in, const std::string& out,
                        const OIIO::TypeDesc& type, int nthreads, std::size_t batch_bytes,
                        int subimage = 0);

}  // namespace tonewright
