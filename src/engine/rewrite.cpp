// SPDX-License-Identifier: Apache-2.0
#include "engine/rewrite.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "expr/interval.h"
#include "expr/scalar_ops.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace {

constexpr std::int64_t kNone = -1;

/// The tape's code with each expression of uniforms and constants folded to one uniform.
std::vector<TapeInstruction> fold_uniform_expressions(const Tape& tape) {
    std::vector<TapeInstruction> code = tape.code();
    const auto range = [&](std::uint32_t i) {
        const TapeInstruction& step = code[i];
        return step.op == ExprOp::uniform ? Interval{step.least, step.most}
                                          : Interval{step.value, step.value};
    };
    for (std::uint32_t i = 0; i < code.size(); ++i) {
        TapeInstruction& step = code[i];
        step.source = i;
        // A product with the reciprocal replaces the division, as add() does it for constants.
        if (step.op == ExprOp::divide && !tape.is_number(i) && code[step.b].op == ExprOp::uniform) {
            step.op = ExprOp::multiply;
            step.b = tape.reciprocal(step.b);
        }
        if (!tape.is_number(i) || operand_count(step.op) == 0) continue;
        step.value = scalar_op(step.op, code[step.a].value, code[step.b].value, code[step.c].value,
                               step.table);
        const std::vector<std::uint32_t> read = operands_of(step);
        if (std::none_of(read.begin(), read.end(), [&](std::uint32_t operand) {
                return code[operand].op == ExprOp::uniform;
            })) {
            continue;
        }
        const Interval values =
            interval_of(step.op, range(step.a), range(step.b), range(step.c), step.table, nullptr);
        step.op = ExprOp::uniform;
        step.least = values.lo;
        step.most = values.hi;
    }
    return code;
}

}  // namespace

FloatTape::FloatTape(const Tape& tape) {
    const std::vector<TapeInstruction> code = fold_uniform_expressions(tape);
    std::vector<std::int64_t> moved(code.size(), kNone);  // old index -> new one
    const auto find = [&](std::uint32_t i) {
        if (moved[i] == kNone) moved[i] = add(code[i]);  // adds a uniform where it is first read
        return static_cast<std::uint32_t>(moved[i]);
    };
    for (std::uint32_t i = 0; i < code.size(); ++i) {
        TapeInstruction step = code[i];
        if (step.op == ExprOp::uniform) continue;
        const std::array<std::uint32_t*, 3> operands = {&step.a, &step.b, &step.c};
        for (int k = 0; k < operand_count(step.op); ++k) {
            std::uint32_t& operand = *operands[static_cast<std::size_t>(k)];
            operand = find(operand);
        }
        moved[i] = add(step);
    }
    for (std::size_t i = 0; i < 3; ++i)
        outputs_[i] = find(tape.outputs()[i]);
}

std::uint32_t FloatTape::add(const TapeInstruction& step) {
    if (step.op == ExprOp::constant) return constant(step.value);
    if (step.op == ExprOp::divide && is_constant(step.b)) {
        const double reciprocal = 1 / code_[step.b].value;
        if (std::isnormal(reciprocal)) {
            return push(ExprOp::multiply, step.a, constant(reciprocal));
        }
    }
    if (step.op == ExprOp::select && is_scale_of_positive(step)) {
        TapeInstruction scale = step;
        scale.b = push(ExprOp::divide, constant(1), code_[code_[step.b].a].b);
        code_.push_back(scale);
        return last();
    }
    if (step.op == ExprOp::power && is_constant(step.b)) {
        const double y = code_[step.b].value;
        if (y == 0.5) return push(ExprOp::square_root, step.a);
        if (y == std::floor(y) && std::fabs(y) >= 1 && std::fabs(y) <= 8) {
            const std::uint32_t power = whole_power(step.a, static_cast<unsigned>(std::fabs(y)));
            return y > 0 ? power : push(ExprOp::divide, constant(1), power);
        }
    }
    code_.push_back(step);
    return last();
}

/// True for a select of f(y) / y under the condition y > 0, with f(y) = y / g: Reinhard by
/// luminance.
bool FloatTape::is_scale_of_positive(const TapeInstruction& select) const {
    const TapeInstruction& condition = code_[select.a];
    const TapeInstruction& scale = code_[select.b];
    const TapeInstruction& mapped = code_[scale.a];
    return condition.op == ExprOp::less && is_constant(condition.a) &&
           code_[condition.a].value >= 0 && scale.op == ExprOp::divide && scale.b == condition.b &&
           mapped.op == ExprOp::divide && mapped.a == condition.b;
}

std::uint32_t FloatTape::whole_power(std::uint32_t x, unsigned n) {
    if (n == 1) return x;
    const std::uint32_t half = whole_power(x, n / 2);
    const std::uint32_t even = push(ExprOp::multiply, half, half);
    return n % 2 ? push(ExprOp::multiply, even, x) : even;
}

std::uint32_t FloatTape::constant(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    if (auto it = constants_.find(bits); it != constants_.end()) return it->second;
    code_.push_back({.value = value});
    constants_.emplace(bits, last());
    return last();
}

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
