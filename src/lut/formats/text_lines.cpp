// SPDX-License-Identifier: Apache-2.0
#include "lut/formats/text_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

#include "base/strings.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
std::optional<double> parse_number(std::string_view text) {
    if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
    double value = 0;
    const auto r = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || r.ptr != text.data() + text.size()) return std::nullopt;
    if (r.ec == std::errc::result_out_of_range) {
        const std::size_t e = text.find_first_of("eE");
        const bool is_tiny = e != std::string_view::npos && text.substr(e + 1, 1) == "-";
        return is_tiny ? 0.0 : HUGE_VAL;
    }
    return r.ec == std::errc() ? std::optional(value) : std::nullopt;
}

bool is_float(double value) {
    return std::fabs(value) <= static_cast<double>(std::numeric_limits<float>::max());
}

bool begins_keyword(std::string_view word) {
    return std::isalpha(static_cast<unsigned char>(word.front())) != 0;
}

bool begins_number(std::string_view word) {
    return std::isdigit(static_cast<unsigned char>(word.front())) || word.front() == '-' ||
           word.front() == '+' || word.front() == '.' || lowercase(word) == "nan" ||
           lowercase(word) == "inf";
}

std::size_t cubed(int n) {
    const auto edge = static_cast<std::size_t>(n);
    return edge * edge * edge;
}

bool TextLines::next_line() {
    if (rest_.empty()) return false;
    ++number_;
    const std::size_t end = rest_.find('\n');
    line_ = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (line_.find('\0') != std::string_view::npos)
        fail("the line holds bytes that are not text; expected a text file");
    words_ = line_;
    return true;
}

std::string_view TextLines::word() {
    const std::size_t begin = words_.find_first_not_of(kBlank);
    if (begin == std::string_view::npos) return {};
    words_.remove_prefix(begin);
    const std::string_view result = words_.substr(0, words_.find_first_of(kBlank));
    words_.remove_prefix(result.size());
    return result;
}

bool TextLines::next_filled(bool has_comments) {
    while (next_line()) {
        const std::string_view first = word();
        rewind();
        if (!first.empty() && !(has_comments && first.front() == '#')) return true;
    }
    return false;
}

double TextLines::number(std::string_view name, std::string_view text) const {
    const std::optional<double> value = parse_number(text);
    if (!value) refuse(name, text, "a number");
    if (!is_float(*value)) refuse(name, text, "a finite number");
    return *value;
}

int TextLines::size(std::string_view name, std::string_view text, int lo, int hi) const {
    int value = 0;
    const auto r = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string expected = fmt::format("a whole number in [{}, {}]", lo, hi);
    if (r.ptr != text.data() + text.size() || r.ec != std::errc() || value < lo || value > hi)
        refuse(name, text, expected);
    return value;
}

std::array<float, 3> TextLines::numbers(int count) {
    static constexpr std::array<const char*, 4> kNames = {"no", "one", "two", "three"};
    const std::string expected =
        fmt::format("{} number{}", kNames[static_cast<std::size_t>(count)], count == 1 ? "" : "s");
    std::array<float, 3> values{};
    for (int i = 0; i < count; ++i) {
        const std::string_view text = word();
        if (text.empty()) refuse(expected);
        values[static_cast<std::size_t>(i)] = static_cast<float>(number("number", text));
    }
    if (!word().empty()) refuse(expected);
    return values;
}

void TextLines::check_length() const {
    constexpr std::size_t kLongestLine = 4000;
    if (line_.size() > kLongestLine)
        fail(fmt::format("the line has {} characters; expected at most {}", line_.size(),
                         kLongestLine));
}

void TextLines::ignore_keyword(std::string_view keyword) {
    if (!note_.empty()) return;
    note_ = fmt::format("line {}: keyword {} is unknown and ignored", number_, printable(keyword));
}

void TextLines::fail_at(int line, const std::string& reason) const {
    throw FileError(fmt::format("read: {}: line {}: {}", path_, std::max(line, 1), reason));
}

void TextLines::refuse(const std::string& expected) const {
    const bool is_blank = line_.find_first_not_of(kBlank) == std::string_view::npos;
    fail((is_blank ? "the line is empty" : printable(trimmed(line_))) + "; expected " + expected);
}

void TextLines::refuse(std::string_view name, std::string_view value,
                       const std::string& expected) const {
    fail(fmt::format("{} is {}; expected {}", printable(name),
                     value.empty() ? "missing" : printable(value), expected));
}

void TextLines::end_early(std::size_t found, std::size_t expected) const {
    fail(fmt::format("the table ends after {} rows; expected {}", found, expected));
}
void TextLines::too_many_rows(std::size_t expected) const {
    fail(fmt::format("the table has more than {0} rows; expected {0}", expected));
}

std::array<float, 3> TableRows::add(TextLines& text) {
    if (expected_ == 0) text.refuse("a size before the first row");
    const std::array<float, 3> row = text.numbers(3);
    if (++found_ > expected_) text.too_many_rows(expected_);
    return row;
}
void TableRows::finish(const TextLines& text) const {
    if (expected_ == 0) text.end("a size and as many rows");
    if (found_ < expected_) text.end_early(found_, expected_);
}

int TextLines::edge() {
    int n = 0;
    for (int c = 0; c < 3; ++c) {
        const int next = size("size", word(), 2, kLargestCube);
        if (c > 0 && next != n) refuse("three equal sizes");
        n = next;
    }
    if (!word().empty()) refuse("three sizes");
    return n;
}

TONEWRIGHT_NAMESPACE_END
