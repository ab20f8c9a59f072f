// SPDX-License-Identifier: Apache-2.0
//
// The steps of the compilation of a pipeline, as text.
#include <fmt/format.h>

#include <iterator>

#include "engine/machine_code.h"
#include "engine/simd_program.h"
#include "engine/vector_code.h"
#include "expr/node.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using simd::VectorOp;

/// Names in the order of VectorOp.
constexpr const char* kVectorNames[] = {"add",
                                        "subtract",
                                        "multiply",
                                        "divide",
                                        "multiply_add",
                                        "multiply_subtract",
                                        "subtract_product",
                                        "minimum",
                                        "maximum",
                                        "square_root",
                                        "bit_and",
                                        "bit_or",
                                        "bit_xor",
                                        "bit_and_not",
                                        "round",
                                        "floor",
                                        "promote_low",
                                        "promote_high",
                                        "demote",
                                        "equal",
                                        "less",
                                        "less_equal",
                                        "greater",
                                        "greater_equal",
                                        "is_minus",
                                        "blend",
                                        "zero_unless",
                                        "shift_right",
                                        "shift_left",
                                        "integer_add",
                                        "integer_subtract",
                                        "to_index",
                                        "to_float",
                                        "permute_16",
                                        "permute_32",
                                        "gather",
                                        "spill_index",
                                        "rows",
                                        "load_plane",
                                        "store_plane",
                                        "load_pixels",
                                        "store_pixels",
                                        "store_colors",
                                        "load_thirds",
                                        "store_thirds",
                                        "shuffle_4"};
static_assert(std::size(kVectorNames) == static_cast<std::size_t>(VectorOp::shuffle_4) + 1);

class Explanation {
  public:
    std::string of(const simd::Steps& steps) {
        const simd::Program& program = steps.program;
        curves_ = steps.curve_index;
        line("Target {}", program.target->name);
        line("\nTape: {} values", program.source->code().size());
        write_tape(program.source->code(), program.source->outputs(), {});
        line("\nAfter rewriting, curve fitting and choice of precision: {} values",
             steps.tape.size());
        write_tape(steps.tape, steps.outputs, steps.in_double);
        line("\nCurves: {}", program.curves.size());
        for (std::size_t i = 0; i < program.curves.size(); ++i)
            write_curve(i, program.curves[i]);
        line("\nProgram: {} instructions, {} constants, tiles of {} pixels",
             program.instructions.size(), program.numbers.constants.size(), program.tile);
        for (const simd::Instruction& step : program.instructions)
            write_instruction(step);
        write_machine_code(program);
        return std::move(text_);
    }

  private:
    template <class... T>
    void line(fmt::format_string<T...> format, T&&... values) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<T>(values)...);
        text_ += '\n';
    }

    void write_tape(const std::vector<TapeInstruction>& tape,
                    const std::array<std::uint32_t, 3>& outputs,
                    const std::vector<bool>& in_double) {
        for (std::size_t i = 0; i < tape.size(); ++i) {
            const TapeInstruction& step = tape[i];
            std::string what = name_of(step.op);
            if (step.op == ExprOp::constant) what = fmt::format("{}", step.value);
            if (step.op == ExprOp::input) what = "rgb"[step.input];
            if (step.op == ExprOp::uniform)
                what = fmt::format("uniform in [{}, {}]", step.least, step.most);
            if (step.curve) what = fmt::format("curve {}", curves_.at(step.curve));
            const std::array<std::uint32_t, 3> operands = {step.a, step.b, step.c};
            for (int k = 0; k < operand_count(step.op); ++k)
                what += fmt::format("{}%{}", k == 0 ? " " : ", ",
                                    operands[static_cast<std::size_t>(k)]);
            line("  %{} {}= {}", i, !in_double.empty() && in_double[i] ? "f64 " : "", what);
        }
        line("  outputs %{} %{} %{}", outputs[0], outputs[1], outputs[2]);
    }

    void write_curve(std::size_t i, const CompiledCurve& curve) {
        const char* precise = curve.is_precise ? ", precise" : "";
        if (curve.rows) {
            const auto length = static_cast<std::size_t>(curve.rows->length);
            line("  curve {}: {} rows of {} coefficients, {} kinks, x in [{}, {}]{}", i,
                 curve.rows->numbers.size() / length, length, curve.rows->restarts.size(), curve.lo,
                 curve.hi, precise);
        } else {
            line("  curve {}: {} segments of degree {}, {} cells, x in [{}, {}]{}", i,
                 curve.segments, curve.degree, curve.cells, curve.lo, curve.hi, precise);
        }
    }

    /// A register of the tile, or a constant, with its offset in bytes.
    static std::string text_of(const simd::Operand& operand) {
        return fmt::format("{}{}[{}]", operand.constant ? "constant" : "register",
                           operand.wide ? ".f64" : "", operand.offset);
    }

    void write_instruction(const simd::Instruction& step) {
        std::string text;
        for (const simd::Operand& out : step.out) {
            if (!out.constant) text += (text.empty() ? "" : ", ") + text_of(out);
        }
        text += fmt::format(" = {}{}", simd::operation(step.op).name, step.wide ? ".f64" : "");
        if (step.op == simd::ProgramOp::curve) text += fmt::format(" {}", step.table);
        for (int k = 0; k < simd::operation(step.op).operands; ++k)
            text += (k == 0 ? " " : ", ") + text_of(step.in[static_cast<std::size_t>(k)]);
        line("  {}", text);
    }

    void write_machine_code(const simd::Program& program) {
        if (!program.machine) return line("\nMachine code: none, the program is interpreted");
        const std::optional<simd::VectorProgram> vectors = simd::translate(program);
        line("\nMachine code: {} bytes of numbers",
             program.numbers.pool.size() * simd::kVectorBytes);
        constexpr const char* kLayouts[] = {"RGB pixels", "RGBA pixels"};
        for (const auto layout : {simd::PixelLayout::rgb, simd::PixelLayout::rgba}) {
            const auto l = static_cast<std::size_t>(layout);
            const std::vector<simd::VectorCode>& parts = vectors->parts[l];
            for (std::size_t part = 0; part < parts.size(); ++part) {
                line("  {}, part {} of {}: {} vector instructions a block, {} bytes of code",
                     kLayouts[l], part + 1, parts.size(), parts[part].instructions.size(),
                     program.machine->bytes(part, layout));
            }
        }
        line("\nVector instructions of RGB pixels");
        const auto& parts = vectors->parts[static_cast<std::size_t>(simd::PixelLayout::rgb)];
        for (std::size_t part = 0; part < parts.size(); ++part) {
            line("  part {}", part + 1);
            for (const simd::VectorInstruction& step : parts[part].instructions)
                write_vector_instruction(step);
        }
    }

    void write_vector_instruction(const simd::VectorInstruction& step) {
        std::string text =
            step.result == simd::VectorOperand::kNone ? "" : fmt::format("v{} = ", step.result);
        text += fmt::format("{}{}", kVectorNames[static_cast<std::size_t>(step.op)],
                            step.wide ? ".f64" : "");
        const char* separator = " ";
        for (const simd::VectorOperand& in : step.in) {
            if (in.is_value()) text += fmt::format("{}v{}", separator, in.value);
            if (in.is_constant()) text += fmt::format("{}pool[{}]", separator, in.pool);
            if (in.is_value() || in.is_constant()) separator = ", ";
        }
        if (step.mask != simd::VectorOperand::kNone) text += fmt::format(" where v{}", step.mask);
        line("    {}", text);
    }

    std::string text_;
    simd::CurveIndex curves_;
};

}  // namespace

std::string explain(const Pipeline& pipeline, const LiveUniforms& uniforms, double max_error,
                    std::string_view target) {
    return Explanation().of(
        simd::compile_in_steps(pipeline, uniforms, max_error, simd::find_target(target)));
}

TONEWRIGHT_NAMESPACE_END
