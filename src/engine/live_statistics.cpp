// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "engine/tape.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

bool is_set(const ResolvedOperator& resolved, const std::string& name) {
    return resolved.settings.contains(name) ||
           (resolved.preset && resolved.preset->settings.contains(name));
}

bool is_function(ExprOp op) {
    return op == ExprOp::power || op == ExprOp::exp2 || op == ExprOp::log2 || op == ExprOp::sine ||
           op == ExprOp::cosine || op == ExprOp::atan2 || op == ExprOp::lookup;
}

/// A curve of the scaled value does what a curve with constants does. There is no such curve where
/// a uniform decides on an exponent, and two of them where values are scaled in two ways.
bool is_as_fast(const Pipeline& pipeline, const LiveUniforms& uniforms) {
    const Tape tape(compose(pipeline), uniforms);
    const std::vector<TapeInstruction>& code = tape.code();
    std::vector<bool> is_live(code.size());  // a number that uniforms decide on
    std::vector<std::set<std::uint32_t>> scales(code.size());
    std::set<std::uint32_t> scales_of_functions;
    for (std::uint32_t i = 0; i < code.size(); ++i) {
        const TapeInstruction& step = code[i];
        const std::array<std::uint32_t, 3> operands = {step.a, step.b, step.c};
        for (int k = 0; k < operand_count(step.op); ++k) {
            const std::uint32_t operand = operands[static_cast<std::size_t>(k)];
            is_live[i] = is_live[i] || is_live[operand];
            scales[i].insert(scales[operand].begin(), scales[operand].end());
        }
        if (tape.is_number(i)) {
            is_live[i] = is_live[i] || step.op == ExprOp::uniform;
            continue;
        }
        is_live[i] = false;
        if (operand_count(step.op) == 2 && is_live[step.b]) {
            if (step.op == ExprOp::power) return false;
            if (step.op == ExprOp::divide || step.op == ExprOp::multiply) scales[i].insert(step.b);
        }
        if (step.op == ExprOp::multiply && is_live[step.a]) scales[i].insert(step.a);
        if (is_function(step.op)) scales_of_functions.insert(scales[i].begin(), scales[i].end());
    }
    return scales_of_functions.size() <= 1;
}

}  // namespace

LiveUniforms live_statistics(const ResolvedOperator& resolved) {
    const std::vector<std::string> live = live_parameters(*resolved.op);
    LiveUniforms uniforms;
    for (const ParameterSpec& spec : resolved.op->parameters) {
        if (!spec.from_picture || is_set(resolved, spec.name)) continue;
        if (std::find(live.begin(), live.end(), spec.name) == live.end()) return {};
        uniforms[spec.name] = {spec.default_value, spec.min, spec.max, true};
    }
    if (uniforms.empty() || !is_as_fast(build_live(resolved, uniform_names(uniforms)), uniforms))
        return {};
    return uniforms;
}

std::vector<std::string> uniform_names(const LiveUniforms& uniforms) {
    std::vector<std::string> names;
    for (const auto& [name, uniform] : uniforms)
        names.push_back(name);
    return names;
}

UniformValues statistic_values(const LiveUniforms& uniforms, const ResolvedOperator& resolved,
                               const SceneStatistics& statistics) {
    UniformValues values;
    for (const ParameterSpec& spec : resolved.op->parameters) {
        if (!spec.from_picture || !uniforms.contains(spec.name)) continue;
        values[spec.name] = std::clamp(spec.from_picture(statistics), spec.min, spec.max);
    }
    return values;
}

TONEWRIGHT_NAMESPACE_END
