// SPDX-License-Identifier: Apache-2.0
#include "cli/messages.h"

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>

#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN

MessageOptions& message_options() {
    static MessageOptions options;
    return options;
}

void print_message(const std::string& text) {
    fmt::print(stderr, "tonewright: {}\n", one_line(text));
}

void print_excerpt(const std::string& lines) {
    if (!lines.empty()) fmt::print(stderr, "{}\n", lines);
}

void print_result(const std::string& text) {
    if (!message_options().is_quiet) fmt::print(stderr, "{}\n", one_line(text));
}

void warn(const std::string& text) {
    if (message_options().is_strict)
        throw std::runtime_error(text + " (an error because of --strict)");
    print_message("warning: " + text);
}

TONEWRIGHT_NAMESPACE_END
