// SPDX-License-Identifier: Apache-2.0
#include "cli/picture_input.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>

#include "tonewright/image.h"

namespace tonewright {

QuietStderr::QuietStderr() : saved_(::dup(STDERR_FILENO)) {
    std::fflush(stderr);
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (saved_ >= 0 && nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
    if (nowhere >= 0) ::close(nowhere);
}

QuietStderr::~QuietStderr() {
    std::fflush(stderr);
    if (saved_ < 0) return;
    ::dup2(saved_, STDERR_FILENO);
    ::close(saved_);
}

OIIO::ImageBuf read_picture(const std::string& path) {
    const QuietStderr quiet;
    return read_image(path);
}

}  // namespace tonewright
