// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>

#include "tonewright/image.h"

namespace tonewright {

Settings ViewOptions::settings() const {
    Settings result;
    for (const std::string& text : set) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0) {
            throw Error("--set: setting is " + text + "; expected name=value");
        }
        result[text.substr(0, equals)] = text.substr(equals + 1);
    }
    return result;
}

View ViewOptions::view() const {
    return make_view(resolve_operator(op, settings(), look), input, exposure, display,
                     reference_white);
}

namespace {

/// Standard error leads nowhere while it lives. For a program with one thread of its own.
class QuietStderr {
  public:
    QuietStderr() : saved_(::dup(STDERR_FILENO)) {
        std::fflush(stderr);
        const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
        if (saved_ >= 0 && nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
        if (nowhere >= 0) ::close(nowhere);
    }
    ~QuietStderr() {
        std::fflush(stderr);
        if (saved_ < 0) return;
        ::dup2(saved_, STDERR_FILENO);
        ::close(saved_);
    }
    QuietStderr(const QuietStderr&) = delete;
    QuietStderr& operator=(const QuietStderr&) = delete;

  private:
    int saved_;
};

}  // namespace

OIIO::ImageBuf read_picture(const std::string& path) {
    const QuietStderr quiet;
    return read_image(path);
}

void add_view_options(CLI::App& command, ViewOptions& options) {
    command.add_option("--set", options.set, "operator parameter, name=value; repeat for more")
        ->allow_extra_args(false);
    command.add_option("--look", options.look, "look of the operator");
    command.add_option("--exposure", options.exposure, "stops, before the operator")
        ->capture_default_str();
    command.add_option("--input", options.input, "scene-linear space of the input")
        ->capture_default_str();
    command
        .add_option("--display", options.display,
                    "display, or `linear` (display-linear Rec.709, unclamped), or `native` (the "
                    "operator's own output)")
        ->capture_default_str();
    command
        .add_option("--reference-white", options.reference_white,
                    "what an HDR display shows light 1 at, cd/m2; 203 as BT.2408 has it")
        ->capture_default_str();
}

}  // namespace tonewright
