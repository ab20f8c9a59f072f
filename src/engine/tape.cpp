// SPDX-License-Identifier: Apache-2.0
#include "engine/tape.h"

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

Tape::Tape(const std::array<Expr, 3>& outputs) : keep_(outputs.begin(), outputs.end()) {
    std::unordered_map<const ExprNode*, std::uint32_t> seen;
    for (std::size_t i = 0; i < 3; ++i)
        outputs_[i] = add(outputs[i], seen);
}

std::uint32_t Tape::add(const Expr& expr,
                        std::unordered_map<const ExprNode*, std::uint32_t>& seen) {
    if (auto it = seen.find(expr.node()); it != seen.end()) return it->second;
    TapeInstruction step;
    step.op = expr.op();
    step.node = expr.node();
    if (expr.op() == ExprOp::uniform) {
        throw Error("engine: " + expr.uniform_name() +
                    " has no value; expected bind_uniforms() before");
    }
    if (expr.is_constant()) step.value = expr.value();
    if (expr.op() == ExprOp::input) step.input = expr.input_index();
    if (expr.op() == ExprOp::lookup) step.table = expr.table().get();
    if (expr.op() == ExprOp::lattice) {
        step.lattice = expr.lattice().get();
        step.input = expr.channel();
    }
    std::array<std::uint32_t*, 3> slots = {&step.a, &step.b, &step.c};
    for (int i = 0; i < expr.operand_count(); ++i) {
        *slots[static_cast<std::size_t>(i)] = add(expr.operand(i), seen);
    }
    code_.push_back(step);
    const auto index = static_cast<std::uint32_t>(code_.size() - 1);
    seen.emplace(expr.node(), index);
    return index;
}

RegisterAllocation allocate_registers(const std::vector<std::array<std::int64_t, 4>>& operands,
                                      const std::vector<bool>& needs_register,
                                      const std::vector<std::uint32_t>& pinned) {
    const std::size_t n = operands.size();
    std::vector<std::size_t> last_use(n);
    for (std::size_t i = 0; i < n; ++i) {
        last_use[i] = i;
        for (const std::int64_t operand : operands[i]) {
            if (operand >= 0) last_use[static_cast<std::size_t>(operand)] = i;
        }
    }
    for (const std::uint32_t value : pinned)
        last_use[value] = n;

    RegisterAllocation result;
    result.register_of.assign(n, 0);
    std::vector<std::uint32_t> free;
    for (std::size_t i = 0; i < n; ++i) {
        std::array<std::int64_t, 4> released{-1, -1, -1, -1};
        for (std::size_t k = 0; k < 4; ++k) {
            const std::int64_t operand = operands[i][k];
            if (operand < 0) continue;
            const auto v = static_cast<std::size_t>(operand);
            bool again = false;  // the same operand twice is released once
            for (const std::int64_t r : released)
                again = again || r == operand;
            if (last_use[v] == i && needs_register[v] && !again) {
                free.push_back(result.register_of[v]);
                released[k] = operand;
            }
        }
        if (!needs_register[i]) continue;
        if (free.empty()) {
            result.register_of[i] = result.register_count++;
        } else {
            result.register_of[i] = free.back();
            free.pop_back();
        }
        if (last_use[i] == i) free.push_back(result.register_of[i]);  // never read
    }
    return result;
}

TONEWRIGHT_NAMESPACE_END
