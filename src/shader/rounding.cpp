// SPDX-License-Identifier: Apache-2.0
#include "shader/rounding.h"

#include <algorithm>
#include <cmath>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

double largest(const Interval& x) { return std::max(std::fabs(x.lo), std::fabs(x.hi)); }

/// For log2(a), whose value is at most this large.
double error_of_log2(const Interval& a, double value) {
    const double relative = 3 * 2 * kHalfUlp * value;
    return a.lo <= 2 && a.hi >= 0.5 ? std::max(relative, 0x1p-21) : relative;
}

}  // namespace

Rounding rounding_of(ExprOp op, double value, const Interval& a, const Interval& b) {
    const double once = std::fabs(value) * kHalfUlp;
    const double ulp = 2 * once;
    switch (op) {
        case ExprOp::constant:
        case ExprOp::add:
        case ExprOp::subtract:
        case ExprOp::multiply:
            return {once, once};
        case ExprOp::divide:
            return {once, 2.5 * ulp};
        case ExprOp::square_root:  // 1 / inversesqrt(x): 2 ULP, and the division
            return {once, 4.5 * ulp};
        case ExprOp::exp2:
            return {once, (3 + 2 * largest(a)) * ulp};
        case ExprOp::log2:
            return {once, error_of_log2(a, std::fabs(value))};
        case ExprOp::power: {  // exp2(y * log2(x))
            const double logarithm =
                a.hi > 0 ? largest({a.lo > 0 ? std::log2(a.lo) : 0, std::log2(a.hi)}) : 0;
            const double exponent = largest(b) * logarithm;
            const double of_exponent =
                largest(b) * error_of_log2(a, logarithm) + exponent * kHalfUlp;
            return {once,
                    (3 + 2 * exponent) * ulp + std::fabs(value) * (std::exp2(of_exponent) - 1)};
        }
        case ExprOp::sine:
        case ExprOp::cosine:  // within [-pi, pi]
            return {once, 0x1p-11};
        case ExprOp::atan2:
            return {once, 4096 * ulp};
        case ExprOp::lookup:  // the place, the difference of samples, the product, the sum
            return {3 * once, 3 * once};
        case ExprOp::grid:  // nodes, weights, and a sum of four products
            return {4 * once, 4 * once};
        default:  // the result is one of the operands, or a whole number
            return {};
    }
}

TONEWRIGHT_NAMESPACE_END
