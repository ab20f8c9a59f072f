// SPDX-License-Identifier: Apache-2.0
//
// A place in the tokens of a shader, and the limits of what is read.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "formula/glsl.h"
#include "formula/glsl_tokens.h"
#include "formula/glsl_value.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace glsl {

using Token = GlslToken;
using Kind = Token::Kind;
using Type = GlslType;
using Base = Type::Base;
using Value = GlslValue;

inline constexpr const char* kTypes =
    "float, vec2, vec3, vec4, mat3, int, bool or HLSL's names of them";

template <std::size_t n>
bool is_one_of(std::string_view text, const std::string_view (&all)[n]) {
    return std::find(std::begin(all), std::end(all), text) != std::end(all);
}

[[nodiscard]] bool is_qualifier(std::string_view name);

class Cursor {
  protected:
    explicit Cursor(std::string_view text);

    [[noreturn]] void fail(std::size_t offset, const std::string& message) const;
    [[noreturn]] void expected(const std::string& what) const;
    [[nodiscard]] std::string found() const;
    [[nodiscard]] const Token& token() const { return tokens_[at_]; }
    [[nodiscard]] const Token& after(std::size_t n = 1) const {
        return tokens_[std::min(at_ + n, tokens_.size() - 1)];
    }
    void next() {
        if (token().kind != Kind::end) ++at_;
    }
    bool skip(std::string_view sign) {
        if (!token().is(sign)) return false;
        next();
        return true;
    }
    void require(std::string_view sign) {
        if (!skip(sign)) expected(std::string(sign));
    }
    /// Behind the bracket that closes the one here. Others count where something reads what is
    /// between.
    void skip_brackets();
    void skip_to(std::string_view sign, std::string_view other);

    /// Calls glsl_...() functions. Their errors get the place, their results count.
    template <class Make>
    Value made(const Token& at, int depth, const Make& make) {
        try {
            Value value = make();
            check(at, depth, value);
            return value;
        } catch (const GlslMisuse& e) {
            fail(at.begin, e.text());
        }
    }
    void count(const Token& at, int operations, bool is_constant);

    /// Counts what is inside each other.
    struct Level {
        explicit Level(Cursor& cursor) : depth(cursor.nesting_) {
            if (++depth > kDeepestBrackets) {
                --depth;
                cursor.fail(cursor.token().begin,
                            "more than " + std::to_string(kDeepestBrackets) +
                                " brackets, signs, blocks or calls are inside each other; "
                                "expected variables");
            }
        }
        ~Level() { --depth; }
        Level(const Level&) = delete;
        Level& operator=(const Level&) = delete;
        int& depth;
    };

    std::string_view text_;
    std::vector<Token> tokens_;
    std::size_t at_ = 0;

  private:
    /// Counts the operations of a value that depends on others of this depth, and refuses numbers
    /// that are not finite.
    void check(const Token& at, int depth, const Value& value);

    int nesting_ = 0;
    int operations_ = 0;
    int steps_ = 0;
};

}  // namespace glsl
TONEWRIGHT_NAMESPACE_END
