// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <span>

#include "base/format_number.h"
#include "tonewright/error.h"
#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// Binding strength, weakest first.
enum Precedence { kSum = 1, kProduct = 2, kUnary = 3, kAtom = 4 };

struct Text {
    std::string text;
    int precedence;
};

std::string bracketed(const Text& t, int needed) {
    return t.precedence < needed ? "(" + t.text + ")" : t.text;
}

Text print(const Expr& e, std::span<const std::string> names) {
    const auto part = [&](int i) { return print(e.operand(i), names); };
    // A right operand of the same strength needs brackets: a-(b-c) is not a-b-c, and even a+(b+c)
    // rounds differently from (a+b)+c.
    const auto binary = [&](const char* sign, int precedence) {
        return Text{bracketed(part(0), precedence) + sign + bracketed(part(1), precedence + 1),
                    precedence};
    };
    const auto call = [&](const char* name) {
        std::string s = std::string(name) + "(";
        for (int i = 0; i < e.operand_count(); ++i)
            s += (i ? ", " : "") + part(i).text;
        return Text{s + ")", kAtom};
    };
    switch (e.op()) {
        case ExprOp::constant: {
            std::string s = shortest(e.value());
            const int precedence = s.front() == '-' ? kUnary : kAtom;
            return {std::move(s), precedence};
        }
        case ExprOp::input: {
            const auto i = static_cast<std::size_t>(e.input_index());
            return {i < names.size() ? names[i] : "x" + std::to_string(i), kAtom};
        }
        case ExprOp::uniform:
            return {e.uniform_name(), kAtom};
        case ExprOp::add:
            return binary(" + ", kSum);
        case ExprOp::subtract:
            return binary(" - ", kSum);
        case ExprOp::multiply:
            return binary("*", kProduct);
        case ExprOp::divide:
            return binary("/", kProduct);
        case ExprOp::negate:
            return {"-" + bracketed(part(0), kUnary), kUnary};
        case ExprOp::minimum:
            return call("min");
        case ExprOp::maximum:
            return call("max");
        case ExprOp::power:
            return call("pow");
        case ExprOp::atan2:
            return call("atan2");
        case ExprOp::less:
            return call("less");
        case ExprOp::less_equal:
            return call("less_equal");
        case ExprOp::equal:
            return call("equal");
        case ExprOp::absolute:
            return call("abs");
        case ExprOp::square_root:
            return call("sqrt");
        case ExprOp::exp2:
            return call("exp2");
        case ExprOp::log2:
            return call("log2");
        case ExprOp::sine:
            return call("sin");
        case ExprOp::cosine:
            return call("cos");
        case ExprOp::floor:
            return call("floor");
        case ExprOp::select:
            return call("select");
        case ExprOp::lookup:
            return {"lookup[" + std::to_string(e.table()->samples.size()) +
                        (e.table()->positions.empty() ? "](" : " uneven](") + part(0).text + ")",
                    kAtom};
        case ExprOp::grid:
            return call(
                ("grid[" + std::to_string(e.grid()->edge()) + "^3]." + "rgb"[e.channel()]).c_str());
    }
    return {"", kAtom};
}

}  // namespace

std::string to_string(const Expr& expr, Span<const std::string> names) {
    if (!names.empty()) return print(expr, names).text;
    if (depends_on(expr, 1) || depends_on(expr, 2)) {
        static const std::array<std::string, 3> rgb = {"r", "g", "b"};
        return print(expr, rgb).text;
    }
    static const std::array<std::string, 1> x = {"x"};
    return print(expr, x).text;
}

TONEWRIGHT_NAMESPACE_END
