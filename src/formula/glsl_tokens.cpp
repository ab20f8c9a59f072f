// SPDX-License-Identifier: Apache-2.0
#include "formula/glsl_tokens.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "base/strings.h"
#include "formula/characters.h"
#include "formula/formula.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Token = GlslToken;
using Kind = Token::Kind;
using Tokens = std::vector<Token>;

/// For a text, and for all expansions of macros.
constexpr std::size_t kMostTokens = std::size_t{1} << 20U;
constexpr int kDeepestMacro = 64;

struct Macro {
    bool has_arguments = false;
    std::vector<std::string_view> arguments;
    Tokens body;
};

class Preprocessor {
  public:
    explicit Preprocessor(std::string_view text) : text_(text) {}

    Tokens run() {
        Tokens line;  // the tokens since the last directive: arguments of a macro may span lines
        while (true) {
            const bool is_first = skip_blanks();
            if (at_ == text_.size()) break;
            if (text_[at_] == '#' && is_first) {
                expand(line, result_, 0);
                line.clear();
                directive();
            } else if (is_active()) {
                line.push_back(read());
            } else {
                at_ = std::min(text_.find('\n', at_), text_.size());
            }
        }
        expand(line, result_, 0);
        if (!conditions_.empty())
            fail(conditions_.back().begin, "found a condition that does not end; expected #endif");
        result_.push_back({Kind::end, text_.size(), {}});
        return std::move(result_);
    }

  private:
    [[noreturn]] void fail(std::size_t offset, const std::string& message) const {
        throw FormulaError(position_at(text_, offset), message);
    }

    /// @returns  true at the first token of a line
    bool skip_blanks(bool is_one_line = false) {
        bool is_first = at_ == 0 || text_[at_ - 1] == '\n';
        while (at_ < text_.size()) {
            const char c = text_[at_];
            const std::string_view two = text_.substr(at_, 2);
            if (two == "//") {
                at_ = std::min(text_.find('\n', at_), text_.size());
            } else if (two == "/*") {
                const std::size_t end = text_.find("*/", at_ + 2);
                if (end == std::string_view::npos)
                    fail(at_, "found a comment that does not end; expected */");
                at_ = end + 2;
            } else if (two == "\\\n" || text_.substr(at_, 3) == "\\\r\n") {
                at_ = text_.find('\n', at_) + 1;
            } else if (c == '\n') {
                if (is_one_line) return false;
                is_first = true;
                ++at_;
            } else if (c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v') {
                ++at_;
            } else {
                break;
            }
        }
        return is_first;
    }

    Token read() {
        const std::string_view rest = text_.substr(at_);
        const auto take = [&](Kind kind, std::size_t length) {
            const std::size_t begin = at_;
            at_ += length;
            return Token{kind, begin, rest.substr(0, length)};
        };
        const char c = rest.front();
        if (is_letter(c)) {
            std::size_t n = 1;
            while (n < rest.size() && (is_letter(rest[n]) || is_digit(rest[n])))
                ++n;
            return take(Kind::name, n);
        }
        if (is_digit(c) || (c == '.' && rest.size() > 1 && is_digit(rest[1])))
            return take(Kind::number, number_length(rest));
        for (const std::string_view sign : {"&&", "||", "^^", "==", "!=", "<=", ">=", "+=", "-=",
                                            "*=", "/=", "++", "--", "<<", ">>", "::"}) {
            if (rest.substr(0, 2) == sign) return take(Kind::sign, 2);
        }
        if (std::string_view("+-*/<>?:!(),;=^%&|[]{}.~#").find(c) != std::string_view::npos)
            return take(Kind::sign, 1);
        fail(at_, "found " + first_character_name(rest) +
                      "; expected names, numbers and operators in ASCII");
    }

    // -- Directives

    [[nodiscard]] bool is_active() const {
        return std::all_of(conditions_.begin(), conditions_.end(),
                           [](const Condition& condition) { return condition.holds; });
    }

    void directive() {
        const std::size_t begin = at_++;
        const bool was_active = is_active();
        const auto more = [&] {
            (void)skip_blanks(true);
            return at_ < text_.size() && text_[at_] != '\n';
        };
        std::string_view word;
        if (more() && is_letter(text_[at_])) word = read().text;
        const bool is_condition = word == "if" || word == "ifdef" || word == "ifndef" ||
                                  word == "else" || word == "elif" || word == "endif";
        const bool is_read = (was_active && (word == "define" || word == "undef")) || is_condition;
        if (!is_read) {  // #version, #pragma, #include, ...: nothing for an expression
            at_ = std::min(text_.find('\n', at_), text_.size());
            return;
        }
        Tokens line;
        while (more())
            line.push_back(read());
        if (word == "else" || word == "endif" || word == "elif") {
            if (conditions_.empty())
                fail(begin, "found #" + std::string(word) + "; expected #if before it");
            if (word == "endif") {
                conditions_.pop_back();
            } else if (word == "else") {
                conditions_.back().holds = !conditions_.back().holds;
            } else {
                fail(begin, "found #elif; expected #if, #ifdef, #else and #endif");
            }
        } else if (word == "if") {
            conditions_.push_back({begin, was_active ? is_true(begin, line) : false});
        } else if (line.empty() || line.front().kind != Kind::name) {
            fail(begin, "found #" + std::string(word) + "; expected a name behind it");
        } else if (word == "define") {
            define(line);
        } else if (word == "undef") {
            macros_.erase(line.front().text);
        } else {
            conditions_.push_back(
                {begin, macros_.contains(line.front().text) == (word == "ifdef")});
        }
    }

    [[nodiscard]] bool is_true(std::size_t begin, const Tokens& line) {
        Tokens value;
        expand(line, value, 0);
        if (value.size() == 1 && value[0].kind == Kind::number)
            return number_of(value[0].text).value != 0;
        if (value.size() == 1 && value[0].kind == Kind::name) return false;  // not defined
        fail(begin, "condition is no number; expected #if 0, #if 1, #if NAME or #ifdef NAME");
    }

    void define(const Tokens& line) {
        const Token& name = line.front();
        Macro macro;
        std::size_t body = 1;
        const std::size_t end = name.begin + name.text.size();
        if (line.size() > 1 && line[1].is("(") && line[1].begin == end) {
            macro.has_arguments = true;
            for (body = 2; body < line.size() && !line[body].is(")"); ++body) {
                if (line[body].is(",")) continue;
                if (line[body].kind != Kind::name)
                    fail(line[body].begin, "found " + printable(line[body].text) +
                                               "; expected the name of an argument");
                macro.arguments.push_back(line[body].text);
            }
            if (body == line.size()) fail(name.begin, "found a macro without ); expected it");
            ++body;
        }
        macro.body.assign(line.begin() + static_cast<std::ptrdiff_t>(body), line.end());
        for (const Token& token : macro.body) {
            if (token.is("#")) fail(token.begin, "found # in a macro; expected none");
        }
        macros_.insert_or_assign(name.text, std::move(macro));
    }

    // -- Macros

    void push(Tokens& to, const Token& token) {
        if (++pushed_ > kMostTokens) {
            fail(token.begin, "macros make more than " + std::to_string(kMostTokens) +
                                  " words of the text; expected at most as many");
        }
        to.push_back(token);
    }

    void expand(const Tokens& from, Tokens& to, int depth) {
        for (std::size_t i = 0; i < from.size(); ++i) {
            const Token& token = from[i];
            const auto found = token.kind == Kind::name ? macros_.find(token.text) : macros_.end();
            const bool is_call =
                found != macros_.end() &&
                (!found->second.has_arguments || (i + 1 < from.size() && from[i + 1].is("(")));
            if (!is_call || open_.contains(token.text)) {
                push(to, token);
                continue;
            }
            if (depth > kDeepestMacro) {
                fail(token.begin, "more than " + std::to_string(kDeepestMacro) +
                                      " macros use each other; expected at most as many");
            }
            const Macro& macro = found->second;
            std::vector<Tokens> arguments;
            if (macro.has_arguments) i = read_arguments(from, i, macro, arguments, depth);
            Tokens body;
            for (Token part : macro.body) {
                part.begin = token.begin;
                const auto argument =
                    part.kind == Kind::name
                        ? std::find(macro.arguments.begin(), macro.arguments.end(), part.text)
                        : macro.arguments.end();
                if (argument == macro.arguments.end()) {
                    push(body, part);
                } else {
                    const auto index = static_cast<std::size_t>(argument - macro.arguments.begin());
                    for (const Token& own : arguments[index])
                        push(body, own);
                }
            }
            open_.insert(token.text);
            expand(body, to, depth + 1);
            open_.erase(token.text);
        }
    }

    /// @returns  the index of the closing bracket
    std::size_t read_arguments(const Tokens& from, std::size_t name, const Macro& macro,
                               std::vector<Tokens>& arguments, int depth) {
        std::vector<Tokens> parts(1);
        int brackets = 0;
        std::size_t i = name + 1;
        for (; i < from.size(); ++i) {
            const Token& token = from[i];
            if (token.is("(") && brackets++ == 0) continue;
            if (token.is(")") && --brackets == 0) break;
            if (token.is(",") && brackets == 1) {
                parts.emplace_back();
            } else {
                parts.back().push_back(token);
            }
        }
        if (parts.size() == 1 && parts[0].empty() && macro.arguments.empty()) parts.clear();
        const std::string own(from[name].text);
        if (i == from.size())
            fail(from[name].begin, "macro " + printable(own) + " has no ); expected it");
        if (parts.size() != macro.arguments.size()) {
            fail(from[name].begin, "macro " + printable(own) + " has " +
                                       std::to_string(parts.size()) + " arguments; expected " +
                                       std::to_string(macro.arguments.size()));
        }
        for (const Tokens& part : parts)
            expand(part, arguments.emplace_back(), depth + 1);
        return i;
    }

    struct Condition {
        std::size_t begin;
        bool holds;
    };

    std::string_view text_;
    std::size_t at_ = 0;
    Tokens result_;
    std::size_t pushed_ = 0;
    std::map<std::string_view, Macro> macros_;
    std::set<std::string_view> open_;  // macros that are being replaced
    std::vector<Condition> conditions_;
};

}  // namespace

std::vector<GlslToken> glsl_tokens(std::string_view text) { return Preprocessor(text).run(); }

TONEWRIGHT_NAMESPACE_END
