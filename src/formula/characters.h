// SPDX-License-Identifier: Apache-2.0
//
// Characters, numbers, operators and truth values, for the readers of formulas and of shaders.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

inline bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
/// True for a byte of a UTF-8 character after its first byte.
inline bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }
/// The character that the text begins with, as messages name it: `a` or U+00B2.
[[nodiscard]] std::string first_character_name(std::string_view text);
/// Length of the number that the text begins with, and of the letters that are glued to it.
[[nodiscard]] std::size_t number_length(std::string_view text);
/// The value of a number, which may end in `f` as in C.
struct NumberText {
    double value = 0;
    const char* expected = nullptr;  // what a text that is no number should be
};
[[nodiscard]] NumberText number_of(std::string_view text);

/// Binding strength of operators, weakest first.
enum Precedence : unsigned char {
    kNone,
    kChoice,
    kOr,
    kAnd,
    kEquality,
    kOrder,
    kSum,
    kProduct,
    kSign
};
/// The binary operator of this text, as in C: `&&`. kNone: not an operator.
[[nodiscard]] Precedence precedence_of(std::string_view sign);

Expr log10(const Expr& a);
/// 1 where it is not 0, else 0; itself where it is one of them.
[[nodiscard]] Expr truth(const Expr& e);

TONEWRIGHT_NAMESPACE_END
