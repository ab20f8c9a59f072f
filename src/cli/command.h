// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "tonewright/view.h"

namespace tonewright {

/// Exit codes of the command.
enum ExitCode { kOk = 0, kCheckFailed = 1, kUsage = 2, kFile = 3 };

/// Options that most subcommands share: which operator, with what, in which view.
struct ViewOptions {
    std::string op;
    std::vector<std::string> set;
    std::string look;
    double exposure = 0;
    std::string input = "lin_rec709";
    std::string display = "srgb";
    double reference_white = kReferenceWhite;

    /// `name=value` texts as settings. @throws Error for one without `=`.
    [[nodiscard]] Settings settings() const;
    /// @throws Error
    [[nodiscard]] View view() const;
};

/// --set, --look, --exposure, --input, --display, --reference-white.
void add_view_options(CLI::App& command, ViewOptions& options);

/// read_image() with the terminal kept clean: libraries below OpenImageIO (libpng, libtiff) print
/// their complaints themselves, and the error that comes back says the same in our one line.
[[nodiscard]] OIIO::ImageBuf read_picture(const std::string& path);

/// Each subcommand lives in its own file and puts itself under the program.
void add_list(CLI::App& program, int& exit_code);
void add_eval(CLI::App& program, int& exit_code);
void add_apply(CLI::App& program, int& exit_code);
void add_bake(CLI::App& program, int& exit_code);
void add_config(CLI::App& program, int& exit_code);
void add_verify(CLI::App& program, int& exit_code);
void add_chart(CLI::App& program, int& exit_code);
void add_sheet(CLI::App& program, int& exit_code);

}  // namespace tonewright
