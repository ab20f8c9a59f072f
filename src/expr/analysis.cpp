// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <unordered_map>
#include <unordered_set>

#include "base/format_number.h"
#include "expr/node.h"
#include "expr/nodes.h"
#include "expr/scalar_ops.h"
#include "tonewright/error.h"
#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Rebuilt = std::unordered_map<const ExprNode*, Expr>;

/// Rebuilds an expression bottom-up, each shared node once.
template <class Leaf>
Expr rebuild(const Expr& e, const Leaf& leaf, Rebuilt& done) {
    if (auto it = done.find(e.node()); it != done.end()) return it->second;
    Expr result = e;
    if (e.op() == ExprOp::input || e.op() == ExprOp::uniform) {
        result = leaf(e);
    } else if (!e.is_constant()) {
        std::vector<Expr> operands;
        operands.reserve(static_cast<std::size_t>(e.operand_count()));
        for (int i = 0; i < e.operand_count(); ++i) {
            operands.push_back(rebuild(e.operand(i), leaf, done));
        }
        result = e.op() == ExprOp::grid
                     ? interpolate(e.grid(), e.channel(), operands[0], operands[1], operands[2])
                     : make_expr(e.op(), operands, e.table());
    }
    done.emplace(e.node(), result);
    return result;
}

/// @param leaf   gives an expression without names for an input or a uniform
/// @param names  of what leaf() gives; those of the expression are added
template <class Leaf>
Expr rebuild(const Expr& e, const Leaf& leaf, PartNames names) {
    Rebuilt done;
    const Expr result = rebuild(PartNames().on(e), leaf, done);
    const PartNames own(Span<const Expr>(&e, 1));
    for (const auto& [part, name] : own.all()) {
        const auto found = done.find(part.node());
        if (found == done.end() || same(found->second, part)) {
            names.add(name, part);
        } else if (!names.of(found->second)) {
            names.add(name, found->second);
        }
    }
    return names.on(result);
}

double evaluate_node(const Expr& e, std::span<const double> inputs,
                     std::unordered_map<const ExprNode*, double>& done) {
    if (e.is_constant()) return e.value();
    if (e.op() == ExprOp::input) return inputs[static_cast<std::size_t>(e.input_index())];
    if (e.op() == ExprOp::uniform)
        throw Error("expression: " + e.uniform_name() +
                    " has no value; expected bind_uniforms() before");
    if (auto it = done.find(e.node()); it != done.end()) return it->second;
    std::array<double, 3> v{};
    for (int i = 0; i < e.operand_count(); ++i) {
        v[static_cast<std::size_t>(i)] = evaluate_node(e.operand(i), inputs, done);
    }
    const double result = e.op() == ExprOp::grid
                              ? (*e.grid())(e.channel(), v[0], v[1], v[2])
                              : scalar_op(e.op(), v[0], v[1], v[2], e.table().get());
    done.emplace(e.node(), result);
    return result;
}

Expr differentiate(const Expr& e, int index, std::unordered_map<const ExprNode*, Expr>& done) {
    if (e.is_constant() || e.op() == ExprOp::uniform) return 0;
    if (e.op() == ExprOp::input) return e.input_index() == index ? 1 : 0;
    if (auto it = done.find(e.node()); it != done.end()) return it->second;
    const auto u = [&] { return e.operand(0); };
    const auto v = [&] { return e.operand(1); };
    const auto d = [&](int i) { return differentiate(e.operand(i), index, done); };
    Expr result = 0;
    switch (e.op()) {
        case ExprOp::add:
            result = d(0) + d(1);
            break;
        case ExprOp::subtract:
            result = d(0) - d(1);
            break;
        case ExprOp::multiply:
            result = d(0) * v() + u() * d(1);
            break;
        case ExprOp::divide: {
            const Expr du = d(0);
            const Expr dv = d(1);
            result = dv.is_constant(0) ? du / v() : (du * v() - u() * dv) / (v() * v());
            break;
        }
        case ExprOp::negate:
            result = -d(0);
            break;
        case ExprOp::minimum:
            result = select(less(v(), u()), d(1), d(0));
            break;
        case ExprOp::maximum:
            result = select(less(u(), v()), d(1), d(0));
            break;
        case ExprOp::absolute:
            result = select(less(u(), 0), -d(0), d(0));
            break;
        case ExprOp::square_root:
            result = d(0) / (2 * e);
            break;
        case ExprOp::exp2:
            result = e * std::numbers::ln2 * d(0);
            break;
        case ExprOp::log2:
            result = d(0) / (u() * std::numbers::ln2);
            break;
        case ExprOp::power: {
            const Expr du = d(0);
            const Expr dv = d(1);
            result = v() * pow(u(), v() - 1) * du;
            if (!dv.is_constant(0)) result = result + e * log(u()) * dv;
            break;
        }
        case ExprOp::sine:
            result = cos(u()) * d(0);
            break;
        case ExprOp::cosine:
            result = -(sin(u()) * d(0));
            break;
        case ExprOp::atan2:
            result = (v() * d(0) - u() * d(1)) / (u() * u() + v() * v());
            break;
        case ExprOp::select: {
            result = select(u(), d(1), d(2));
            break;
        }
        case ExprOp::lookup: {
            const Table& table = *e.table();
            if (table.interpolation == Table::Interpolation::linear && table.samples.size() > 1) {
                auto slope = std::make_shared<Table>();
                slope->interpolation = Table::Interpolation::step;
                const std::vector<double>& at = table.positions;
                const std::size_t n = table.samples.size() - 1;
                for (std::size_t i = 0; i < n; ++i) {
                    const double rise = table.samples[i + 1] - table.samples[i];
                    slope->samples.push_back(at.empty() ? rise * static_cast<double>(n)
                                                        : rise / (at[i + 1] - at[i]));
                    if (!at.empty()) slope->positions.push_back(at[i]);
                }
                const double first = at.empty() ? 0 : at.front();
                const double last = at.empty() ? 1 : at.back();
                const Expr inside = less_equal(first, u()) * less_equal(u(), last);
                result = select(inside, lookup(std::move(slope), u()), 0) * d(0);
            }
            break;
        }
        case ExprOp::grid:
            throw Error("derivative: a grid has no derivative expression");
        case ExprOp::floor:
        case ExprOp::less:
        case ExprOp::less_equal:
        case ExprOp::equal:
        case ExprOp::constant:
        case ExprOp::input:
        case ExprOp::uniform:
            break;
    }
    done.emplace(e.node(), result);
    return result;
}

void collect(const Expr& e, std::unordered_set<const ExprNode*>& seen, std::vector<Expr>& order) {
    if (!seen.insert(e.node()).second) return;
    for (int i = 0; i < e.operand_count(); ++i)
        collect(e.operand(i), seen, order);
    order.push_back(e);
}

/// The x in [lo, hi] where f changes sign, to neighboring doubles.
double sign_change(const Expr& f, double lo, double hi) {
    const bool below = evaluate(f, lo) < 0;
    while (true) {
        const double middle = lo + (hi - lo) / 2;
        if (!(middle > lo && middle < hi)) return hi;
        ((evaluate(f, middle) < 0) == below ? lo : hi) = middle;
    }
}

}  // namespace

Expr substitute(const Expr& expr, Span<const Expr> inputs) {
    return rebuild(
        expr,
        [&](const Expr& leaf) {
            if (leaf.op() == ExprOp::uniform) return leaf;
            const auto i = static_cast<std::size_t>(leaf.input_index());
            return i < inputs.size() ? PartNames().on(inputs[i]) : leaf;
        },
        PartNames(inputs));
}

Expr bind_uniforms(const Expr& expr, const UniformValues& values) {
    return rebuild(
        expr,
        [&](const Expr& leaf) -> Expr {
            if (leaf.op() == ExprOp::input) return leaf;
            const auto found = values.find(leaf.uniform_name());
            return found == values.end() ? leaf : Expr(found->second);
        },
        PartNames());
}

std::vector<Expr> nodes_of(Span<const Expr> exprs) {
    std::unordered_set<const ExprNode*> seen;
    std::vector<Expr> order;
    for (const Expr& e : exprs)
        collect(e, seen, order);
    return order;
}

std::vector<std::string> uniforms_of(Span<const Expr> exprs) {
    std::vector<std::string> names;
    for (const Expr& e : nodes_of(exprs)) {
        if (e.op() == ExprOp::uniform) names.push_back(e.uniform_name());
    }
    std::sort(names.begin(), names.end());
    return names;
}

double evaluate(const Expr& expr, Span<const double> inputs) {
    std::unordered_map<const ExprNode*, double> done;
    return evaluate_node(expr, inputs, done);
}

double evaluate(const Expr& expr, double input) {
    return evaluate(expr, Span<const double>(&input, 1));
}

Expr derivative(const Expr& expr, int index) {
    std::unordered_map<const ExprNode*, Expr> done;
    return differentiate(expr, index, done);
}

std::size_t node_count(Span<const Expr> exprs) { return nodes_of(exprs).size(); }

bool depends_on(const Expr& expr, int index) {
    std::unordered_set<const ExprNode*> seen;
    std::vector<Expr> order;
    collect(expr, seen, order);
    return std::any_of(order.begin(), order.end(), [&](const Expr& e) {
        return e.op() == ExprOp::input && e.input_index() == index;
    });
}

double inverse_at(const Expr& f, double y, double lo, double hi) {
    const double f_lo = evaluate(f, lo);
    const double f_hi = evaluate(f, hi);
    const bool rising = f_hi >= f_lo;
    if (!(std::isfinite(f_lo) && std::isfinite(f_hi)) || !(lo < hi)) {
        throw Error("inverse: domain is [" + shortest(lo) + ", " + shortest(hi) +
                    "]; expected an interval where the curve is finite");
    }
    if (!(y >= std::min(f_lo, f_hi) && y <= std::max(f_lo, f_hi))) {
        throw Error("inverse: y is " + shortest(y) + "; expected [" +
                    shortest(std::min(f_lo, f_hi)) + ", " + shortest(std::max(f_lo, f_hi)) + "]");
    }
    const Expr slope = derivative(f);
    double x = lo + (hi - lo) / 2;
    // 2100 halvings cover the range of double; Newton needs a few.
    for (int i = 0; i < 2100; ++i) {
        const double value = evaluate(f, x);
        if (value == y) return x;
        ((value < y) == rising ? lo : hi) = x;
        const double newton = x - (value - y) / evaluate(slope, x);
        const double middle = lo + (hi - lo) / 2;
        // Every third step halves, so that a flat curve cannot stall the search.
        x = (newton > lo && newton < hi && i % 3 != 2) ? newton : middle;
        if (!(middle > lo && middle < hi)) break;
    }
    return std::fabs(evaluate(f, lo) - y) <= std::fabs(evaluate(f, hi) - y) ? lo : hi;
}

std::vector<double> kinks(const Expr& f, double lo, double hi) {
    std::unordered_set<const ExprNode*> seen;
    std::vector<Expr> order;
    collect(f, seen, order);
    std::vector<double> found;
    constexpr int kSteps = 4096;
    for (const Expr& e : order) {
        Expr switching = 0;
        switch (e.op()) {
            case ExprOp::minimum:
            case ExprOp::maximum:
            case ExprOp::less:
            case ExprOp::less_equal:
                switching = e.operand(0) - e.operand(1);
                break;
            case ExprOp::absolute:
                switching = e.operand(0);
                break;
            default:
                continue;
        }
        double left = lo;
        double at_left = evaluate(switching, left);
        for (int i = 1; i <= kSteps; ++i) {
            // Squared steps: more of them near lo, where tone curves have their toe.
            const double t = static_cast<double>(i) / kSteps;
            const double right = i == kSteps ? hi : lo + (hi - lo) * t * t;
            const double at_right = evaluate(switching, right);
            if ((at_left < 0) != (at_right < 0))
                found.push_back(sign_change(switching, left, right));
            left = right;
            at_left = at_right;
        }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    std::erase_if(found, [&](double x) { return !(x > lo && x < hi); });
    return found;
}

TONEWRIGHT_NAMESPACE_END
