// SPDX-License-Identifier: Apache-2.0
#include "cli/messages.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <stdexcept>

#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN

MessageOptions& message_options() {
    static MessageOptions options;
    return options;
}

void print_message(const std::string& text) {
    const auto& named = message_options().named;
    fmt::print(stderr, "tonewright: {}\n", one_line(named ? named(text) : text));
}

void print_excerpt(const std::string& lines) {
    if (!lines.empty()) fmt::print(stderr, "{}\n", lines);
}

void print_result(const std::string& text) {
    if (!message_options().is_quiet) fmt::print(stderr, "{}\n", one_line(text));
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
        throw std::runtime_error(text + " (an error because of --strict)");
    print_message("warning: " + text);
}

TONEWRIGHT_NAMESPACE_END
