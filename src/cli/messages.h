// SPDX-License-Identifier: Apache-2.0
//
// Messages of the command on stderr: one line each.
#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <memory>
#include <set>
#include <string>

#include "tonewright/error.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Options of all commands.
struct MessageOptions {
    bool is_strict = false;
    bool is_quiet = false;
    bool is_verbose = false;
    /// `bar`, `none`, `json` or `openjd`. @see progress.h
    std::string progress = "bar";
    /// The last per cent that went to standard output, for the program and its modules; -1: none.
    std::shared_ptr<int> percent = std::make_shared<int>(-1);
    /// True if standard output gets lines of progress.
    [[nodiscard]] bool reports_progress() const {
        return progress == "json" || progress == "openjd";
    }
    /// The subcommand, and its options: `--size`.
    std::string command = {};
    std::set<std::string> options = {};
    /// Names in messages: temporary files of standard input and output are "-". Empty: as they are.
    std::function<std::string(std::string)> named = {};
};

/// The options of this process. The module of the picture commands has its own: the program passes
/// them when it loads the module.
[[nodiscard]] MessageOptions& message_options();

/// Style of parameters in messages of the command: `--size is 3`, `--size 65`.
[[nodiscard]] const MessageStyle& command_style();
/// The problem in one line, with the subcommand first where it is about the request.
[[nodiscard]] std::string command_text(const Problem& problem);
/// An exception as a problem in the words of the command, of kind `internal` if it is not an Error.
[[nodiscard]] Problem command_problem(const std::exception& error);

/// Prints `tonewright: TEXT` on stderr, always on one line, with its references to parameters in
/// the style of the command.
void print_message(const std::string& text);

/// Lines of a file that a message is about, on stderr.
void print_excerpt(const std::string& lines);

/// Prints the result of a command on stderr, on one line; not with --quiet.
void print_result(const std::string& text);

/// The result line of a command, for people: on a terminal or with --verbose, not with --quiet.
[[nodiscard]] bool says_what_was_done();

/// For commands that write one thing. Measures the time since its construction.
class ResultLine {
  public:
    /// `tonewright: TEXT, 1.23 s` on stderr, where says_what_was_done()
    void print(const std::string& text) const;

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// `tonewright: warning: TEXT`, if a result may differ from the user's intention. Call it before
/// the result is written.
/// @throws Error  of kind `check`: --strict was given
void warn(const std::string& text);

TONEWRIGHT_NAMESPACE_END
