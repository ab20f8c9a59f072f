// SPDX-License-Identifier: Apache-2.0
#include "cli/picture_input.h"
#include "tonewright/image_io.h"
#include "tonewright/tonemap.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>

TONEWRIGHT_NAMESPACE_BEGIN

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

TonemapOptions::Unpremult PictureInput::alpha() const {
    if (unpremult) return TonemapOptions::Unpremult::yes;
    if (no_unpremult) return TonemapOptions::Unpremult::no;
    return TonemapOptions::Unpremult::automatic;
}

void PictureInput::use_threads() const {
    OIIO::attribute("threads", threads);
    // OpenEXR has threads of its own; there, 0 is all cores and less is none.
    OIIO::attribute("exr_threads", threads == 1 ? -1 : threads);
}

void add_picture_input(CLI::App& command, PictureInput& options) {
    command
        .add_option("--threads", options.threads,
                    "threads that read, compute and write; 0 = all cores, 1 = one after the other")
        ->capture_default_str()
        ->check(CLI::Range(0, 1024));
    command
        .add_option("--subimage", options.subimage,
                    "which part of a multi-part file (view, page), from 0")
        ->capture_default_str()
        ->check(CLI::Range(0, 1 << 20));
    CLI::Option* yes = command.add_flag(
        "--unpremult", options.unpremult,
        "divide color by alpha first (`apply` multiplies after); default: as the picture says");
    command.add_flag("--no-unpremult", options.no_unpremult, "take color as it is")->excludes(yes);
}

OIIO::ImageBuf read_picture(const std::string& path) {
    const QuietStderr quiet;
    return read_image(path);
}

TONEWRIGHT_NAMESPACE_END
