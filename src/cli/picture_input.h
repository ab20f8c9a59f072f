// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <string>

namespace tonewright {

/// Standard error leads nowhere while it lives. For a program with one thread of its own.
class QuietStderr {
  public:
    QuietStderr();
    ~QuietStderr();
    QuietStderr(const QuietStderr&) = delete;
    QuietStderr& operator=(const QuietStderr&) = delete;

  private:
    int saved_;
};

/// read_image() with the terminal kept clean: libraries below OpenImageIO (libpng, libtiff) print
/// their complaints themselves, and the error that comes back says the same in our one line.
[[nodiscard]] OIIO::ImageBuf read_picture(const std::string& path);

}  // namespace tonewright
