// SPDX-License-Identifier: Apache-2.0
#include "engine/assemble.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "engine/probe_block.h"
#include "expr/scalar_ops.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace {

/// Limit of a tile's registers in bytes. They stay in a first-level cache of 32 KiB beside the
/// constants and the pixels that are read and written.
constexpr std::size_t kCacheBytes = 24UL * 1024;
/// Limit of positions and slopes in double. Sums of them stay finite.
constexpr double kMostWide = 1e300;

/// Assembles a program. A slot stands for a value that an instruction defines; inputs come first.
/// Floats and doubles have separate registers.
class Assembler {
  public:
    Assembler(const FloatTape& tape, const std::vector<bool>& in_double,
              const std::vector<Selected>& selected)
        : tape_(tape.code()) {
        slot_of_.assign(tape_.size(), kNone);
        for (std::uint32_t i = 0; i < tape_.size(); ++i) {
            if (tape_[i].op == ExprOp::input) define(i, false);
        }
        for (const Selected& s : selected) {
            const std::size_t slot = define(s.value, in_double[s.value]);
            steps_[slot] = s;
        }
        // Outputs are floats. An instruction copies an output that is kept in double.
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t value = tape.outputs()[c];
            outputs_[c] = value;
            if (is_number(tape_[value].op)) continue;
            auto slot = static_cast<std::size_t>(slot_of_[value]);
            if (is_wide_[slot]) {
                steps_.push_back(Selected{
                    .value = value, .operands = {value, kNone, kNone, kNone}, .wide = true});
                is_wide_.push_back(false);
                slot = steps_.size() - 1;
            }
            output_slot_[c] = slot;
        }
    }

    Program assemble(const Target& target) {
        allocate();
        Program program;
        program.target = &target;
        program.tile = tile_;
        for (std::size_t slot = 0; slot < steps_.size(); ++slot) {
            const Selected& s = steps_[slot];
            const TapeInstruction& origin = tape_[s.value];
            if (origin.op == ExprOp::input) {
                const auto channel = static_cast<std::size_t>(origin.input);
                program.reads_input[channel] = true;
                program.limits_input = origin.is_limited;
                program.input_offset[channel] = place(slot).offset;
                continue;
            }
            if (s.sibling > 0) {
                add_result(program.instructions.back(), slot);
                continue;
            }
            Instruction step;
            step.op = s.op;
            step.wide = s.wide || s.op == ProgramOp::sine || s.op == ProgramOp::cosine ||
                        s.op == ProgramOp::atan2;
            step.is_positive = s.is_positive;
            if (s.op == ProgramOp::lookup) step.table = table(*s.table);
            if (s.op == ProgramOp::curve) step.table = curve(*s.curve);
            if (s.op == ProgramOp::grid) step.table = grid(*s.grid, step.wide);
            if (s.op == ProgramOp::lookup_nonuniform) {
                step.table = static_cast<std::uint32_t>(positioned_.size());
                positioned_.push_back(at_positions(slot, step.wide));
            }
            add_result(step, slot);
            for (std::size_t k = 0; k < 4; ++k) {
                if (s.operands[k] == kNone) continue;
                step.in[k] = operand(static_cast<std::uint32_t>(s.operands[k]), step.wide);
            }
            program.instructions.push_back(step);
        }
        for (std::size_t c = 0; c < 3; ++c) {
            program.output[c] = is_number(tape_[outputs_[c]].op) ? number(outputs_[c], false)
                                                                 : place(output_slot_[c]);
        }
        program.numbers.constants = std::move(constants_);
        program.uniforms = std::move(uniforms_);
        program.tables = std::move(tables_);
        program.positioned = std::move(positioned_);
        program.grids = std::move(grids_);
        program.curves = std::move(curves_);
        program.is_one_function = is_one_function();
        return program;
    }

    [[nodiscard]] const CurveIndex& curve_index() const { return curve_index_; }

  private:
    /// True if each channel of the result is the same function of that channel alone.
    [[nodiscard]] bool is_one_function() const {
        for (const int channel : {1, 2}) {
            std::map<std::uint32_t, std::uint32_t> counterpart;
            if (!is_same(outputs_[0], outputs_[static_cast<std::size_t>(channel)], channel,
                         counterpart))
                return false;
        }
        return true;
    }
    /// True if value b is the same function of `channel` as value a is of channel 0.
    [[nodiscard]] bool is_same(std::uint32_t a, std::uint32_t b, int channel,
                               std::map<std::uint32_t, std::uint32_t>& counterpart) const {
        const TapeInstruction& x = tape_[a];
        const TapeInstruction& y = tape_[b];
        if (is_number(x.op) || is_number(y.op)) return a == b;
        if (x.op == ExprOp::input || y.op == ExprOp::input)
            return x.op == y.op && x.input == 0 && y.input == channel;
        if (const auto [it, is_new] = counterpart.emplace(a, b); !is_new) return it->second == b;
        const auto slot_a = static_cast<std::size_t>(slot_of_[a]);
        const auto slot_b = static_cast<std::size_t>(slot_of_[b]);
        const Selected& s = steps_[slot_a];
        const Selected& t = steps_[slot_b];
        if (s.op != t.op || s.k != t.k || s.table != t.table || s.curve != t.curve ||
            s.wide != t.wide || is_wide_[slot_a] != is_wide_[slot_b] ||
            operation(s.op).has_channels) {
            return false;
        }
        for (std::size_t i = 0; i < s.operands.size(); ++i) {
            if ((s.operands[i] == kNone) != (t.operands[i] == kNone)) return false;
            if (s.operands[i] != kNone &&
                !is_same(static_cast<std::uint32_t>(s.operands[i]),
                         static_cast<std::uint32_t>(t.operands[i]), channel, counterpart))
                return false;
        }
        return true;
    }

    std::size_t define(std::uint32_t value, bool wide) {
        steps_.push_back({.value = value});
        is_wide_.push_back(wide);
        slot_of_[value] = static_cast<std::int64_t>(steps_.size() - 1);
        return steps_.size() - 1;
    }

    void allocate() {
        std::vector<std::array<std::int64_t, 4>> operands;
        for (const Selected& s : steps_) {
            std::array<std::int64_t, 4> slots = {kNone, kNone, kNone, kNone};
            for (std::size_t k = 0; k < 4; ++k) {
                if (s.operands[k] != kNone)
                    slots[k] = slot_of_[static_cast<std::size_t>(s.operands[k])];
            }
            operands.push_back(slots);
        }
        std::vector<std::uint32_t> pinned;
        for (std::size_t c = 0; c < 3; ++c) {
            if (!is_number(tape_[outputs_[c]].op)) {
                pinned.push_back(static_cast<std::uint32_t>(output_slot_[c]));
            }
        }
        std::vector<bool> is_narrow = is_wide_;
        is_narrow.flip();
        narrow_ = allocate_registers(operands, is_narrow, pinned);
        wide_ = allocate_registers(operands, is_wide_, pinned);

        const std::size_t bytes = std::max<std::size_t>(
            narrow_.register_count * sizeof(float) + wide_.register_count * sizeof(double), 1);
        tile_ = std::clamp(kCacheBytes / bytes / kLaneMultiple * kLaneMultiple, kLaneMultiple,
                           kMaxTile);
        if (tile_ * bytes > kRegisterFileBytes) {
            throw Error("simd engine: live values are " + std::to_string(narrow_.register_count) +
                        " floats and " + std::to_string(wide_.register_count) +
                        " doubles; expected at most " +
                        std::to_string(kRegisterFileBytes / kLaneMultiple) + " bytes");
        }
    }

    [[nodiscard]] Operand place(std::size_t slot) const {
        const std::size_t offset = is_wide_[slot]
                                       ? (narrow_.register_count * sizeof(float) +
                                          wide_.register_of[slot] * sizeof(double)) *
                                             tile_
                                       : narrow_.register_of[slot] * sizeof(float) * tile_;
        return {.offset = static_cast<std::uint32_t>(offset), .wide = is_wide_[slot]};
    }

    Operand operand(std::uint32_t value, bool user_is_wide) {
        if (is_number(tape_[value].op)) return number(value, user_is_wide);
        return place(static_cast<std::size_t>(slot_of_[value]));
    }

    /// A vector filled with the constant or uniform i.
    Operand number(std::uint32_t i, bool wide) {
        const TapeInstruction& step = tape_[i];
        const bool is_uniform = step.op == ExprOp::uniform;
        const auto key =
            std::tuple(is_uniform, is_uniform ? i : std::bit_cast<std::uint64_t>(step.value), wide);
        auto [it, is_new] = constant_index_.try_emplace(key, constants_.size());
        if (is_new) {
            const std::size_t offset = it->second * kVectorBytes;
            constants_.emplace_back();
            if (is_uniform)
                uniforms_.push_back(
                    {step.source, static_cast<std::uint32_t>(offset), kVectorBytes, wide, false});
            fill(constants_.back().bytes.data(), kVectorBytes, step.value, wide);
        }
        return {static_cast<std::uint32_t>(it->second * kVectorBytes), true, wide};
    }

    /// Adds the register and the coefficients of a result to its instruction.
    void add_result(Instruction& step, std::size_t slot) {
        const Selected& s = steps_[slot];
        const auto n = static_cast<std::size_t>(s.sibling);
        step.out[s.op == ProgramOp::grid ? static_cast<std::size_t>(s.channel) : n] = place(slot);
        std::copy(s.k.begin(), s.k.end(),
                  step.k.begin() + 3 * static_cast<std::ptrdiff_t>(s.sibling));
    }

    static void add(Samples& to, double number, bool is_wide) {
        is_wide ? to.wide.push_back(number) : to.narrow.push_back(static_cast<float>(number));
    }

    /// The non-uniform tables of a step and of its siblings.
    [[nodiscard]] NonuniformTables at_positions(std::size_t slot, bool is_wide) const {
        std::vector<const Table*> tables = {steps_[slot].table};
        while (++slot < steps_.size() && steps_[slot].sibling > 0)
            tables.push_back(steps_[slot].table);
        NonuniformTables result;
        const std::vector<double>& positions = tables[0]->positions;
        result.cells = positions.size();
        result.length = tables.size() > 1 ? 8 : 4;
        const auto begin_of = [&](double position) {
            const double x = std::clamp(position, -kMostWide, kMostWide);
            return is_wide ? x : static_cast<double>(float_from(x));
        };
        const double length = begin_of(positions.back()) - begin_of(positions.front());
        // Twice as many parts as cells: few parts have more than one boundary.
        if (length > 1e-30)
            result.parts_per_unit =
                static_cast<double>(2 * std::bit_ceil(positions.size())) / length;
        // The part in which each cell starts, computed as in the kernel.
        std::vector<std::size_t> part;
        const auto part_of = [&](auto begin, auto first) {
            using T = decltype(begin);
            return static_cast<std::size_t>((begin - first) *
                                            static_cast<T>(result.parts_per_unit));
        };
        for (std::size_t i = 0; i < positions.size(); ++i) {
            const double begin = begin_of(positions[i]);
            add(result.begin, begin, is_wide);
            part.push_back(is_wide ? part_of(begin, result.begin.wide[0])
                                   : part_of(result.begin.narrow[i], result.begin.narrow[0]));
            add(result.rows, begin, is_wide);
            for (const Table* table : tables) {
                const bool is_line =
                    table->interpolation == Table::Interpolation::linear && i + 1 < result.cells;
                const double slope =
                    is_line ? std::clamp(cell_slope(*table, i), -kMostWide, kMostWide) : 0;
                // An x below the first position gets exactly the first sample.
                const double distance = i > 0 || is_wide ? begin - positions[i] : 0;
                add(result.rows, table->samples[i] + slope * distance, is_wide);
                add(result.rows, slope, is_wide);
            }
            while ((result.rows.narrow.size() + result.rows.wide.size()) %
                   static_cast<std::size_t>(result.length))
                add(result.rows, 0, is_wide);
        }
        std::size_t first = 0, last = 0, most = 0;
        for (std::size_t p = 0; p <= part.back(); ++p) {
            while (first + 1 < part.size() && part[first + 1] < p)
                ++first;
            while (last + 1 < part.size() && part[last + 1] <= p)
                ++last;
            add(result.first_cell, static_cast<double>(first), is_wide);
            most = std::max(most, last - first);
        }
        result.half_of_most = static_cast<std::int32_t>(std::bit_ceil(most + 1) / 2);
        for (std::int32_t i = 0; i < result.half_of_most; ++i)
            add(result.begin, kInfinity, is_wide);
        return result;
    }

    /// Index of the object made from a source. It is made when it is asked for the first time.
    template <class Source, class Made, class Make>
    static std::uint32_t find(std::map<const Source*, std::uint32_t>& index, const Source& source,
                              std::vector<Made>& all, const Make& make) {
        const auto [it, is_new] =
            index.try_emplace(&source, static_cast<std::uint32_t>(all.size()));
        if (is_new) all.push_back(make());
        return it->second;
    }

    std::uint32_t grid(const Grid& source, bool is_wide) {
        const std::uint32_t found = find(grid_index_, source, grids_, [&] {
            return SampledGrid{source.edge(), {}};
        });
        Samples& nodes = grids_[found].nodes;
        const auto pad = [&](auto& padded) {
            if (!padded.empty()) return;
            using T = typename std::remove_reference_t<decltype(padded)>::value_type;
            const std::vector<double>& numbers = source.nodes();
            padded.resize(numbers.size() / 3 * 4);
            for (std::size_t i = 0; i < numbers.size() / 3; ++i) {
                for (std::size_t c = 0; c < 3; ++c)
                    padded[4 * i + c] = static_cast<T>(numbers[3 * i + c]);
            }
        };
        is_wide ? pad(nodes.wide) : pad(nodes.narrow);
        return found;
    }

    std::uint32_t curve(const CompiledCurve& source) {
        return find(curve_index_, source, curves_, [&] { return source; });
    }

    std::uint32_t table(const Table& source) {
        return find(table_index_, source, tables_, [&] {
            const std::vector<double>& samples = source.samples;
            return SampledTable{{{samples.begin(), samples.end()}, samples}, source.interpolation};
        });
    }

    const std::vector<TapeInstruction>& tape_;
    std::array<std::uint32_t, 3> outputs_{};
    std::array<std::size_t, 3> output_slot_{};
    std::vector<Selected> steps_;        // by slot
    std::vector<bool> is_wide_;          // by slot: kept in double
    std::vector<std::int64_t> slot_of_;  // by tape value
    RegisterAllocation narrow_, wide_;
    std::size_t tile_ = 0;
    std::vector<ConstantVector> constants_;
    std::vector<UniformPlace> uniforms_;
    std::map<std::tuple<bool, std::uint64_t, bool>, std::size_t> constant_index_;
    std::vector<SampledTable> tables_;
    std::map<const Table*, std::uint32_t> table_index_;
    std::vector<NonuniformTables> positioned_;
    std::vector<SampledGrid> grids_;
    std::map<const Grid*, std::uint32_t> grid_index_;
    std::vector<CompiledCurve> curves_;
    CurveIndex curve_index_;
};

}  // namespace

Program assemble(const FloatTape& tape, const std::vector<bool>& in_double,
                 const std::vector<Selected>& selected, const Target& target,
                 CurveIndex* curve_index) {
    Assembler assembler(tape, in_double, selected);
    Program program = assembler.assemble(target);
    if (curve_index) *curve_index = assembler.curve_index();
    return program;
}

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
