// SPDX-License-Identifier: Apache-2.0
#include "engine/simd_program.h"

#include <algorithm>
#include <atomic>

#include "engine/machine_code.h"
#include "engine/precision.h"
#include "engine/probe_block.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace {

/// A pipeline compiled for all targets that have the same curve form, up to the allocation of
/// registers.
struct CompiledVariant {
    std::shared_ptr<const Tape> source;
    FloatTape tape;
    CurveCache curves;  // owns what the tape refers to
    std::vector<bool> in_double;
    std::vector<Selected> selected;

    Program assemble(const Target& target, CurveIndex* curve_index = nullptr) const {
        Program program = simd::assemble(tape, in_double, selected, target, curve_index);
        program.source = source;
        if (target.machine) program.machine = MachineCode::make(program);
        return program;
    }
};

/// Values of the tape's numbers with the uniforms at the ends of their ranges: all at the same end,
/// then at alternate ends.
std::vector<std::vector<double>> numbers_at_ends(const Tape& tape, const LiveUniforms& uniforms) {
    const auto count = std::count_if(uniforms.begin(), uniforms.end(),
                                     [](const auto& u) { return u.second.covers_ends; });
    std::vector<std::vector<double>> result;
    const auto add = [&](bool first_is_least, bool takes_turns) {
        UniformValues values;
        bool is_least = first_is_least;
        for (const auto& [name, uniform] : uniforms) {
            values[name] = uniform.typical;
            if (!uniform.covers_ends) continue;
            values[name] = is_least ? uniform.least : uniform.most;
            if (takes_turns) is_least = !is_least;
        }
        result.push_back(tape.evaluate_numbers(values));
    };
    for (const bool takes_turns : {false, true}) {
        if (count < (takes_turns ? 2 : 1)) break;
        add(true, takes_turns);
        add(false, takes_turns);
    }
    return result;
}

std::atomic<std::size_t> compiled_variants = 0;

CompiledVariant compile_variant(const Pipeline& pipeline, const LiveUniforms& uniforms,
                                double max_error, CurveForm curve_form) {
    ++compiled_variants;
    const bool has_curves = curve_form != CurveForm::none;
    const auto source = std::make_shared<const Tape>(simplify(pipeline), uniforms);
    const FloatTape plain(*source);
    Sensitivity sensitivity;
    const std::vector<std::vector<double>> ends = numbers_at_ends(*source, uniforms);
    if (has_curves) sensitivity = measure_sensitivity(plain.code(), plain.outputs(), ends);
    CurveCache curves;
    while (true) {
        FloatTape tape = plain;
        if (has_curves) tape.fit_curves(sensitivity, curves, curve_form);
        Precision precision = choose_precision(tape.code(), tape.outputs(), max_error, ends);
        // Fits curves that are too coarse once more, as precise curves. Those that are precise
        // already get no curve.
        for (const CompiledCurve* curve : precision.too_coarse)
            reject_curve(curves, curve);
        if (!precision.too_coarse.empty()) continue;
        std::vector<Selected> selected = select(tape, precision.in_double);
        return {source, std::move(tape), std::move(curves), std::move(precision.in_double),
                std::move(selected)};
    }
}

}  // namespace

Program compile(const Pipeline& pipeline, double max_error, const Target& target, bool has_curves,
                const LiveUniforms& uniforms) {
    return compile_variant(pipeline, uniforms, max_error,
                           has_curves ? target.curve_form : CurveForm::none)
        .assemble(target);
}

std::vector<Program> compile_for_all_targets(const Pipeline& pipeline, double max_error) {
    std::map<CurveForm, CompiledVariant> variants;
    std::vector<Program> programs;
    for (const Target& target : targets()) {
        if (!variants.contains(target.curve_form))
            variants.emplace(target.curve_form,
                             compile_variant(pipeline, {}, max_error, target.curve_form));
        programs.push_back(variants.at(target.curve_form).assemble(target));
    }
    return programs;
}

Steps compile_in_steps(const Pipeline& pipeline, const LiveUniforms& uniforms, double max_error,
                       const Target& target) {
    CompiledVariant variant = compile_variant(pipeline, uniforms, max_error, target.curve_form);
    Steps steps;
    steps.program = variant.assemble(target, &steps.curve_index);
    steps.tape = variant.tape.code();
    steps.outputs = variant.tape.outputs();
    steps.in_double = std::move(variant.in_double);
    steps.curves = std::move(variant.curves);
    return steps;
}

std::size_t compilations() noexcept { return compiled_variants; }

void set_uniforms(const Program& program, const std::vector<double>& values, Numbers& numbers) {
    const auto set = [&](const std::vector<UniformPlace>& places, std::vector<ConstantVector>& to) {
        for (const UniformPlace& place : places) {
            const double value = values[place.source];
            fill(reinterpret_cast<unsigned char*>(to.data()) + place.offset, place.bytes,
                 place.is_rounded ? static_cast<double>(static_cast<float>(value)) : value,
                 place.wide);
        }
    };
    set(program.uniforms, numbers.constants);
    if (program.machine) set(program.machine->program().uniforms, numbers.pool);
}

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
