// SPDX-License-Identifier: Apache-2.0
#include "definition/toml_text.h"

#include <algorithm>
#include <vector>

#include "base/strings.h"

// A definition nests four deep. The library's own limit of 256 would do, but for the tables that it
// makes of dotted keys, which have no limit: see check_nesting().
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

/// a.b.c = 1 makes a table in a table. What is so deep that it does not fit on the stack is found
/// before the library reads it.
void check_nesting(std::string_view text) {
    std::size_t dots = 0;
    std::size_t begin = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '\n') {
            dots = 0;
            begin = i + 1;
        }
        if (c == '.') ++dots;
        const bool ends_key = c == '=' || c == ']';
        if (ends_key && dots > kMostDots) {
            throw TomlError(position_at(text, begin),
                            "line has " + std::to_string(dots) + " dots before a " + c +
                                "; expected at most " + std::to_string(kMostDots));
        }
        if (ends_key) dots = 0;
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
    } else if (const auto number = node.value<double>()) {
        value.kind = Kind::number;
        value.number = *number;
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
    check_nesting(text);
    try {
        return value_of(toml::parse(text));
    } catch (const toml::parse_error& e) {
        throw TomlError(position_of(e.source()), one_line(e.description(), 300));
    } catch (const FailedAssertion&) {
        throw TomlError({failing_line(text), 1}, "line is no TOML; expected a key or a value");
    }
}

TONEWRIGHT_NAMESPACE_END
