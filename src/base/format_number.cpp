// SPDX-License-Identifier: Apache-2.0
#include "base/format_number.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>

TONEWRIGHT_NAMESPACE_BEGIN

void append_decimals(std::string& text, float value, int decimals) {
    const std::size_t begin = text.size();
    fmt::format_to(std::back_inserter(text), "{:.{}f}", value, decimals);
    if (text.find('.', begin) != std::string::npos) {
        while (text.back() == '0')
            text.pop_back();
        if (text.back() == '.') text.pop_back();
    }
    if (text.compare(begin, std::string::npos, "-0") == 0) text.erase(begin, 1);
}

void append_number(std::string& text, float value) {
    const float magnitude = std::fabs(value);
    const int leading = magnitude > 0 ? static_cast<int>(std::floor(std::log10(magnitude))) : 0;
    append_decimals(text, value, std::max(0, 8 - leading));
}

void append_compact(std::string& text, float value) {
    const float magnitude = std::fabs(value);
    const int leading = magnitude > 0 ? static_cast<int>(std::floor(std::log10(magnitude))) : 0;
    constexpr float kNothing = 1e-14F;
    const std::string exact = fmt::format("{}", value);
    std::string number =
        fmt::format("{:.{}g}", magnitude < kNothing ? 0.0F : value, std::clamp(9 + leading, 6, 9));
    if (exact.size() < number.size()) number = exact;
    text += number;
}

void drop_zero_before_point(std::string& text, std::size_t begin) {
    if (begin < text.size() && text[begin] == '-') ++begin;
    if (text.compare(begin, 2, "0.") == 0) text.erase(begin, 1);
}

std::string three_digits_up(double value) {
    if (!(value > 0) || !std::isfinite(value)) return fmt::format("{}", value);
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2);
    // The small subtraction keeps 1.23e-7, which is not a double, from becoming 1.24e-7.
    return fmt::format("{:.2e}", std::ceil(value / unit - 1e-9) * unit);
}

std::string shortest(double value) {
    if (std::isnan(value)) return "nan";
    if (std::isinf(value)) return value < 0 ? "-inf" : "inf";
    std::array<char, 32> buffer{};
    const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    return {buffer.data(), result.ptr};
}

TONEWRIGHT_NAMESPACE_END
