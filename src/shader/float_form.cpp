// SPDX-License-Identifier: Apache-2.0
#include "shader/float_form.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The smallest float that no processor flushes to 0.
constexpr double kSmallest = static_cast<double>(std::numeric_limits<float>::min());
/// Lower limit of denominators: quotients stay finite for numerators up to 65504 and far beyond.
constexpr double kSmallestDivisor = 1e-30;
/// Upper limit of powers, so that products with them stay finite.
constexpr double kLargest = 1e30;
/// Smaller powers of kSmallest count as 0.
constexpr double kNothing = 1e-9;

/// 1 - 2^a. Near 0, where 1 - 2^a cancels, uses the series of 1 - e^t; above a quarter its seventh
/// term is 1e-8 of the sum.
Expr one_minus_exp2(const Expr& a) {
    constexpr double kNear = 0.25;
    const Expr t = named("t", a * std::numbers::ln2);
    Expr sum = 1;
    for (int n = 7; n >= 2; --n)
        sum = 1 + t * (1.0 / n) * sum;
    return select(less(abs(t), kNear), -t * named("series", sum), 1 - exp2(a));
}

/// x^n by multiplication.
Expr whole_power(const Expr& x, int n) {
    if (n == 1) return x;
    const Expr half = whole_power(x, n / 2);
    return n % 2 == 0 ? half * half : half * half * x;
}

}  // namespace

FloatForm::FloatForm(std::vector<Interval> inputs, UniformRanges uniforms)
    : inputs_(std::move(inputs)), uniforms_(std::move(uniforms)) {}

Interval FloatForm::range(const Expr& e) {
    switch (e.op()) {
        case ExprOp::constant:
            return {e.value(), e.value()};
        case ExprOp::input:
            return inputs_.at(static_cast<std::size_t>(e.input_index()));
        case ExprOp::uniform:
            return uniforms_.find(e.uniform_name())->second;
        default:
            break;
    }
    if (const auto known = range_.find(e.node()); known != range_.end()) return known->second;
    const auto of = [&](int i) { return i < e.operand_count() ? range(e.operand(i)) : Interval{}; };
    Interval a = of(0);
    // Powers of a negative base are not computed.
    if (e.op() == ExprOp::power) a = {std::max(a.lo, 0.0), std::max(a.hi, 0.0)};
    Interval r =
        interval_of(e.op(), a, of(1), of(2), e.op() == ExprOp::lookup ? e.table().get() : nullptr,
                    e.op() == ExprOp::grid ? e.grid().get() : nullptr);
    const bool is_square = e.op() == ExprOp::multiply && same(e.operand(0), e.operand(1));
    if (is_square) r.lo = std::max(r.lo, 0.0);
    keep_.push_back(e);
    range_.emplace(e.node(), r);
    return r;
}

Expr FloatForm::operator()(const Expr& e) {
    names_.take(e);
    const Expr result = rewritten(PartNames().on(e));
    return names_.on(result);
}

Expr FloatForm::rewritten(const Expr& e) {
    if (e.operand_count() == 0) return e;
    if (const auto known = rewritten_.find(e.node()); known != rewritten_.end())
        return known->second;
    const Expr named_result = rewrite(e);
    names_.take(named_result);
    Expr result = PartNames().on(named_result);
    names_.move(e, result);
    keep_.push_back(e);
    rewritten_.emplace(e.node(), result);
    return result;
}

Expr FloatForm::rewrite(const Expr& e) {
    const auto part = [&](int i) { return rewritten(e.operand(i)); };
    switch (e.op()) {
        case ExprOp::power:
            return power(part(0), part(1));
        case ExprOp::divide:
            return quotient(part(0), part(1));
        case ExprOp::square_root: {
            const Expr a = part(0);
            return sqrt(range(a).lo < 0 ? max(a, 0) : a);
        }
        case ExprOp::log2: {
            const Expr a = part(0);
            return log2(range(a).lo < kSmallest ? max(a, kSmallest) : a);
        }
        case ExprOp::exp2: {
            const Expr a = part(0);
            const double largest = std::log2(kLargest);
            return exp2(range(a).hi > largest ? min(a, largest) : a);
        }
        case ExprOp::atan2: {
            const Expr y = part(0);
            const Expr x = part(1);
            const bool is_apart = range(x).lo > 0 || range(x).hi < 0;
            return atan2(y, is_apart ? x : select(equal(abs(x) + abs(y), 0), 1, x));
        }
        case ExprOp::subtract:
            if (e.operand(0).is_constant(1) && e.operand(1).op() == ExprOp::exp2)
                return one_minus_exp2((*this)(e.operand(1)).operand(0));
            return part(0) - part(1);
        case ExprOp::grid:
            return interpolate(e.grid(), e.channel(), part(0), part(1), part(2));
        default: {
            std::vector<Expr> parts;
            parts.reserve(static_cast<std::size_t>(e.operand_count()));
            for (int i = 0; i < e.operand_count(); ++i)
                parts.push_back(part(i));
            return make_expr(e.op(), parts, e.op() == ExprOp::lookup ? e.table() : nullptr);
        }
    }
}

Expr FloatForm::power(const Expr& base, const Expr& exponent) {
    if (exponent.is_constant()) {
        const double y = exponent.value();
        if (y == std::round(y) && y >= 1 && y <= 8) return whole_power(base, static_cast<int>(y));
        if (y == 0.5) return sqrt(range(base).lo < 0 ? max(base, 0) : base);
    }
    const Interval x = range(base);
    const Interval y = range(exponent);
    // Limits of the base: no denormals, and no power above kLargest.
    double lo = kSmallest;
    double hi = 3e38;
    if (y.lo < 0) lo = std::max(lo, std::pow(kLargest, 1 / y.lo));
    if (y.hi > 0) hi = std::min(hi, std::pow(kLargest, 1 / y.hi));
    Expr limited = base;
    if (x.lo < lo) limited = max(limited, lo);
    if (x.hi > hi) limited = min(limited, hi);
    Expr result = pow(limited, exponent);
    const bool vanishes = y.lo > 0 && std::pow(lo, y.lo) <= kNothing;
    if (x.lo >= lo || vanishes || y.hi < 0) return result;
    // At 0: 0, but x^0 is 1.
    return select(less(0, base), result, y.lo <= 0 ? equal(exponent, 0) : Expr(0));
}

Expr FloatForm::quotient(const Expr& a, const Expr& b) {
    const Interval divisor = range(b);
    if (divisor.lo >= kSmallestDivisor || divisor.hi <= -kSmallestDivisor) return a / b;
    if (divisor.lo >= 0) return a / max(b, kSmallestDivisor);
    if (divisor.hi <= 0) return a / min(b, -kSmallestDivisor);
    return a / select(less(abs(b), kSmallestDivisor), kSmallestDivisor, b);
}

Interval range_over(const Expr& f, const Interval& input, const UniformRanges& uniforms) {
    constexpr int kPieces = 64;
    // Positions at equal distances on an axis that is linear near 0 and logarithmic beyond.
    constexpr double kToe = 1e-3;
    const auto over = [&](const Interval& piece) {
        FloatForm form({piece}, uniforms);
        return form.range(form(f));
    };
    const auto bent = [](double x) { return std::asinh(x / kToe); };
    const double lo = bent(input.lo);
    const double hi = bent(input.hi);
    if (!std::isfinite(lo) || !std::isfinite(hi)) return over(input);
    Interval result{kInfinity, -kInfinity};
    double begin = input.lo;
    for (int i = 1; i <= kPieces; ++i) {
        const double end = i == kPieces ? input.hi : kToe * std::sinh(lo + (hi - lo) * i / kPieces);
        const Interval piece = over({begin, end});
        result = {std::min(result.lo, piece.lo), std::max(result.hi, piece.hi)};
        begin = end;
    }
    return result;
}

TONEWRIGHT_NAMESPACE_END
