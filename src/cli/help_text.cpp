// SPDX-License-Identifier: Apache-2.0
#include "cli/help_text.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <string_view>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// Names that are longer get a line of their own.
constexpr std::size_t kWidestNames = 26;

std::vector<std::string> wrap(std::string_view text, std::size_t width) {
    std::vector<std::string> lines(1);
    while (!text.empty()) {
        const std::size_t begin = text.find_first_not_of(' ');
        if (begin == std::string_view::npos) break;
        text.remove_prefix(begin);
        const std::string_view word = text.substr(0, text.find(' '));
        text.remove_prefix(word.size());
        std::string& line = lines.back();
        if (line.empty()) {
            line = word;
        } else if (line.size() + 1 + word.size() <= width) {
            line.append(" ").append(word);
        } else {
            lines.emplace_back(word);
        }
    }
    return lines;
}

void append_entry(std::string& help, const HelpEntry& entry, std::size_t column,
                  std::size_t width) {
    std::string left = "  " + entry.names;
    const std::vector<std::string> lines = wrap(entry.text, std::max(width, column + 20) - column);
    if (left.size() + 2 > column) {
        help += left + "\n";
        left.clear();
    }
    for (const std::string& line : lines) {
        help += fmt::format("{:<{}}{}\n", left, line.empty() ? 0 : column, line);
        left.clear();
    }
}

void append_footer(std::string& help, std::string_view footer, std::size_t width) {
    while (!footer.empty()) {
        const std::size_t end = footer.find('\n');
        const std::string_view line = footer.substr(0, end);
        footer.remove_prefix(end == std::string_view::npos ? footer.size() : end + 1);
        if (line.starts_with(' ')) {
            help.append(line).append("\n");
            continue;
        }
        for (const std::string& part : wrap(line, width))
            help += part + "\n";
    }
}

}  // namespace

std::string format_help(const HelpPage& page, bool has_all, std::size_t width) {
    std::size_t widest = 0;
    std::vector<HelpGroup> shown;
    for (HelpGroup group : page.groups) {
        std::vector<HelpEntry>& entries = group.entries;
        const auto rare = std::stable_partition(entries.begin(), entries.end(),
                                                [](const HelpEntry& e) { return e.is_common; });
        if (!has_all) entries.erase(rare, entries.end());
        for (const HelpEntry& entry : entries) {
            if (entry.names.size() <= kWidestNames) widest = std::max(widest, entry.names.size());
        }
        if (!entries.empty()) shown.push_back(std::move(group));
    }
    std::string help;
    for (const std::string& text : {page.description, "Usage: " + page.usage}) {
        for (const std::string& line : wrap(text, width))
            help += line + "\n";
    }
    for (const HelpGroup& group : shown) {
        help += fmt::format("\n{}:\n", group.title);
        for (const HelpEntry& entry : group.entries)
            append_entry(help, entry, widest + 4, width);
    }
    if (!page.footer.empty()) {
        help += "\n";
        append_footer(help, page.footer, width);
    }
    return help;
}

std::size_t help_width() {
    constexpr std::size_t narrowest = 40;
    constexpr std::size_t widest = 120;
    std::size_t width = 80;
    winsize size{};
    if (isatty(STDOUT_FILENO) && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
        width = size.ws_col;
    if (const char* columns = std::getenv("COLUMNS")) {
        std::size_t number = 0;
        const auto result = std::from_chars(columns, columns + std::strlen(columns), number);
        if (result.ec == std::errc() && *result.ptr == '\0' && number > 0) width = number;
    }
    return std::clamp(width, narrowest, widest);
}

TONEWRIGHT_NAMESPACE_END
