// SPDX-License-Identifier: Apache-2.0
#include "base/format_number.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
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

namespace {

constexpr int kLowestExponent = -60;
constexpr int kHighestExponent = 40;

double power_of_ten(int exponent) {
    static const auto powers = [] {
        std::array<double, kHighestExponent - kLowestExponent + 1> all{};
        for (int e = kLowestExponent; e <= kHighestExponent; ++e)
            all[static_cast<std::size_t>(e - kLowestExponent)] = std::pow(10.0, e);
        return all;
    }();
    return powers.at(static_cast<std::size_t>(exponent - kLowestExponent));
}

/// Appends digits 10^exponent in the shortest way.
void append_decimal(std::string& text, std::int64_t digits, int exponent) {
    if (digits == 0) {
        text += '0';
        return;
    }
    while (digits % 10 == 0) {
        digits /= 10;
        ++exponent;
    }
    const std::string number = std::to_string(digits);
    const auto count = static_cast<int>(number.size());
    std::string with_exponent = number;
    with_exponent += 'e';
    with_exponent += std::to_string(exponent);
    std::string fixed;
    if (exponent >= 0) {
        fixed = number;
        fixed.append(static_cast<std::size_t>(exponent), '0');
    } else if (-exponent < count) {
        fixed = number;
        fixed.insert(fixed.end() + exponent, '.');
    } else {
        fixed = '.';
        fixed.append(static_cast<std::size_t>(-exponent - count), '0');
        fixed += number;
    }
    text += fixed.size() <= with_exponent.size() ? fixed : with_exponent;
}

}  // namespace

void append_near(std::string& text, double value, double tolerance) {
    const double magnitude = std::fabs(value);
    int exponent = static_cast<int>(std::floor(std::log10(tolerance))) + 1;
    std::int64_t digits = 0;
    for (;; --exponent) {
        const double unit = power_of_ten(exponent);
        digits = std::llround(magnitude / unit);
        if (std::fabs(static_cast<double>(digits) * unit - magnitude) <= tolerance) break;
    }
    if (value < 0 && digits != 0) text += '-';
    append_decimal(text, digits, exponent);
}

void append_one_digit(std::string& text, double value, bool is_up) {
    const double magnitude = std::fabs(value);
    if (magnitude == 0 || is_up != (value > 0)) {
        text += '0';
        return;
    }
    const int exponent = static_cast<int>(std::floor(std::log10(magnitude)));
    const double digits = magnitude / power_of_ten(exponent);
    constexpr double kRounding = 1e-12;
    if (value < 0) text += '-';
    append_decimal(text, std::llround(std::ceil(digits - kRounding)), exponent);
}

void drop_zero_before_point(std::string& text, std::size_t begin) {
    if (begin < text.size() && text[begin] == '-') ++begin;
    if (text.compare(begin, 2, "0.") == 0) text.erase(begin, 1);
}

std::string rounded(double value, int digits) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                   std::chars_format::general, digits);
    return {text.data(), end.ptr};
}

double round_up(double value, int digits) {
    if (!(value > 0) || !std::isfinite(value)) return value;
    const double unit = std::pow(10.0, std::floor(std::log10(value)) + 1 - digits);
    // The small subtraction keeps 1.3e-7, which is not a double, from becoming 1.4e-7.
    return std::ceil(value / unit - 1e-9) * unit;
}

std::string rounded_up(double value, int digits) {
    if (!(value > 0) || !std::isfinite(value)) return shortest(value);
    return fmt::format("{:.{}e}", round_up(value, digits), digits - 1);
}

std::string shortest(double value) {
    if (std::isnan(value)) return "nan";
    if (std::isinf(value)) return value < 0 ? "-inf" : "inf";
    std::array<char, 32> buffer{};
    const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    return {buffer.data(), result.ptr};
}

TONEWRIGHT_NAMESPACE_END
