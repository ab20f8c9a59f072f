// SPDX-License-Identifier: Apache-2.0
#include "formula/characters.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numbers>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

bool is_truth(const Expr& e) {
    switch (e.op()) {
        case ExprOp::less:
        case ExprOp::less_equal:
        case ExprOp::equal:
            return true;
        case ExprOp::constant:
            return e.value() == 0 || e.value() == 1;
        case ExprOp::select:
            return e.operand(1).is_constant() && is_truth(e.operand(1)) &&
                   e.operand(2).is_constant() && is_truth(e.operand(2));
        default:
            return false;
    }
}

}  // namespace

std::string first_character_name(std::string_view text) {
    std::size_t length = 1;
    while (length < text.size() && length < 4 && is_continuation(text[length]))
        ++length;
    constexpr std::array<unsigned, 5> kMask = {0, 0x7F, 0x1F, 0x0F, 0x07};
    unsigned code = static_cast<unsigned char>(text.front()) & kMask.at(length);
    for (const char c : text.substr(1, length - 1))
        code = code << 6U | (static_cast<unsigned char>(c) & 0x3FU);
    const char first = text.front();
    if (length == 1 && first >= ' ' && first <= '~') return std::string(1, first);
    std::array<char, 16> name{};
    (void)std::snprintf(name.data(), name.size(), "U+%04X", code);
    return name.data();
}

std::size_t number_length(std::string_view text) {
    std::size_t n = 0;
    const auto digits = [&] {
        while (n < text.size() && is_digit(text[n]))
            ++n;
    };
    digits();
    if (n < text.size() && text[n] == '.') ++n;
    digits();
    if (n < text.size() && (text[n] == 'e' || text[n] == 'E')) {
        std::size_t exponent = n + 1;
        if (exponent < text.size() && (text[exponent] == '+' || text[exponent] == '-')) ++exponent;
        if (exponent < text.size() && is_digit(text[exponent])) {
            n = exponent;
            digits();
        }
    }
    // The `f` of 1.0f in C; what else is glued to a number is a mistake.
    while (n < text.size() && (is_letter(text[n]) || is_digit(text[n])))
        ++n;
    return n;
}

NumberText number_of(std::string_view text) {
    if (text.back() == 'f' || text.back() == 'F') text.remove_suffix(1);
    double value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ptr != text.data() + text.size() || result.ec == std::errc::invalid_argument)
        return {0, "digits, as in 0.18 or 1e-3"};
    if (result.ec != std::errc() || !std::isfinite(value))
        return {0, "one that double precision can hold"};
    return {value};
}

Expr log10(const Expr& a) { return log2(a) * (std::numbers::ln2 / std::numbers::ln10); }

Expr truth(const Expr& e) { return is_truth(e) ? e : select(e, 1, 0); }

TONEWRIGHT_NAMESPACE_END
