// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "tonewright/lut.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

class CommandLine;
/// The command with all subcommands.
[[nodiscard]] std::unique_ptr<CommandLine> make_command_line();

/// Exit codes of the command.
enum ExitCode { kOk = 0, kCheckFailed = 1, kUsage = 2, kFile = 3 };
struct ExitMeaning {
    ExitCode code;
    const char* text;
};
/// For the help and the manual.
inline constexpr ExitMeaning kExitMeanings[] = {
    {kOk, "ok"},
    {kCheckFailed, "a check or a frame failed"},
    {kUsage, "wrong usage"},
    {kFile, "a file could not be read or written"},
};

/// Options that most subcommands share: operator, parameters, view.
struct ViewOptions {
    std::string op;
    std::vector<std::string> set;
    std::string look;
    double exposure = 0;
    std::string input = "lin_rec709";
    std::string display = "srgb";
    double reference_white = kUnitLuminance;
    std::string input_units = "relative";
    /// Names of the options that the command line has, such as `--input`.
    std::set<std::string> given = {};

    /// `name=value` texts as settings. @throws Error for one without `=`.
    [[nodiscard]] Settings settings() const;
    /// The operator; its warning is printed. Reads its file.
    /// @throws Error
    [[nodiscard]] ResolvedOperator resolved() const;
    /// @throws Error
    [[nodiscard]] View view() const;
    /// The same for an operator that is resolved already.
    [[nodiscard]] View view(ResolvedOperator resolved) const;
    /// The same for a color instead of the name in `input`.
    [[nodiscard]] View view(const SourceColor& color) const;
};

/// The reader of LUTs that are pictures, which is in the module with the picture commands. The
/// program sets it, and so does the module.
[[nodiscard]] std::function<Lut(const std::string& path)>& lut_picture_reader();
/// The reader of .tone files and LUTs as operators, for all commands.
[[nodiscard]] const OperatorSet& operator_files();
/// Prints the operator's caution, each text once.
void warn_of(const ResolvedOperator& op);
/// Prints what a command says of an operator and of its name, each text once.
/// @param text  that names it
void tell_of_operator(const std::string& text, const ResolvedOperator& op);
/// resolve_picture_operator() with these, and tell_of_operator().
[[nodiscard]] ResolvedOperator resolve_for_command(const std::string& text,
                                                   const Settings& settings = {},
                                                   const std::string& look = {});

/// Prints the messages of OpenColorIO, not with --quiet.
void print_opencolorio_messages();

/// The folder of the user for numbers that take seconds to compute: `tonewright` in
/// $XDG_CACHE_HOME, else in ~/.cache. Empty if neither is an absolute path.
[[nodiscard]] std::string user_cache_folder();

/// Each subcommand adds itself to the command line, in the file of its name; compare.cpp also has
/// `sheet` and `chart`, meter.cpp `info`.
void add_list(CommandLine& program);
void add_eval(CommandLine& program);
void add_apply(CommandLine& program);
void add_info(CommandLine& program);
void add_meter(CommandLine& program);
void add_bake(CommandLine& program);
void add_shader(CommandLine& program);
void add_conformance(CommandLine& program);
void add_config(CommandLine& program);
void add_verify(CommandLine& program);
void add_check(CommandLine& program);
void add_chart(CommandLine& program);
void add_sheet(CommandLine& program);
void add_compare(CommandLine& program);
void add_plot(CommandLine& program);
void add_import(CommandLine& program);
void add_report(CommandLine& program);

TONEWRIGHT_NAMESPACE_END
