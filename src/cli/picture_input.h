// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <CLI/CLI.hpp>
#include <string>

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

/// Which part of a picture is read, what its alpha means, by how many threads: of `apply` and
/// `meter`.
struct PictureInput {
    int subimage = 0;
    int threads = 0;
    bool unpremult = false;
    bool no_unpremult = false;

    [[nodiscard]] TonemapOptions::Unpremult alpha() const;
    /// Tells OpenImageIO and OpenEXR how many threads.
    void use_threads() const;
};

/// --subimage, --threads, --unpremult, --no-unpremult.
void add_picture_input(CLI::App& command, PictureInput& options);

/// read_image() with the terminal kept clean.
[[nodiscard]] OIIO::ImageBuf read_picture(const std::string& path);

TONEWRIGHT_NAMESPACE_END
