// SPDX-License-Identifier: Apache-2.0
//
// CLI11 behind a narrow interface: its header costs every file that includes it seconds of compile
// time, and options.cpp alone includes it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tonewright/version.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

TONEWRIGHT_NAMESPACE_BEGIN

/// One option, flag or positional argument of a command. A handle: the command line owns the
/// option.
class Option {
  public:
    explicit Option(CLI::Option* option) : option_(option) {}

    const Option& required() const;
    /// The help shows the value that the variable has now.
    const Option& show_default() const;
    const Option& show_default(const std::string& text) const;
    const Option& describe(const std::string& help) const;
    /// The title in the help under which the option stands.
    const Option& group(const std::string& title) const;
    const Option& range(int low, int high) const;
    const Option& range(double low, double high) const;
    const Option& choices(const std::vector<std::string>& texts) const;
    const Option& choices(const std::vector<int>& numbers) const;
    /// Of a list: each occurrence takes one value, so that positional arguments may follow.
    const Option& one_value_each() const;
    /// Of a list: one occurrence may hold several values with `separator` between them.
    const Option& separated_by(char separator) const;
    const Option& needs(const Option& other) const;
    const Option& excludes(const Option& other) const;

  private:
    CLI::Option* option_;
};

/// One subcommand. A handle, as Option is.
class Command {
  public:
    Command(CLI::App* app, int* exit_code) : app_(app), exit_code_(exit_code) {}

    // The variable keeps its value where the option is not given; it must live until the command
    // line has run.
    Option add(const std::string& name, std::string& value, const std::string& help) const;
    Option add(const std::string& name, int& value, const std::string& help) const;
    Option add(const std::string& name, double& value, const std::string& help) const;
    Option add(const std::string& name, std::optional<int>& value, const std::string& help) const;
    Option add(const std::string& name, std::optional<double>& value,
               const std::string& help) const;
    Option add(const std::string& name, std::vector<std::string>& values,
               const std::string& help) const;
    Option add(const std::string& name, std::vector<double>& values, const std::string& help) const;
    Option add_flag(const std::string& name, bool& value, const std::string& help) const;

    void footer(const std::string& text) const;
    /// @param run  returns the exit code
    void action(std::function<int()> run) const;

    [[nodiscard]] Option option(const std::string& name) const;
    /// Names of the options that the command line has, such as `--input`.
    [[nodiscard]] std::set<std::string> given() const;

  private:
    CLI::App* app_;
    int* exit_code_;  // of the command line
};

/// A program with subcommands, of which one runs.
class CommandLine {
  public:
    CommandLine(const std::string& name, const std::string& description,
                const std::string& version);
    ~CommandLine();
    CommandLine(const CommandLine&) = delete;
    CommandLine& operator=(const CommandLine&) = delete;

    Command add(const std::string& name, const std::string& description);
    void footer(const std::string& text);

    /// Parses the arguments and runs the command that they name, or prints help or the version.
    /// @returns      the command's exit code
    /// @throws Error wrong usage, and everything that the command throws
    int run(int argc, char** argv);

  private:
    std::unique_ptr<CLI::App> app_;
    int exit_code_ = 0;
};

TONEWRIGHT_NAMESPACE_END
