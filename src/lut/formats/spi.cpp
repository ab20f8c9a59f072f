// SPDX-License-Identifier: Apache-2.0
//
// Sony Pictures Imageworks: 1D LUTs, 3D LUTs and matrices.
#include <fmt/format.h>

#include <optional>
#include <vector>

#include "base/strings.h"
#include "lut/formats/formats.h"
#include "lut/formats/text_lines.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// OpenColorIO reads "Length9" like "Length 9".
bool begins_spi1d_keyword(std::string_view key) {
    return key.starts_with("Version") || key.starts_with("From") || key.starts_with("Length") ||
           key.starts_with("Components");
}

}  // namespace

void check_spi1d(TextLines& text) {
    std::optional<int> length;
    std::optional<int> components;
    bool has_version = false;
    bool is_open = false;
    while (!is_open && text.next_filled()) {
        text.check_length();
        const std::string_view key = text.word();
        if (key == "Version") {
            has_version = text.size(key, text.word(), 1, 1) == 1;
        } else if (key == "From") {
            const double from = text.number(key, text.word());
            const double to = text.number(key, text.word());
            if (!(from < to)) text.refuse("the first number below the second");
        } else if (key == "Length") {
            length = text.size(key, text.word(), 2, kLargestTable);
        } else if (key == "Components") {
            components = text.size(key, text.word(), 1, 3);
        } else if (key == "{") {
            is_open = true;
        } else if (begins_keyword(key) && !begins_spi1d_keyword(key)) {
            text.ignore_keyword(key);
        } else {
            text.refuse("keyword", key, "Version, From, Length, Components or {");
        }
    }
    if (!has_version) text.fail("Version is missing; expected Version 1 before {");
    if (!length) text.fail("Length is missing; expected Length and a number before {");
    if (!components) text.fail("Components is missing; expected Components 1, 2 or 3 before {");
    if (!is_open) text.end("{");
    const auto expected = static_cast<std::size_t>(*length);
    std::size_t found = 0;
    while (text.next_filled(false)) {
        text.check_length();
        if (text.word() == "}") {
            if (found < expected) text.end_early(found, expected);
            return;
        }
        text.rewind();
        text.numbers(*components);
        if (++found > expected) text.too_many_rows(expected);
    }
    if (found < expected) text.end_early(found, expected);
    text.end("}");
}

void check_spi3d(TextLines& text) {
    if (!text.next_line() || !lowercase(text.line()).starts_with("spilut"))
        text.refuse("SPILUT 1.0");
    if (!text.next_line()) text.end("3 3");
    text.numbers(2);
    if (!text.next_line()) text.end("three sizes");
    const int n = text.edge();
    std::vector<bool> is_there(cubed(n));
    std::size_t found = 0;
    while (text.next_filled()) {
        text.check_length();
        std::size_t node = 0;
        for (int c = 0; c < 3; ++c) {
            node = node * static_cast<std::size_t>(n) +
                   static_cast<std::size_t>(text.size("index", text.word(), 0, n - 1));
        }
        text.numbers(3);
        if (is_there[node]) text.refuse("every node once");
        is_there[node] = true;
        ++found;
    }
    if (found < is_there.size()) text.end_early(found, is_there.size());
}

/// A 3 by 4 matrix.
void check_spimtx(TextLines& text) {
    constexpr int kNumbers = 12;
    int found = 0;
    while (text.next_line()) {
        for (std::string_view word = text.word(); !word.empty(); word = text.word()) {
            (void)text.number("number", word);
            if (++found > kNumbers)
                text.fail(
                    fmt::format("the file has more than {0} numbers; expected {0}", kNumbers));
        }
    }
    if (found < kNumbers)
        text.fail(fmt::format("the file ends after {} numbers; expected {}", found, kNumbers));
}

TONEWRIGHT_NAMESPACE_END
