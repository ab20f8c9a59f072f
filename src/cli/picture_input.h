// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <string>

namespace tonewright {

/// read_image() with the terminal kept clean: libraries below OpenImageIO (libpng, libtiff) print
/// their complaints themselves, and the error that comes back says the same in our one line.
[[nodiscard]] OIIO::ImageBuf read_picture(const std::string& path);

}  // namespace tonewright
