// SPDX-License-Identifier: Apache-2.0
#include "expr/interval.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "expr/scalar_ops.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

Interval hull(std::initializer_list<double> values) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Interval r{kInfinity, -kInfinity};
    for (const double v : values) {
        if (std::isnan(v)) return {};
        r = {std::min(r.lo, v), std::max(r.hi, v)};
    }
    return r;
}

/// An infinite end stands for arbitrarily large numbers, so its product with 0 is 0.
double product(double a, double b) { return a == 0 || b == 0 ? 0 : a * b; }

/// @pre the base is at least 0
Interval power_of(const Interval& base, const Interval& exponent) {
    Interval r = hull({std::pow(base.lo, exponent.lo), std::pow(base.lo, exponent.hi),
                       std::pow(base.hi, exponent.lo), std::pow(base.hi, exponent.hi)});
    // The power changes direction where the exponent changes sign: x^0 is 1.
    if (exponent.lo <= 0 && exponent.hi >= 0) r = hull({r.lo, r.hi, 1});
    return r;
}

}  // namespace

Interval interval_of(ExprOp op, const Interval& a, const Interval& b, const Interval& c,
                     const Table* table, const Grid* grid) {
    const auto rising = [&] {
        return hull({scalar_op(op, a.lo, 0, 0, table), scalar_op(op, a.hi, 0, 0, table)});
    };
    switch (op) {
        case ExprOp::constant:
        case ExprOp::input:
        case ExprOp::uniform:
            return {};
        case ExprOp::add:
            return hull({a.lo + b.lo, a.hi + b.hi});
        case ExprOp::subtract:
            return hull({a.lo - b.hi, a.hi - b.lo});
        case ExprOp::multiply:
            return hull({product(a.lo, b.lo), product(a.lo, b.hi), product(a.hi, b.lo),
                         product(a.hi, b.hi)});
        case ExprOp::divide:
            if (b.lo == 0 && b.hi > 0 && a.lo >= 0) return {a.lo / b.hi, Interval{}.hi};
            if (b.lo <= 0 && b.hi >= 0) return {};
            return hull({a.lo / b.lo, a.lo / b.hi, a.hi / b.lo, a.hi / b.hi});
        case ExprOp::minimum:
            return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
        case ExprOp::maximum:
            return {std::max(a.lo, b.lo), std::max(a.hi, b.hi)};
        case ExprOp::power:
            return a.lo < 0 ? Interval{} : power_of(a, b);
        case ExprOp::negate:
            return {-a.hi, -a.lo};
        case ExprOp::absolute:
            return {std::max({a.lo, -a.hi, 0.0}), std::max(std::fabs(a.lo), std::fabs(a.hi))};
        case ExprOp::square_root:
            return a.lo < 0 ? Interval{} : rising();
        case ExprOp::exp2:
        case ExprOp::floor:
            return rising();
        case ExprOp::log2:
            return a.lo < 0 ? Interval{} : rising();
        case ExprOp::less:
        case ExprOp::less_equal:
        case ExprOp::equal:
            return {0, 1};
        case ExprOp::sine:
        case ExprOp::cosine:
            return {-1, 1};
        case ExprOp::select:
            return {std::min(b.lo, c.lo), std::max(b.hi, c.hi)};
        case ExprOp::lookup: {
            const auto [lo, hi] = std::minmax_element(table->samples.begin(), table->samples.end());
            return {*lo, *hi};
        }
        case ExprOp::atan2:
            return {-4, 4};
        case ExprOp::grid: {
            const std::vector<double>& nodes = grid->nodes();
            const auto [lo, hi] = std::minmax_element(nodes.begin(), nodes.end());
            return {*lo, *hi};
        }
    }
    return {};
}

TONEWRIGHT_NAMESPACE_END
