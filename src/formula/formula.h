// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/error.h"
#include "tonewright/expr.h"
#include "tonewright/span.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A position in a text. Lines and columns begin with 1; a column is a character.
struct TextPosition {
    std::size_t line = 1;
    std::size_t column = 1;
};
/// The position of a byte of the text.
[[nodiscard]] TONEWRIGHT_API TextPosition position_at(std::string_view text, std::size_t offset);
/// The line of a text in printable ASCII, and a second line with a caret below the column. A long
/// line is cut to the part around the column.
[[nodiscard]] TONEWRIGHT_API std::string caret_lines(std::string_view text, TextPosition at);

/// A mistake in a formula; the message is one line.
class TONEWRIGHT_API FormulaError : public Error {
  public:
    FormulaError(TextPosition where, const std::string& message) : Error(message), at(where) {}
    TextPosition at;
};

/// Meaning of a name.
struct FormulaValue {
    Expr value;
    /// Number of operations that depend on each other; at least as many as the expression has.
    int depth = 1;
};

/// The names that a formula may use.
struct FormulaScope {
    /// Names of input 0, 1, ...
    std::vector<std::string> inputs;
    /// Parameters and temporaries. A name may have a dot: `mode.soft`.
    std::map<std::string, FormulaValue, std::less<>> names;
};

/// Limits of a formula. The largest one of the built-in operators has a few hundred operations.
inline constexpr std::size_t kLongestFormula = std::size_t{1} << 18U;  // bytes
inline constexpr int kMostOperations = 10000;
inline constexpr int kDeepestFormula = 1000;  // operations that depend on each other
inline constexpr int kDeepestBrackets = 200;  // brackets, signs and `?:` inside each other

/// A formula as an expression: lines `name = expression` that set temporaries, then one expression,
/// the value. A line ends at a line break outside of brackets or at `;`. `//` and `#` begin a
/// comment. Operators as in C, weakest first: `?:`, `||`, `&&`, `== !=`, `< <= > >=`, `+ -`, `* /`,
/// signs and `!`. Functions: docs/tone_files.md.
/// @throws FormulaError
[[nodiscard]] TONEWRIGHT_API Expr parse_formula(std::string_view text, const FormulaScope& scope);
/// Lines that set temporaries, without a value. They are added to the scope.
/// @throws FormulaError
TONEWRIGHT_API void parse_temporaries(std::string_view text, FormulaScope& scope);
/// True if parse_formula() reads the text as a name.
[[nodiscard]] TONEWRIGHT_API bool is_formula_name(std::string_view text);
/// True for the name of a function: `pow`.
[[nodiscard]] TONEWRIGHT_API bool is_formula_function(std::string_view name);

/// Expressions as formulas, with temporaries for what they share.
struct FormulaText {
    /// Lines `name = expression`; empty or ending in a line break.
    std::string temporaries;
    std::vector<std::string> values;
};
/// parse_formula() reads them back as the same expressions. Parts with a name (PartNames) become
/// temporaries, however often they are used.
/// @param inputs  their names
/// @throws Error  an expression has a table, a grid or a number that is not finite, or a uniform
///                has a name that no formula can use
[[nodiscard]] TONEWRIGHT_API FormulaText formula_text(Span<const Expr> exprs,
                                                      const std::vector<std::string>& inputs);
/// One expression as one formula, its temporaries before it.
[[nodiscard]] TONEWRIGHT_API std::string whole_formula(const Expr& e,
                                                       const std::vector<std::string>& inputs);

TONEWRIGHT_NAMESPACE_END
