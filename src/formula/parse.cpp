// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "base/strings.h"
#include "formula/characters.h"
#include "formula/formula.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Operands = std::span<const Expr>;

struct Function {
    std::string_view name;
    std::size_t operands;
    Expr (*make)(Operands in);
};

constexpr Function kFunctions[] = {
    {"abs", 1, [](Operands in) { return abs(in[0]); }},
    {"atan2", 2, [](Operands in) { return atan2(in[0], in[1]); }},
    {"clamp", 3, [](Operands in) { return clamp(in[0], in[1], in[2]); }},
    {"cos", 1, [](Operands in) { return cos(in[0]); }},
    {"exp", 1, [](Operands in) { return exp(in[0]); }},
    {"exp2", 1, [](Operands in) { return exp2(in[0]); }},
    {"floor", 1, [](Operands in) { return floor(in[0]); }},
    {"log", 1, [](Operands in) { return log(in[0]); }},
    {"log10", 1, [](Operands in) { return log10(in[0]); }},
    {"log2", 1, [](Operands in) { return log2(in[0]); }},
    {"max", 2, [](Operands in) { return max(in[0], in[1]); }},
    {"min", 2, [](Operands in) { return min(in[0], in[1]); }},
    {"mix", 3, [](Operands in) { return mix(in[0], in[1], in[2]); }},
    {"pow", 2, [](Operands in) { return pow(in[0], in[1]); }},
    {"sin", 1, [](Operands in) { return sin(in[0]); }},
    {"smoothstep", 3, [](Operands in) { return smoothstep(in[0], in[1], in[2]); }},
    {"sqrt", 1, [](Operands in) { return sqrt(in[0]); }},
};

/// Functions of other languages.
struct Spelling {
    std::string_view name;
    std::string_view write;
};
constexpr Spelling kSpellings[] = {
    {"ceil", "-floor(-a)"},     {"fabs", "abs(a)"},
    {"fract", "a - floor(a)"},  {"frac", "a - floor(a)"},
    {"lerp", "mix(a, b, t)"},   {"ln", "log(a)"},
    {"powf", "pow(a, b)"},      {"saturate", "clamp(a, 0, 1)"},
    {"sign", "a < 0 ? -1 : 1"}, {"step", "x < edge ? 0 : 1"},
    {"tan", "sin(a)/cos(a)"},   {"tanh", "1 - 2/(exp(2*a) + 1)"},
};

const Function* find_function(std::string_view name) {
    const auto* const found =
        std::find_if(std::begin(kFunctions), std::end(kFunctions),
                     [&](const Function& function) { return function.name == name; });
    return found == std::end(kFunctions) ? nullptr : found;
}

/// Length of the name that the text begins with; 0 if none.
std::size_t name_length(std::string_view text) {
    std::size_t n = 0;
    while (n < text.size() && is_letter(text[n])) {
        while (n < text.size() && (is_letter(text[n]) || is_digit(text[n])))
            ++n;
        if (n + 1 < text.size() && text[n] == '.' && is_letter(text[n + 1])) ++n;
    }
    return n;
}

enum class Kind : unsigned char { end, line_end, number, name, sign };

struct Token {
    Kind kind = Kind::end;
    std::size_t begin = 0;
    std::string_view text;
};

Precedence precedence_of(const Token& token) {
    return token.kind == Kind::sign ? tonewright::precedence_of(token.text) : kNone;
}

class Parser {
  public:
    Parser(std::string_view text, const FormulaScope& scope) : text_(text), scope_(scope) {
        if (text.size() > kLongestFormula) {
            fail(0, "formula has " + std::to_string(text.size()) + " bytes; expected at most " +
                        std::to_string(kLongestFormula));
        }
        next();
        find_assignments();
    }

    /// @param has_value  the last line is one
    FormulaValue run(bool has_value) {
        while (true) {
            while (token_.kind == Kind::line_end)
                next();
            if (token_.kind == Kind::end) {
                if (!has_value) return {0};
                fail(token_.begin, temporaries_.empty()
                                       ? "formula is empty; expected an expression"
                                       : "formula ends without a value; expected an expression in "
                                         "its last line");
            }
            if (is_assignment()) {
                assign();
                continue;
            }
            const std::size_t begin = token_.begin;
            FormulaValue value = expression(kChoice);
            end_line();
            while (token_.kind == Kind::line_end)
                next();
            if (!has_value) fail(begin, "line is not an assignment; expected name = expression");
            if (token_.kind != Kind::end) {
                fail(begin,
                     "line has no name, and more lines follow it; expected name = expression, and "
                     "one "
                     "value in the last line");
            }
            return value;
        }
    }

    [[nodiscard]] const std::map<std::string, FormulaValue, std::less<>>& temporaries() const {
        return temporaries_;
    }

  private:
    [[noreturn]] void fail(std::size_t offset, const std::string& message) const {
        throw FormulaError(position_at(text_, offset), message);
    }
    [[noreturn]] void expected(const std::string& what) const {
        const std::string found = token_.kind == Kind::end        ? "the end"
                                  : token_.kind == Kind::line_end ? "the end of the line"
                                                                  : printable(token_.text);
        fail(token_.begin, "found " + found + "; expected " + what);
    }
    [[nodiscard]] bool is_sign(std::string_view sign) const {
        return token_.kind == Kind::sign && token_.text == sign;
    }

    // -- Tokens

    void next() { token_ = read(); }

    [[nodiscard]] Token peek() {
        const std::size_t at = at_;
        const Token token = read();
        at_ = at;
        return token;
    }

    Token read() {
        skip_blanks();
        const std::size_t begin = at_;
        if (at_ == text_.size()) return {Kind::end, begin, {}};
        const std::string_view rest = text_.substr(at_);
        const auto take = [&](Kind kind, std::size_t length) {
            at_ += length;
            return Token{kind, begin, rest.substr(0, length)};
        };
        const char c = rest.front();
        if (c == '\n' || c == ';') return take(Kind::line_end, 1);
        if (is_letter(c)) return take(Kind::name, name_length(rest));
        if (is_digit(c) || (c == '.' && rest.size() > 1 && is_digit(rest[1])))
            return take(Kind::number, number_length(rest));
        for (const std::string_view sign :
             {"&&", "||", "==", "!=", "<=", ">=", "**", "+=", "-=", "*=", "/="}) {
            if (rest.substr(0, 2) == sign) return take(Kind::sign, 2);
        }
        if (std::string_view("+-*/<>?:!(),=^%&|[]{}.~").find(c) != std::string_view::npos)
            return take(Kind::sign, 1);
        fail(begin, "found " + first_character_name(rest) +
                        "; expected names, numbers and operators in ASCII");
    }

    void skip_blanks() {
        while (at_ < text_.size()) {
            const char c = text_[at_];
            const bool is_comment = c == '#' || text_.substr(at_, 2) == "//";
            if (is_comment) {
                at_ = std::min(text_.find('\n', at_), text_.size());
            } else if (c == ' ' || c == '\t' || c == '\r' || (c == '\n' && brackets_ > 0)) {
                ++at_;
            } else {
                return;
            }
        }
    }

    // -- Lines

    void find_assignments() {
        const std::size_t at = at_;
        const Token first = token_;
        while (token_.kind != Kind::end) {
            const Token before = token_;
            next();
            if (before.kind == Kind::name && is_sign("=")) set_later_.insert(before.text);
        }
        at_ = at;
        token_ = first;
    }

    [[nodiscard]] bool is_assignment() {
        if (token_.kind != Kind::name) return false;
        const Token after = peek();
        return after.kind == Kind::sign && after.text == "=";
    }

    void assign() {
        const Token name = token_;
        const std::string own(name.text);
        if (name.text.find('.') != std::string_view::npos)
            fail(name.begin, "name is " + printable(own) + "; expected a name without a dot");
        const bool is_input =
            std::find(scope_.inputs.begin(), scope_.inputs.end(), own) != scope_.inputs.end();
        if (is_input || scope_.names.contains(own) || temporaries_.contains(own)) {
            fail(name.begin,
                 "name " + printable(own) + " is set a second time; expected a new name");
        }
        if (find_function(own))
            fail(name.begin, "name " + own + " is a function; expected another name");
        next();
        next();  // =
        FormulaValue value = expression(kChoice);
        end_line();
        value.value = named(own.c_str(), value.value);
        temporaries_.emplace(own, std::move(value));
    }

    void end_line() {
        if (token_.kind == Kind::line_end || token_.kind == Kind::end) return;
        if (is_sign("^") || is_sign("**"))
            fail(token_.begin, "found " + std::string(token_.text) + "; write pow(a, b)");
        if (is_sign("%")) fail(token_.begin, "found %; write a - b*floor(a/b)");
        if (is_sign("=")) fail(token_.begin, "found =; write == to compare");
        if (is_sign("&") || is_sign("|")) {
            const std::string sign(token_.text);
            fail(token_.begin, "found " + sign + "; write " + sign + sign);
        }
        if (token_.kind == Kind::sign && token_.text.size() == 2 && token_.text[1] == '=')
            expected("name = expression, with a new name");
        expected("an operator or the end of the line");
    }

    // -- Expressions

    FormulaValue made(const Token& at, int depth, const Expr& value, int operations = 1) {
        operations_ += operations;
        if (operations_ > kMostOperations) {
            fail(at.begin, "formula has more than " + std::to_string(kMostOperations) +
                               " operations; expected at most as many");
        }
        if (depth + operations > kDeepestFormula) {
            fail(at.begin, "more than " + std::to_string(kDeepestFormula) +
                               " operations depend on each other; expected at most as many");
        }
        if (value.is_constant() && !std::isfinite(value.value())) {
            fail(at.begin, std::string("result is ") +
                               (std::isnan(value.value()) ? "not a number" : "infinite") +
                               " for every input; expected a finite number");
        }
        return {value, depth + operations};
    }

    FormulaValue expression(Precedence weakest) {
        struct Level {
            explicit Level(int& depth) : depth_(depth) { ++depth_; }
            ~Level() { --depth_; }
            Level(const Level&) = delete;
            Level& operator=(const Level&) = delete;
            int& depth_;
        };
        const Level level(nesting_);
        if (nesting_ > kDeepestBrackets) {
            fail(token_.begin, "more than " + std::to_string(kDeepestBrackets) +
                                   " brackets, signs or choices are inside each other; expected "
                                   "temporaries");
        }
        FormulaValue left = prefix();
        while (true) {
            join_lines();
            const Precedence strength = precedence_of(token_);
            if (strength == kNone || strength < weakest) return left;
            left = strength == kChoice ? choice(left) : binary(left, strength);
        }
    }

    /// Skips a line break before an operator that continues the line before it.
    void join_lines() {
        if (token_.kind != Kind::line_end || token_.text == ";") return;
        const std::size_t at = at_;
        const Token end = token_;
        while (token_.kind == Kind::line_end && token_.text != ";")
            next();
        if (is_sign("+") || is_sign("-")) {
            fail(token_.begin, "line begins with " + std::string(token_.text) +
                                   "; expected the operator at the end of the line before, or "
                                   "brackets around the sign");
        }
        if (precedence_of(token_) != kNone || is_sign(":")) return;
        at_ = at;
        token_ = end;
    }

    FormulaValue choice(const FormulaValue& condition) {
        const Token at = token_;
        next();
        const FormulaValue yes = expression(kChoice);
        if (!is_sign(":")) expected("a : after the ?");
        next();
        const FormulaValue no = expression(kChoice);
        return made(at, std::max({condition.depth, yes.depth, no.depth}),
                    select(condition.value, yes.value, no.value));
    }

    FormulaValue binary(const FormulaValue& a, Precedence strength) {
        const Token at = token_;
        next();
        const FormulaValue b = expression(static_cast<Precedence>(strength + 1));
        const int operations = strength <= kAnd ? 3 : at.text == "!=" ? 2 : 1;
        FormulaValue result = made(at, std::max(a.depth, b.depth), joined(at, a, b), operations);
        const Precedence after = precedence_of(token_);
        if (after == strength && (strength == kOrder || strength == kEquality)) {
            fail(token_.begin, "comparisons follow each other; write a < b && b < c, or brackets");
        }
        return result;
    }

    static Expr joined(const Token& at, const FormulaValue& left, const FormulaValue& right) {
        const Expr& a = left.value;
        const Expr& b = right.value;
        const std::string_view sign = at.text;
        if (sign == "+") return a + b;
        if (sign == "-") return a - b;
        if (sign == "*") return a * b;
        if (sign == "/") return a / b;
        if (sign == "<") return less(a, b);
        if (sign == "<=") return less_equal(a, b);
        if (sign == ">") return less(b, a);
        if (sign == ">=") return less_equal(b, a);
        if (sign == "==") return equal(a, b);
        if (sign == "!=") return select(equal(a, b), 0, 1);
        if (sign == "&&") return select(a, truth(b), 0);
        return select(a, 1, truth(b));  // ||
    }

    FormulaValue prefix() {
        while (token_.kind == Kind::line_end && token_.text != ";")
            next();
        const Token at = token_;
        switch (at.kind) {
            case Kind::number:
                next();
                return number(at);
            case Kind::name:
                next();
                return is_sign("(") ? call(at) : FormulaValue(value_named(at));
            case Kind::sign:
                break;
            case Kind::end:
            case Kind::line_end:
                expected("an expression");
        }
        if (is_sign("(")) {
            open();
            FormulaValue inner = expression(kChoice);
            close();
            return inner;
        }
        if (is_sign("-") || is_sign("+") || is_sign("!")) {
            next();
            FormulaValue a = expression(kSign);
            if (at.text == "+") return a;
            return made(at, a.depth, at.text == "-" ? -a.value : select(a.value, 0, 1));
        }
        expected("an expression");
    }

    // Line breaks inside brackets are blanks.
    void open() {
        ++brackets_;
        next();
    }
    void close() {
        if (!is_sign(")")) {
            if (is_sign(",")) expected(")");
            end_line();  // the hints for ^, %, = and so on
            expected(")");
        }
        --brackets_;
        next();
    }

    FormulaValue number(const Token& at) {
        const NumberText number = number_of(at.text);
        if (number.expected)
            fail(at.begin, "number is " + printable(at.text) + "; expected " + number.expected);
        return {number.value};
    }

    FormulaValue value_named(const Token& at) const {
        for (std::size_t i = 0; i < scope_.inputs.size(); ++i) {
            if (scope_.inputs[i] == at.text) return {Expr::input(static_cast<int>(i))};
        }
        for (const auto* names : {&scope_.names, &temporaries_}) {
            if (const auto found = names->find(at.text); found != names->end())
                return found->second;
        }
        const std::string name = printable(at.text);
        if (find_function(at.text))
            fail(at.begin, "function " + name + " has no operands; expected (");
        if (set_later_.contains(at.text)) {
            fail(at.begin, "name " + name +
                               " is used before it has a value; expected the line that sets it "
                               "above, without a cycle");
        }
        std::vector<std::string> known = scope_.inputs;
        for (const auto* names : {&scope_.names, &temporaries_}) {
            for (const auto& [own, value] : *names)
                known.push_back(own);
        }
        // One letter is as near to any other.
        const std::string hint = name.size() < 3 ? "" : did_you_mean(at.text, known);
        if (known.size() > 12) known.resize(12), known.emplace_back("others");
        fail(at.begin, "name is " + name + "; expected " + join_choices(known) + hint);
    }

    FormulaValue call(const Token& at) {
        const Function* function = find_function(at.text);
        if (!function) {
            const std::string name = printable(at.text);
            for (const Spelling& other : kSpellings) {
                if (other.name == at.text)
                    fail(at.begin, "function is " + name + "; write " + std::string(other.write));
            }
            std::vector<std::string> known;
            for (const Function& f : kFunctions)
                known.emplace_back(f.name);
            fail(at.begin, "function is " + name + "; expected " + join_choices(known) +
                               did_you_mean(at.text, known));
        }
        open();
        std::vector<Expr> operands;
        int depth = 1;
        bool has_more = !is_sign(")");
        while (has_more && operands.size() < function->operands) {
            const FormulaValue operand = expression(kChoice);
            operands.push_back(operand.value);
            depth = std::max(depth, operand.depth);
            has_more = is_sign(",");
            if (has_more) next();
        }
        if (has_more || (is_sign(")") && operands.size() < function->operands)) {
            const std::string wanted = std::to_string(function->operands);
            fail(at.begin,
                 "function " + std::string(function->name) + " has " +
                     (has_more ? "more than " + wanted : std::to_string(operands.size())) +
                     (operands.size() == 1 ? " operand" : " operands") + "; expected " + wanted);
        }
        close();
        // smoothstep has the most operations: ten.
        return made(at, depth, function->make(operands), function->operands == 3 ? 10 : 2);
    }

    std::string_view text_;
    const FormulaScope& scope_;
    std::map<std::string, FormulaValue, std::less<>> temporaries_;
    std::set<std::string_view> set_later_;
    std::size_t at_ = 0;
    Token token_;
    int brackets_ = 0;
    int nesting_ = 0;
    int operations_ = 0;
};

}  // namespace

TextPosition position_at(std::string_view text, std::size_t offset) {
    const std::string_view before = text.substr(0, offset);
    const std::size_t line_begin = before.rfind('\n') + 1;  // npos + 1 is 0
    const auto lines = std::count(before.begin(), before.end(), '\n');
    const auto characters = std::count_if(before.begin() + static_cast<std::ptrdiff_t>(line_begin),
                                          before.end(), [](char c) { return !is_continuation(c); });
    return {static_cast<std::size_t>(lines) + 1, static_cast<std::size_t>(characters) + 1};
}

std::string caret_lines(std::string_view text, TextPosition at) {
    std::size_t begin = 0;
    for (std::size_t line = 1; line < at.line; ++line) {
        const std::size_t end = text.find('\n', begin);
        if (end == std::string_view::npos) return "";
        begin = end + 1;
    }
    // The part of a long line that is shown: as a terminal has room for.
    constexpr std::size_t kBefore = 50;
    constexpr std::size_t kWidth = 76;
    const std::size_t first = at.column > kBefore ? at.column - kBefore : 0;
    std::string shown;
    std::size_t column = 0;
    for (std::size_t i = begin; i < text.size() && text[i] != '\n' && text[i] != '\r'; ++i) {
        if (is_continuation(text[i])) continue;
        if (++column <= first) continue;
        if (shown.size() == kWidth) break;
        const char c = text[i] == '\t' ? ' ' : text[i];
        shown += c >= ' ' && c <= '~' ? c : '?';
    }
    return "  " + shown + "\n  " + std::string(std::max(at.column, first + 1) - first - 1, ' ') +
           "^";
}

Expr parse_formula(std::string_view text, const FormulaScope& scope) {
    return Parser(text, scope).run(true).value;
}

void parse_temporaries(std::string_view text, FormulaScope& scope) {
    Parser parser(text, scope);
    (void)parser.run(false);
    scope.names.insert(parser.temporaries().begin(), parser.temporaries().end());
}

bool is_formula_name(std::string_view text) {
    return !text.empty() && name_length(text) == text.size() &&
           text.find('.') == std::string_view::npos;
}

bool is_formula_function(std::string_view name) { return find_function(name) != nullptr; }

TONEWRIGHT_NAMESPACE_END
