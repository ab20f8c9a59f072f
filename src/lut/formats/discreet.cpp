// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "base/strings.h"
#include "lut/formats/formats.h"
#include "lut/formats/text_lines.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Autodesk: rows of integers, and a line of more than three integers with the positions of the
/// nodes.
void check_3dl(TextLines& text) {
    std::size_t rows = 0;
    bool has_mesh = false;
    while (text.next_filled()) {
        text.check_length();
        std::size_t count = 0;
        const std::string_view first = text.word();
        if (!begins_number(first) || lowercase(first) == "3dmesh") {
            // "3DMESH", "Mesh 5 12", "LUT8", "gamma 1.0"
            const std::string key = lowercase(first);
            const bool is_depth = key.starts_with("lut") && key.size() <= 5 &&
                                  key.find_first_not_of("0123456789", 3) == std::string::npos;
            if (key == "3dmesh" || key == "mesh" || key == "gamma" || is_depth) continue;
            if (rows > 0 || has_mesh || !begins_keyword(first))
                text.refuse("keyword", first, "3DMESH, Mesh, gamma, LUT8 or three numbers");
            text.ignore_keyword(first);
            continue;
        }
        constexpr int kLargest = 131071;  // twice the 16-bit range
        for (std::string_view word = first; !word.empty(); word = text.word()) {
            (void)text.size("number", word, -kLargest, kLargest);
            ++count;
        }
        if (count > 3) {
            if (has_mesh || rows > 0) text.refuse("three numbers");
            has_mesh = true;
        } else {
            if (count != 3) text.refuse("three numbers");
            if (++rows > cubed(kLargestCube))
                text.fail(fmt::format("the table has more than {0} rows; expected at most {0}",
                                      cubed(kLargestCube)));
        }
    }
    const int n = static_cast<int>(std::lround(std::cbrt(static_cast<double>(rows))));
    if (n < 2 || cubed(n) != rows)
        text.fail(fmt::format(
            "the table ends after {} rows; expected N x N x N, such as 4913 with N = 17", rows));
}

void check_discreet_tables(TextLines& text) {
    (void)text.next_filled();
    (void)text.word();
    const std::string_view count = text.word();
    if (count.empty()) text.refuse("Version, Format, Type ... before it");
    const int tables = text.size("number of tables", count, 1, 4);
    const int entries = text.size("length", text.word(), 2, 65536);
    if (text.word().size() > kLongestDepth) text.refuse("a depth such as 16f");
    const auto expected = static_cast<std::size_t>(tables) * static_cast<std::size_t>(entries);
    std::size_t found = 0;
    while (text.next_filled()) {
        text.numbers(1);
        if (++found > expected) text.too_many_rows(expected);
    }
    if (found < expected) text.end_early(found, expected);
}

TONEWRIGHT_NAMESPACE_END
