// SPDX-License-Identifier: Apache-2.0
//
// Text of `--help`: options in groups, wrapped to the width of the terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// An option, an argument or a command in a help page.
struct HelpEntry {
    std::string names;
    std::string text;
    /// Only `--help-all` prints the others.
    bool is_common = true;
};

struct HelpGroup {
    std::string title;
    std::vector<HelpEntry> entries;
};

struct HelpPage {
    std::string description;
    std::string usage;
    std::vector<HelpGroup> groups;
    /// Lines that begin with a space are examples and stay as they are; others are paragraphs.
    std::string footer;
};

/// @param has_all  with all options, not only the common ones
[[nodiscard]] std::string format_help(const HelpPage& page, bool has_all, std::size_t width);

/// `COLUMNS`, else the width of the terminal on standard output, else 80; within 40 and 120.
[[nodiscard]] std::size_t help_width();

TONEWRIGHT_NAMESPACE_END
