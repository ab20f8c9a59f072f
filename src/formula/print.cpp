// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>

#include "base/format_number.h"
#include "expr/nodes.h"
#include "formula/formula.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// Binding strength, weakest first, as the parser has them.
enum Precedence : unsigned char { kChoice, kEquality, kOrder, kSum, kProduct, kSign, kAtom };

struct Text {
    std::string text;
    Precedence precedence = kAtom;
};

std::string bracketed(const Text& t, Precedence needed) {
    return t.precedence < needed ? "(" + t.text + ")" : t.text;
}

class Printer {
  public:
    Printer(Span<const Expr> exprs, const std::vector<std::string>& inputs)
        : names_(exprs), inputs_(inputs), taken_(inputs.begin(), inputs.end()) {
        const std::vector<Expr> nodes = nodes_of(exprs);
        std::unordered_map<const ExprNode*, int> uses;
        for (const Expr& e : nodes) {
            for (int i = 0; i < e.operand_count(); ++i)
                ++uses[e.operand(i).node()];
            if (e.op() == ExprOp::uniform) take_uniform(e.uniform_name());
        }
        for (const Expr& e : exprs)
            ++uses[e.node()];
        const auto is_value = [&](const Expr& e) {
            return std::any_of(exprs.begin(), exprs.end(),
                               [&](const Expr& value) { return same(value, e); });
        };
        for (const Expr& e : nodes) {
            Text text = print(e);
            // Longer than a line, less what is put around it.
            constexpr std::size_t kLongest = 76;
            const bool is_leaf = e.operand_count() == 0;
            const bool is_long = text.text.size() > kLongest && !is_value(e);
            const bool has_name = names_.of(e) && !is_value(e);
            if (!is_leaf && (uses[e.node()] > 1 || is_long || has_name)) text = set(e, text);
            texts_.emplace(e.node(), std::move(text));
        }
        for (const Expr& e : exprs)
            result_.values.push_back(texts_.at(e.node()).text);
    }

    FormulaText result() { return std::move(result_); }

  private:
    void take_uniform(const std::string& name) {
        const bool is_input = std::find(inputs_.begin(), inputs_.end(), name) != inputs_.end();
        if (is_input || !is_formula_name(name))
            throw Error("parameter " + name + " has a name that no formula can use");
        taken_.insert(name);
    }

    Text set(const Expr& e, const Text& value) {
        const std::string* const wanted = names_.of(e);
        std::string name = wanted ? *wanted : "";
        if (wanted) {
            for (int i = 2; taken_.contains(name) || is_formula_function(name); ++i)
                name = *wanted + "_" + std::to_string(i);
        } else {
            do {
                name = "t" + std::to_string(++count_);
            } while (taken_.contains(name));
        }
        taken_.insert(name);
        result_.temporaries += name + " = " + value.text + "\n";
        return {name};
    }

    Text print(const Expr& e) const {
        const auto part = [&](int i) -> const Text& { return texts_.at(e.operand(i).node()); };
        // a-(b-c) is not a-b-c, and even a+(b+c) rounds differently from (a+b)+c.
        const auto binary = [&](const char* sign, Precedence precedence) {
            const auto stronger = static_cast<Precedence>(precedence + 1);
            return Text{bracketed(part(0), precedence) + sign + bracketed(part(1), stronger),
                        precedence};
        };
        const auto comparison = [&](const char* sign, Precedence precedence) {
            return Text{bracketed(part(0), kSum) + sign + bracketed(part(1), kSum), precedence};
        };
        const auto call = [&](const char* name) {
            std::string s = std::string(name) + "(";
            for (int i = 0; i < e.operand_count(); ++i)
                s += (i ? ", " : "") + part(i).text;
            return Text{s + ")"};
        };
        switch (e.op()) {
            case ExprOp::constant: {
                if (!std::isfinite(e.value()))
                    throw Error("a number of its formulas is not finite");
                std::string s = shortest(e.value());
                const Precedence precedence = s.front() == '-' ? kSign : kAtom;
                return {std::move(s), precedence};
            }
            case ExprOp::input:
                return {inputs_.at(static_cast<std::size_t>(e.input_index()))};
            case ExprOp::uniform:
                return {e.uniform_name()};
            case ExprOp::add:
                return binary(" + ", kSum);
            case ExprOp::subtract:
                return binary(" - ", kSum);
            case ExprOp::multiply:
                return binary("*", kProduct);
            case ExprOp::divide:
                return binary("/", kProduct);
            case ExprOp::negate:
                return {"-" + bracketed(part(0), kAtom), kSign};
            case ExprOp::less:
                return comparison(" < ", kOrder);
            case ExprOp::less_equal:
                return comparison(" <= ", kOrder);
            case ExprOp::equal:
                return comparison(" == ", kEquality);
            case ExprOp::select:
                return {bracketed(part(0), kEquality) + " ? " + bracketed(part(1), kEquality) +
                            " : " + bracketed(part(2), kEquality),
                        kChoice};
            case ExprOp::minimum:
                return call("min");
            case ExprOp::maximum:
                return call("max");
            case ExprOp::power:
                return call("pow");
            case ExprOp::atan2:
                return call("atan2");
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
            case ExprOp::lookup:
                throw Error("it has a table of measured or computed values");
            case ExprOp::grid:
                throw Error("it has a 3D table");
        }
        return {};
    }

    PartNames names_;
    const std::vector<std::string>& inputs_;
    std::set<std::string> taken_;
    std::unordered_map<const ExprNode*, Text> texts_;
    FormulaText result_;
    int count_ = 0;
};

}  // namespace

FormulaText formula_text(Span<const Expr> exprs, const std::vector<std::string>& inputs) {
    return Printer(exprs, inputs).result();
}

std::string whole_formula(const Expr& e, const std::vector<std::string>& inputs) {
    const FormulaText text = formula_text(Span<const Expr>(&e, 1), inputs);
    const std::string& value = text.values.front();
    // No line begins with a sign that could go on with the line before.
    const bool is_sign = !text.temporaries.empty() && value.front() == '-';
    return text.temporaries + (is_sign ? "(" + value + ")" : value);
}

TONEWRIGHT_NAMESPACE_END
