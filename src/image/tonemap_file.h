// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "tonewright/image.h"

namespace tonewright {

/// tonemap_file(), with batches of about this size.
/// @throws Error  without the picture's name
void tonemap_in_batches(const Tonemapper& tonemapper, const std::string& in, const std::string& out,
                        const OIIO::TypeDesc& type, int nthreads, std::size_t batch_bytes);

}  // namespace tonewright
