// SPDX-License-Identifier: Apache-2.0
//
// A narrow interface to CLI11. Only options.cpp includes its header, which takes seconds to
// compile.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cli/completion.h"
#include "cli/help_text.h"
#include "tonewright/version.h"

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11's own name
class App;
class Option;
}  // namespace CLI

TONEWRIGHT_NAMESPACE_BEGIN

/// Facts about an option for the help and the messages, besides its names and its text.
struct OptionHelp {
    std::string value;
    /// Lowest and highest value of a number.
    std::optional<std::pair<double, double>> limits;
    bool is_common = false;
    /// Suggestions for the value. Null: none, or files if the value is one.
    Suggest suggest = {};
};
using OptionHelps = std::map<const CLI::Option*, OptionHelp>;

/// One option, flag or positional argument of a command. A handle: the command line owns the
/// option.
class Option {
  public:
    Option(const CLI::App* app, CLI::Option* option, OptionHelps* helps)
        : app_(app), option_(option), helps_(helps) {}

    const Option& required() const;
    /// The word for the value in the help, such as `FILE`.
    const Option& value(const std::string& name) const;
    /// The help shows the value that the variable has now.
    const Option& show_default() const;
    const Option& show_default(const std::string& text) const;
    const Option& describe(const std::string& help) const;
    /// The title of its group in the help.
    const Option& group(const std::string& title) const;
    /// The lowest and the highest number that the value can be.
    const Option& range(double low, double high) const;
    const Option& choices(const std::vector<std::string>& texts) const;
    const Option& choices(const std::vector<int>& numbers) const;
    /// For a list: each occurrence takes one value, so that positional arguments may follow.
    const Option& one_value_each() const;
    /// For a list: one occurrence may have several values with `separator` between them.
    const Option& separated_by(char separator) const;
    /// Suggestions of a shell for the value. choices() also declares them.
    const Option& suggest(Suggest suggest) const;
    const Option& suggest(const std::vector<std::string>& words) const;
    const Option& needs(const Option& other) const;
    const Option& excludes(const Option& other) const;

  private:
    const CLI::App* app_;
    CLI::Option* option_;
    OptionHelps* helps_;
};

/// One subcommand. A handle, like Option.
class Command {
  public:
    Command(CLI::App* app, int* exit_code, OptionHelps* helps)
        : app_(app), exit_code_(exit_code), helps_(helps) {}

    // The variable keeps its value if the option is not given. It must live until the command line
    // has run.
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

    /// The title under which the program's help lists the command.
    void group(const std::string& title) const;
    /// The options that `--help` prints; `--help-all` prints the others, too. A command that does
    /// not call it has common options only.
    void common(const std::vector<std::string>& names) const;
    /// At the end of the help. Lines that begin with a space stay as they are; others are
    /// paragraphs, which are wrapped.
    void footer(const std::string& text) const;
    /// @param run  returns the exit code
    void action(std::function<int()> run) const;

    [[nodiscard]] Option option(const std::string& name) const;
    /// Names of the options that the command line has, such as `--input`.
    [[nodiscard]] std::set<std::string> given() const;

  private:
    template <class Value>
    Option add_option(const std::string& name, Value& value, const std::string& help) const;

    CLI::App* app_;
    int* exit_code_;  // of the command line
    OptionHelps* helps_;
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

    /// The program itself, under its own name, and its commands in the order of the help.
    [[nodiscard]] std::vector<CommandTable> tables() const;

    /// Parses the arguments and runs their command, or prints help or the version.
    /// @returns      the command's exit code
    /// @throws Error wrong usage, and the command's exceptions
    int run(int argc, char** argv);

  private:
    std::unique_ptr<CLI::App> app_;
    OptionHelps helps_;
    int exit_code_ = 0;
};

TONEWRIGHT_NAMESPACE_END
