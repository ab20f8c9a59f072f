// SPDX-License-Identifier: Apache-2.0
#include "cli/color_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string>

#include "base/strings.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::optional<Vector3> parse_color_line(std::string_view whole, std::size_t number) {
    std::string_view line = whole.substr(0, whole.find('#'));
    Vector3 values{};
    std::size_t count = 0;
    bool is_bad = false;
    const auto skip = [&](std::string_view what) {
        line.remove_prefix(std::min(line.find_first_not_of(what), line.size()));
    };
    skip(" \t\r");
    while (!line.empty() && !is_bad) {
        double value = 0;
        if (line.front() == '+' && line.size() > 1 && line[1] != '-') {
            line.remove_prefix(1);  // from_chars takes no plus sign
        }
        const auto result = std::from_chars(line.data(), line.data() + line.size(), value);
        // A number too large for double is infinite, and one too small is 0, as printf() prints
        // such data.
        if (result.ec == std::errc::result_out_of_range) {
            value = std::strtod(std::string(line.data(), result.ptr).c_str(), nullptr);
        } else if (result.ec != std::errc()) {
            is_bad = true;
            break;
        }
        if (count < values.size()) values[count] = value;
        ++count;
        line.remove_prefix(static_cast<std::size_t>(result.ptr - line.data()));
        const std::size_t before = line.size();
        skip(" \t\r");
        if (!line.empty() && line.front() == ',') {
            line.remove_prefix(1);
            skip(" \t\r");
            if (line.empty()) is_bad = true;  // "1,2,"
        } else if (!line.empty() && line.size() == before) {
            is_bad = true;  // "1x"
        }
    }
    if (is_bad || (count != 0 && count != 3)) {
        throw Error(fmt::format("eval: standard input: line {} is \"{}\"; expected three numbers",
                                number, trimmed(whole.substr(0, 60))));
    }
    if (count == 0) return std::nullopt;
    return values;
}

TONEWRIGHT_NAMESPACE_END
