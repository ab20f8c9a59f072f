// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <iterator>

#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct ScalarOperation {
    const char* name;
    int operands;
};
/// In the order of ExprOp.
inline constexpr ScalarOperation kScalarOperations[] = {
    {"constant", 0},    {"input", 0},      {"add", 2},     {"subtract", 2}, {"multiply", 2},
    {"divide", 2},      {"minimum", 2},    {"maximum", 2}, {"power", 2},    {"atan2", 2},
    {"less", 2},        {"less_equal", 2}, {"equal", 2},   {"negate", 1},   {"absolute", 1},
    {"square_root", 1}, {"exp2", 1},       {"log2", 1},    {"sine", 1},     {"cosine", 1},
    {"floor", 1},       {"select", 3},     {"lookup", 1},  {"grid", 3},     {"uniform", 0}};
static_assert(std::size(kScalarOperations) == static_cast<std::size_t>(ExprOp::uniform) + 1);

[[nodiscard]] constexpr const char* name_of(ExprOp op) noexcept {
    return kScalarOperations[static_cast<std::size_t>(op)].name;
}
[[nodiscard]] constexpr int operand_count(ExprOp op) noexcept {
    return kScalarOperations[static_cast<std::size_t>(op)].operands;
}

/// Defines each operation in double; Grid::operator() defines its own. Constant folding,
/// evaluate() and the reference engine use it.
inline double scalar_op(ExprOp op, double a, double b, double c, const Table* table) noexcept {
    switch (op) {
        case ExprOp::add:
            return a + b;
        case ExprOp::subtract:
            return a - b;
        case ExprOp::multiply:
            return a * b;
        case ExprOp::divide:
            return a / b;
        case ExprOp::minimum:
            return b < a ? b : a;
        case ExprOp::maximum:
            return a < b ? b : a;
        case ExprOp::power:
            return std::pow(a, b);
        case ExprOp::atan2:
            return std::atan2(a, b);
        case ExprOp::less:
            return a < b ? 1.0 : 0.0;
        case ExprOp::less_equal:
            return a <= b ? 1.0 : 0.0;
        case ExprOp::equal:
            return a == b ? 1.0 : 0.0;
        case ExprOp::negate:
            return -a;
        case ExprOp::absolute:
            return std::fabs(a);
        case ExprOp::square_root:
            return std::sqrt(a);
        case ExprOp::exp2:
            return std::exp2(a);
        case ExprOp::log2:
            return std::log2(a);
        case ExprOp::sine:
            return std::sin(a);
        case ExprOp::cosine:
            return std::cos(a);
        case ExprOp::floor:
            return std::floor(a);
        case ExprOp::select:
            return a != 0 ? b : c;
        case ExprOp::lookup:
            return (*table)(a);
        case ExprOp::constant:
        case ExprOp::input:
        case ExprOp::uniform:
        case ExprOp::grid:
            break;
    }
    return a;
}

TONEWRIGHT_NAMESPACE_END
