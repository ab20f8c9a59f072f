// SPDX-License-Identifier: Apache-2.0
#include "definition/toml_text.h"

#include <algorithm>
#include <vector>

#include "base/strings.h"

// A definition nests four deep. The library's own limit of 256 would do, but for the tables that it
// makes of dotted keys, which have no limit: see check_keys().
#define TOML_MAX_NESTED_VALUES 16
// Its assertions are on the file in places (`[ = 1`), and with NDEBUG the compiler may take them
// for true. Here they are errors of the file.
#undef NDEBUG
namespace {
struct FailedAssertion {};
[[noreturn]] void fail_toml_assertion() { throw FailedAssertion(); }
}  // namespace
#define TOML_ASSERT(condition) ((condition) ? void() : fail_toml_assertion())
#include <toml++/toml.h>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::size_t kMostDots = 32;

bool is_ascii(char c) { return static_cast<unsigned char>(c) < 0x80; }

/// The place behind the string that begins at `begin`; the end of the text where it has no end.
std::size_t end_of_string(std::string_view text, std::size_t begin) {
    const char quote = text[begin];
    const std::string three(3, quote);
    const bool is_long = text.substr(begin, 3) == three;
    const std::string_view end = is_long ? std::string_view(three) : text.substr(begin, 1);
    for (std::size_t i = begin + end.size(); i < text.size(); ++i) {
        if (quote == '"' && text[i] == '\\') {
            // What follows is an escape, or blanks up to the end of the line.
            const std::size_t next = std::min(text.find_first_not_of(" \t", i + 1), text.size());
            if (next < text.size() && !is_ascii(text[next]))
                throw TomlError(position_at(text, i),
                                "escape is not ASCII; expected \\n, \\t, ...");
            ++i;
        } else if (text[i] == '\n' && !is_long) {
            return i;  // the library says that it has no end
        } else if (text.substr(i, end.size()) == end) {
            i += end.size();
            // """a""""": up to two more belong to it.
            for (int more = 0; is_long && more < 2 && i < text.size() && text[i] == quote; ++more)
                ++i;
            return i;
        }
    }
    return text.size();
}

/// What stands outside of quotes and comments is ASCII, and has few dots in one key: a.b.c = 1
/// makes a table in a table. The library's own functions are undefined for some other characters
/// there, and it makes as many tables as there are dots, whether they fit on the stack or not.
/// Quotes begin where a key or a value does: behind `444` they would hide characters that the
/// library takes for a part of the number.
void check_keys(std::string_view text) {
    std::size_t dots = 0;
    char before = '\n';  // that is not blank
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '#') {
            i = std::min(text.find('\n', i), text.size()) - 1;
        } else if (c == '"' || c == '\'') {
            if (std::string_view("\n=[,{.").find(before) == std::string_view::npos)
                throw TomlError(position_at(text, i),
                                "quote stands behind a value; expected the end of the line");
            i = end_of_string(text, i) - 1;
        } else if (!is_ascii(c)) {
            throw TomlError(position_at(text, i), "character is not ASCII; expected it in quotes");
        } else if (c == '.') {
            if (++dots > kMostDots)
                throw TomlError(position_at(text, i), "key has more than " +
                                                          std::to_string(kMostDots) +
                                                          " dots; expected at most as many");
        } else if (c == '\n' || c == '=' || c == ',') {
            dots = 0;
        }
        if (c != ' ' && c != '\t' && c != '\r') before = c;
    }
}

void check_encoding(std::string_view text) {
    const std::string_view first = text.substr(0, 2);
    if (first == "\xFF\xFE" || first == "\xFE\xFF")
        throw TomlError({}, "file is UTF-16; expected UTF-8");
    if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos)
        throw TomlError(position_at(text, zero), "file has a zero byte; expected text in UTF-8");
}

TextPosition position_of(const toml::source_region& region) {
    return {std::max<std::size_t>(region.begin.line, 1),
            std::max<std::size_t>(region.begin.column, 1)};
}

TomlValue value_of(const toml::node& node) {
    using Kind = TomlValue::Kind;
    TomlValue value;
    value.at = position_of(node.source());
    if (const auto* table = node.as_table()) {
        value.kind = Kind::table;
        for (const auto& [key, member] : *table) {
            value.members.push_back(value_of(member));
            value.members.back().key = key.str();
            value.members.back().key_at = position_of(key.source());
        }
        const auto order = [](const TomlValue& a, const TomlValue& b) {
            return std::pair(a.key_at.line, a.key_at.column) <
                   std::pair(b.key_at.line, b.key_at.column);
        };
        std::stable_sort(value.members.begin(), value.members.end(), order);
    } else if (const auto* array = node.as_array()) {
        value.kind = Kind::array;
        for (const toml::node& item : *array)
            value.items.push_back(value_of(item));
    } else if (const auto* text = node.as_string()) {
        value.kind = Kind::text;
        value.text = text->get();
    } else if (const auto* flag = node.as_boolean()) {
        value.kind = Kind::boolean;
        value.boolean = flag->get();
    } else if (const auto* integer = node.as_integer()) {
        // Above 2^53, the nearest number.
        value.kind = Kind::number;
        value.number = static_cast<double>(integer->get());
    } else if (const auto* number = node.as_floating_point()) {
        value.kind = Kind::number;
        value.number = number->get();
    } else {
        value.kind = Kind::date;
    }
    return value;
}

/// The line at which the library's assertion fails: the last one of the shortest text that has it.
std::size_t failing_line(std::string_view text) {
    std::size_t passes = 0;  // so many lines
    std::vector<std::size_t> ends;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '\n') ends.push_back(i + 1);
    }
    ends.push_back(text.size());
    std::size_t fails = ends.size();
    while (fails - passes > 1) {
        const std::size_t middle = passes + (fails - passes) / 2;
        try {
            (void)toml::parse(text.substr(0, ends[middle - 1]));
            passes = middle;
        } catch (const toml::parse_error&) {
            passes = middle;
        } catch (const FailedAssertion&) {
            fails = middle;
        }
    }
    return fails;
}

}  // namespace

TomlValue parse_toml(std::string_view text) {
    check_encoding(text);
    check_keys(text);
    try {
        return value_of(toml::parse(text));
    } catch (const toml::parse_error& e) {
        throw TomlError(position_of(e.source()), one_line(e.description(), 300));
    } catch (const FailedAssertion&) {
        throw TomlError({failing_line(text), 1}, "line is no TOML; expected a key or a value");
    }
}

TONEWRIGHT_NAMESPACE_END
