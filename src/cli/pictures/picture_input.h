// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <string>

#include "cli/picture_options.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Standard error leads nowhere while it lives: libraries below OpenImageIO (libpng, libtiff) print
/// their complaints themselves, and the error that comes back says the same in our one line. For a
/// program with one of these at a time.
class QuietStderr {
  public:
    QuietStderr();
    ~QuietStderr();
    QuietStderr(const QuietStderr&) = delete;
    QuietStderr& operator=(const QuietStderr&) = delete;

    /// The file descriptor of what standard error was; -1: none.
    [[nodiscard]] int before() const { return saved_; }

  private:
    int saved_;
};

[[nodiscard]] TonemapOptions::Unpremult alpha_of(const PictureInput& input);

/// Tells OpenImageIO and OpenEXR how many threads.
void use_threads(const PictureInput& input);

/// read_image() with the terminal kept clean.
[[nodiscard]] OIIO::ImageBuf read_picture(const std::string& path);

TONEWRIGHT_NAMESPACE_END
