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
#include <variant>
#include <vector>

#include "cli/completion.h"
#include "cli/help_text.h"
#include "tonewright/version.h"

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11's own name
class App;
class Option;
}  // namespace CLI

TONEWRIGHT_NAMESPACE_BEGIN

/// The variable of an option. It keeps its value if the option is not given, and it must live until
/// the command line has run.
using OptionVariable =
    std::variant<std::string*, int*, double*, std::optional<int>*, std::optional<double>*,
                 std::vector<std::string>*, std::vector<double>*>;

/// Facts about an option, besides its names, its variable and its text in the help.
struct OptionFacts {
    /// Lowest and highest value of a number.
    std::optional<std::pair<double, double>> range = {};
    /// All values, which a shell suggests. Empty: not only these.
    std::vector<std::string> choices = {};
    /// Suggestions of a shell for the value. Null: none, or files if the value is one.
    Suggest suggest = {};
    /// Names of other options and arguments.
    std::vector<std::string> needs = {};
    std::vector<std::string> excludes = {};
    bool is_required = false;
    /// For a list: each occurrence takes one value, so that positional arguments may follow.
    bool takes_one_each = false;
    /// For a list: one occurrence may have several values with this between them. 0: none.
    char separator = 0;
    /// In the help, where it is not the value of the variable.
    std::string default_text = {};
    /// @see Command::common
    bool is_common = false;
};
using FactsByOption = std::map<const CLI::Option*, OptionFacts>;

/// One subcommand. A handle: the command line owns its options.
class Command {
  public:
    Command(CLI::App* app, int* exit_code, FactsByOption* facts)
        : app_(app), exit_code_(exit_code), facts_(facts) {}

    /// The title in the help of the options that are added next.
    void title(const std::string& text) const;
    /// Adds an option. The help shows the value that the variable has now, unless the help names
    /// the default.
    /// @param names  `-o,--output`
    /// @param value  the word for the value in the help, such as `FILE`
    void add(const std::string& names, const std::string& value, OptionVariable variable,
             const std::string& help, const OptionFacts& facts = {}) const;
    /// Adds an option without a value.
    void add_flag(const std::string& names, bool* variable, const std::string& help,
                  const OptionFacts& facts = {}) const;
    /// Adds a positional argument.
    void argument(const std::string& name, OptionVariable variable, const std::string& help,
                  const OptionFacts& facts = {}) const;

    /// Another text for an option that is shared, and other suggestions unless they are null.
    void describe(const std::string& name, const std::string& help, Suggest suggest = {}) const;
    /// The option excludes others.
    void exclude(const std::string& name, const std::vector<std::string>& others) const;
    /// The options that `--help` prints; `--help-all` prints the others, too. A command that does
    /// not call it has common options only.
    void common(const std::vector<std::string>& names) const;
    /// At the end of the help. Lines that begin with a space stay as they are; others are
    /// paragraphs, which are wrapped.
    void footer(const std::string& text) const;
    /// @param run    returns the exit code
    /// @param given  before that, gets the names of the options that the command line has, such as
    ///               `--input`; null: nothing does
    void action(std::function<int()> run, std::set<std::string>* given = nullptr) const;

  private:
    void set(CLI::Option* option, const OptionFacts& facts) const;

    CLI::App* app_;
    int* exit_code_;  // of the command line
    FactsByOption* facts_;
};

/// A program with subcommands, of which one runs.
class CommandLine {
  public:
    CommandLine(const std::string& name, const std::string& description,
                const std::string& version);
    ~CommandLine();
    CommandLine(const CommandLine&) = delete;
    CommandLine& operator=(const CommandLine&) = delete;

    /// @param group  the title under which the program's help lists the command
    Command add(const std::string& name, const std::string& group, const std::string& description);
    void footer(const std::string& text);

    /// The program itself, under its own name, and its commands in the order of the help.
    [[nodiscard]] std::vector<CommandTable> tables() const;

    /// Parses the arguments and runs their command, or prints help or the version.
    /// @returns      the command's exit code
    /// @throws Error wrong usage, and the command's exceptions
    int run(int argc, char** argv);

  private:
    std::unique_ptr<CLI::App> app_;
    FactsByOption facts_;
    int exit_code_ = 0;
};

TONEWRIGHT_NAMESPACE_END
