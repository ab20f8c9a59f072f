// SPDX-License-Identifier: Apache-2.0
#include "cli/messages.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <span>
#include <string_view>
#include <utility>

#include "base/problem.h"
#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string with_dashes(std::string_view name) {
    std::string option = "--" + std::string(name);
    std::replace(option.begin(), option.end(), '_', '-');
    return option;
}

using Names = std::span<const std::pair<std::string_view, std::string_view>>;

std::string named_in(Names names, std::string_view parameter) {
    const auto found = std::find_if(names.begin(), names.end(),
                                    [&](const auto& pair) { return pair.first == parameter; });
    return with_dashes(found == names.end() ? parameter : found->second);
}

/// `--size` of `size`. Some options have another name than the field that they set.
std::string option_of(std::string_view parameter) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 2> kOthers = {
        {{"application", "for"}, {"custom", "operator"}}};
    return named_in(kOthers, parameter);
}

/// The option that sets the parameter among others, or in some commands.
std::string wider_option_of(std::string_view parameter) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kOthers = {
        {{"bins", "histogram-bins"},
         {"high_percentile", "percentiles"},
         {"histogram_max", "histogram-range"},
         {"histogram_min", "histogram-range"},
         {"input", "working"},
         {"low_percentile", "percentiles"},
         {"max_stops", "exposure-limits"},
         {"method", "auto-exposure"},
         {"min_stops", "exposure-limits"},
         {"region", "meter-region"}}};
    return named_in(kOthers, parameter);
}

}  // namespace

MessageOptions& message_options() {
    static MessageOptions options;
    return options;
}

const MessageStyle& command_style() {
    static const MessageStyle style = {
        [](std::string_view parameter) {
            if (parameter == "target") return std::string("-o");
            // Options that stand for several values have their plural. A parameter that is no
            // option, such as a file, is a word.
            const std::string option = option_of(parameter);
            for (const std::string& known : {option, option + "s", wider_option_of(parameter)}) {
                if (message_options().options.contains(known)) return known;
            }
            std::string words(parameter);
            std::replace(words.begin(), words.end(), '_', ' ');
            return words;
        },
        [](std::string_view parameter, std::string_view value) {
            if (parameter == "task") return fmt::format("`tonewright {}`", value);
            if (parameter == "list")
                return fmt::format("`tonewright list{}{}`", value == "operators" ? "" : " --",
                                   value == "operators" ? "" : value);
            if (parameter == "pixel_type") return fmt::format("-d {}", value);
            if (parameter == "dimension") return fmt::format("--{}", value);
            if (parameter == "target")
                return std::string(value.empty() ? "-o" : "-o ") + std::string(value);
            if (parameter == "settings") return fmt::format("--set {}=...", value);
            const std::string option = option_of(parameter);
            return value.empty() || value == "yes" ? option : fmt::format("{} {}", option, value);
        }};
    return style;
}

std::string command_text(const Problem& problem) {
    const std::string text = render(problem, command_style());
    const std::string& command = message_options().command;
    return problem.what.empty() && !command.empty() ? command + ": " + text : text;
}

Problem command_problem(const std::exception& error) {
    const Problem problem = problem_of(error);
    return {.kind = problem.kind,
            .what = render(problem, command_style()),
            .error_number = problem.error_number};
}

void print_message(const std::string& text) {
    const auto& named = message_options().named;
    const std::string shown = render(text, command_style());
    fmt::print(stderr, "tonewright: {}\n", one_line(named ? named(shown) : shown));
}

void print_excerpt(const std::string& lines) {
    if (!lines.empty()) fmt::print(stderr, "{}\n", lines);
}

void print_result(const std::string& text) {
    if (!message_options().is_quiet)
        fmt::print(stderr, "{}\n", one_line(render(text, command_style())));
}

bool says_what_was_done() {
    const MessageOptions& messages = message_options();
    return !messages.is_quiet && (messages.is_verbose || ::isatty(STDERR_FILENO) != 0);
}

void ResultLine::print(const std::string& text) const {
    if (!says_what_was_done()) return;
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start_;
    print_message(fmt::format("{}, {:.2f} s", text, seconds.count()));
}

void warn(const std::string& text) {
    if (message_options().is_strict)
        throw Error(Problem{.kind = Problem::Kind::check,
                            .what = text + " (an error because of --strict)"});
    print_message("warning: " + text);
}

TONEWRIGHT_NAMESPACE_END
