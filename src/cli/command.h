// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

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

/// Each subcommand lives in its own file and puts itself under the program.
void add_list(CLI::App& program, int& exit_code);
void add_eval(CLI::App& program, int& exit_code);
void add_apply(CLI::App& program, int& exit_code);
void add_meter(CLI::App& program, int& exit_code);
void add_bake(CLI::App& program, int& exit_code);
void add_config(CLI::App& program, int& exit_code);
void add_verify(CLI::App& program, int& exit_code);
void add_chart(CLI::App& program, int& exit_code);
void add_sheet(CLI::App& program, int& exit_code);
void add_compare(CLI::App& program, int& exit_code);
void add_plot(CLI::App& program, int& exit_code);

TONEWRIGHT_NAMESPACE_END
