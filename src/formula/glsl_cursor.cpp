// SPDX-License-Identifier: Apache-2.0
#include "formula/glsl_cursor.h"

#include "base/strings.h"
#include "formula/characters.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace glsl {
namespace {

/// For numbers and colors, because folding into a number takes time, too.
constexpr int kMostSteps = 20 * kMostOperations;

}  // namespace

bool is_qualifier(std::string_view name) {
    constexpr std::string_view kQualifiers[] = {"const",   "static",    "in",        "inline",
                                                "uniform", "highp",     "mediump",   "lowp",
                                                "precise", "flat",      "extern",    "volatile",
                                                "varying", "invariant", "attribute", "constexpr"};
    return is_one_of(name, kQualifiers);
}

Cursor::Cursor(std::string_view text) : text_(text) {
    if (text.size() > kLongestShader) {
        fail(0, "shader has " + std::to_string(text.size()) + " bytes; expected at most " +
                    std::to_string(kLongestShader));
    }
    tokens_ = glsl_tokens(text);
}

void Cursor::fail(std::size_t offset, const std::string& message) const {
    throw FormulaError(position_at(text_, offset), message);
}

void Cursor::expected(const std::string& what) const {
    fail(token().begin, "found " + found() + "; expected " + what);
}

std::string Cursor::found() const {
    return token().kind == Kind::end ? "the end" : printable(token().text);
}

void Cursor::skip_brackets() {
    const Token open = token();
    const std::string_view close = open.is("(") ? ")" : open.is("{") ? "}" : "]";
    std::size_t depth = 0;
    do {
        if (token().kind == Kind::end)
            fail(open.begin, "found " + std::string(open.text) + " that nothing closes; expected " +
                                 std::string(close));
        if (token().is(open.text)) ++depth;
        if (token().is(close)) --depth;
        next();
    } while (depth > 0);
}

void Cursor::skip_to(std::string_view sign, std::string_view other) {
    while (!token().is(sign) && !token().is(other)) {
        if (token().kind == Kind::end) expected(std::string(sign));
        if (token().is("(") || token().is("{") || token().is("[")) {
            skip_brackets();
        } else {
            next();
        }
    }
}

void Cursor::check(const Token& at, int depth, const Value& value) {
    const int operations = std::max(1, value.depth - depth) * static_cast<int>(value.e.size());
    count(at, operations, std::all_of(value.e.begin(), value.e.end(), [](const Expr& e) {
              return e.is_constant();
          }));
    if (value.depth > kDeepestFormula) {
        fail(at.begin, "more than " + std::to_string(kDeepestFormula) +
                           " operations depend on each other; expected at most as many");
    }
    for (const Expr& e : value.e) {
        if (!e.is_constant() || std::isfinite(e.value())) continue;
        fail(at.begin, std::string("result is ") +
                           (std::isnan(e.value()) ? "not a number" : "infinite") +
                           " for every input; expected a finite number");
    }
}

void Cursor::count(const Token& at, int operations, bool is_constant) {
    steps_ += operations;
    if (!is_constant) operations_ += operations;
    if (operations_ > kMostOperations || steps_ > kMostSteps) {
        fail(at.begin,
             "function has more than " +
                 std::to_string(operations_ > kMostOperations ? kMostOperations : kMostSteps) +
                 " operations; expected at most as many");
    }
}

}  // namespace glsl
TONEWRIGHT_NAMESPACE_END
