// SPDX-License-Identifier: Apache-2.0
#include "engine/tape.h"

#include "base/format_number.h"
#include "expr/node.h"
#include "expr/scalar_ops.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

Tape::Tape(const Pipeline& pipeline, const LiveUniforms& uniforms)
    : Tape(compose(pipeline), uniforms, tonewright::limits_input(pipeline)) {}

Tape::Tape(const std::array<Expr, 3>& outputs, const LiveUniforms& uniforms, bool limits_input)
    : uniforms_(uniforms), limits_input_(limits_input), keep_(outputs.begin(), outputs.end()) {
    std::unordered_map<const ExprNode*, std::uint32_t> seen;
    for (std::size_t i = 0; i < 3; ++i)
        outputs_[i] = add(outputs[i], seen);
    if (!limits_input_) note_exposures();
}

void Tape::note_exposures() {
    UniformValues typical;
    for (const auto& [name, uniform] : uniforms_)
        typical[name] = uniform.typical;
    const std::vector<double> numbers = evaluate_numbers(typical);
    for (const TapeInstruction& step : code_) {
        if (step.op != ExprOp::multiply) continue;
        const auto note = [&](std::uint32_t input, std::uint32_t number) {
            if (code_[input].op == ExprOp::input && is_number_[number])
                code_[input].value = numbers[number];
        };
        note(step.a, step.b);
        note(step.b, step.a);
    }
}

std::uint32_t Tape::add(const Expr& expr,
                        std::unordered_map<const ExprNode*, std::uint32_t>& seen) {
    if (auto it = seen.find(expr.node()); it != seen.end()) return it->second;
    TapeInstruction step;
    step.op = expr.op();
    step.node = expr.node();
    if (expr.op() == ExprOp::uniform) {
        const auto range = uniforms_.find(expr.uniform_name());
        if (range == uniforms_.end()) {
            throw Error("engine: " + expr.uniform_name() +
                        " has no value; expected bind_uniforms() before");
        }
        step.value = range->second.typical;
        step.least = range->second.least;
        step.most = range->second.most;
    }
    if (expr.is_constant()) step.value = expr.value();
    if (expr.op() == ExprOp::input) {
        step.input = expr.input_index();
        step.is_limited = limits_input_;
    }
    if (expr.op() == ExprOp::lookup) step.table = expr.table().get();
    if (expr.op() == ExprOp::grid) {
        step.grid = expr.grid().get();
        step.input = expr.channel();
    }
    bool is_live = expr.op() == ExprOp::uniform;
    bool is_number = expr.op() != ExprOp::input && expr.op() != ExprOp::grid;
    std::array<std::uint32_t*, 3> slots = {&step.a, &step.b, &step.c};
    for (int i = 0; i < expr.operand_count(); ++i) {
        const std::uint32_t operand = add(expr.operand(i), seen);
        *slots[static_cast<std::size_t>(i)] = operand;
        is_number = is_number && is_number_[operand];
        is_live = is_live || is_live_[operand];
    }
    if (step.op == ExprOp::divide && !is_number && is_live_[step.b] &&
        !reciprocal_.contains(step.b)) {
        push({.value = 1}, true, false);
        TapeInstruction reciprocal = step;
        reciprocal.a = static_cast<std::uint32_t>(code_.size() - 1);
        push(reciprocal, true, true);
        reciprocal_.emplace(step.b, static_cast<std::uint32_t>(code_.size() - 1));
    }
    push(step, is_number, is_live && is_number);
    const auto index = static_cast<std::uint32_t>(code_.size() - 1);
    seen.emplace(expr.node(), index);
    return index;
}

void Tape::push(const TapeInstruction& step, bool is_number, bool is_live) {
    code_.push_back(step);
    is_number_.push_back(is_number);
    is_live_.push_back(is_live);
}

std::vector<double> Tape::evaluate_numbers(const UniformValues& uniforms) const {
    for (const auto& [name, range] : uniforms_) {
        const auto found = uniforms.find(name);
        if (found != uniforms.end() && found->second >= range.least && found->second <= range.most)
            continue;
        throw Error("engine: " + name + " is " +
                    (found == uniforms.end() ? "missing" : shortest(found->second)) +
                    "; expected [" + shortest(range.least) + ", " + shortest(range.most) + "]");
    }
    std::vector<double> value(code_.size());
    for (std::size_t i = 0; i < code_.size(); ++i) {
        const TapeInstruction& step = code_[i];
        if (step.op == ExprOp::constant) value[i] = step.value;
        if (step.op == ExprOp::uniform) value[i] = uniforms.at(step.node->name);
        if (operand_count(step.op) == 0 || !is_number_[i]) continue;
        value[i] = scalar_op(step.op, value[step.a], value[step.b], value[step.c], step.table);
    }
    return value;
}

std::vector<std::uint32_t> exposure_steps(const std::vector<TapeInstruction>& code,
                                          std::uint32_t i) {
    std::vector<std::uint32_t> steps;
    for (; code[i].op == ExprOp::minimum || code[i].op == ExprOp::maximum; i = code[i].a) {
        if (code[code[i].b].op != ExprOp::constant) return {};
        steps.push_back(i);
    }
    const TapeInstruction& product = code[i];
    if (product.op != ExprOp::multiply) return {};
    const auto is_exposure = [&](std::uint32_t input, std::uint32_t number) {
        return code[input].op == ExprOp::input && is_number(code[number].op);
    };
    if (!is_exposure(product.a, product.b) && !is_exposure(product.b, product.a)) return {};
    steps.push_back(i);
    return steps;
}

bool is_limited_exposure(const std::vector<TapeInstruction>& code, std::uint32_t i) {
    const std::vector<std::uint32_t> steps = exposure_steps(code, i);
    bool has_least = false;
    bool has_most = false;
    for (const std::uint32_t step : steps) {
        if (code[step].op == ExprOp::multiply) continue;
        const double limit = code[code[step].b].value;
        has_least = has_least || (code[step].op == ExprOp::maximum && limit >= -kHalfMax);
        has_most = has_most || (code[step].op == ExprOp::minimum && limit <= kHalfMax);
    }
    return has_least && has_most;
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
        for (const std::int64_t operand : operands[i]) {
            if (operand < 0) continue;
            const auto v = static_cast<std::size_t>(operand);
            if (last_use[v] != i) continue;
            last_use[v] = n;  // the same operand twice is released once
            if (needs_register[v]) free.push_back(result.register_of[v]);
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
