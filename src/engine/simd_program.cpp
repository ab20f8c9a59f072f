// SPDX-License-Identifier: Apache-2.0
#include "engine/simd_program.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "base/strings.h"
#include "engine/machine_code.h"
#include "engine/precision.h"
#include "engine/probe_block.h"
#include "expr/interval.h"
#include "expr/scalar_ops.h"
#include "tonewright/engine.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace {

/// Bytes of registers that a tile may take: what stays in a first-level cache of 32 KiB beside the
/// constants and the pixels on their way in and out.
constexpr std::size_t kCacheBytes = 24UL * 1024;

constexpr std::int64_t kNone = -1;
/// Doubles that still can be added.
constexpr double kMostWide = 1e300;

// ---------------------------------------------------------------------------------------------
// Pass 1: rewrites on the tape

/// A tape under construction; constants are shared.
class FloatTape {
  public:
    explicit FloatTape(const Tape& tape) {
        const std::vector<TapeInstruction> code = with_merged_uniforms(tape);
        std::vector<std::int64_t> moved(code.size(), kNone);  // old index -> new one
        const auto find = [&](std::uint32_t i) {
            if (moved[i] == kNone) moved[i] = add(code[i]);  // a uniform, where it is first read
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

    /// @param cache  owns the curves
    void fold(const Sensitivity& sensitivity, CurveCache& cache, CurveForm form) {
        fit_curves(code_, outputs_, sensitivity, cache, form);
    }

    [[nodiscard]] const std::vector<TapeInstruction>& code() const { return code_; }
    [[nodiscard]] const std::array<std::uint32_t, 3>& outputs() const { return outputs_; }

  private:
    /// The tape's code where each number that uniforms decide on is a uniform of its own.
    static std::vector<TapeInstruction> with_merged_uniforms(const Tape& tape) {
        std::vector<TapeInstruction> code = tape.code();
        const auto range = [&](std::uint32_t i) {
            const TapeInstruction& step = code[i];
            return step.op == ExprOp::uniform ? Interval{step.least, step.most}
                                              : Interval{step.value, step.value};
        };
        for (std::uint32_t i = 0; i < code.size(); ++i) {
            TapeInstruction& step = code[i];
            step.source = i;
            // As constants are multiplied by their reciprocals: see add().
            if (step.op == ExprOp::divide && !tape.is_number(i) &&
                code[step.b].op == ExprOp::uniform) {
                step.op = ExprOp::multiply;
                step.b = tape.reciprocal(step.b);
            }
            if (!tape.is_number(i) || operand_count(step.op) == 0) continue;
            step.value = scalar_op(step.op, code[step.a].value, code[step.b].value,
                                   code[step.c].value, step.table);
            const std::vector<std::uint32_t> read = operands_of(step);
            if (std::none_of(read.begin(), read.end(), [&](std::uint32_t operand) {
                    return code[operand].op == ExprOp::uniform;
                })) {
                continue;
            }
            const Interval values = interval_of(step.op, range(step.a), range(step.b),
                                                range(step.c), step.table, nullptr);
            step.op = ExprOp::uniform;
            step.least = values.lo;
            step.most = values.hi;
        }
        return code;
    }

    std::uint32_t add(const TapeInstruction& step) {
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
                const std::uint32_t power =
                    whole_power(step.a, static_cast<unsigned>(std::fabs(y)));
                return y > 0 ? power : push(ExprOp::divide, constant(1), power);
            }
        }
        code_.push_back(step);
        return last();
    }

    /// f(y) / y where y > 0 and f(y) = y / g: Reinhard of a luminance.
    [[nodiscard]] bool is_scale_of_positive(const TapeInstruction& select) const {
        const TapeInstruction& condition = code_[select.a];
        const TapeInstruction& scale = code_[select.b];
        const TapeInstruction& mapped = code_[scale.a];
        return condition.op == ExprOp::less && is_constant(condition.a) &&
               code_[condition.a].value >= 0 && scale.op == ExprOp::divide &&
               scale.b == condition.b && mapped.op == ExprOp::divide && mapped.a == condition.b;
    }

    std::uint32_t whole_power(std::uint32_t x, unsigned n) {
        if (n == 1) return x;
        const std::uint32_t half = whole_power(x, n / 2);
        const std::uint32_t even = push(ExprOp::multiply, half, half);
        return n % 2 ? push(ExprOp::multiply, even, x) : even;
    }

    std::uint32_t constant(double value) {
        const auto bits = std::bit_cast<std::uint64_t>(value);
        if (auto it = constants_.find(bits); it != constants_.end()) return it->second;
        code_.push_back({.value = value});
        constants_.emplace(bits, last());
        return last();
    }

    std::uint32_t push(ExprOp op, std::uint32_t a, std::uint32_t b = 0) {
        code_.push_back({.op = op, .a = a, .b = b});
        return last();
    }

    [[nodiscard]] bool is_constant(std::uint32_t i) const {
        return code_[i].op == ExprOp::constant;
    }
    [[nodiscard]] std::uint32_t last() const {
        return static_cast<std::uint32_t>(code_.size() - 1);
    }

    std::vector<TapeInstruction> code_;
    std::array<std::uint32_t, 3> outputs_{};
    std::map<std::uint64_t, std::uint32_t> constants_;
};

// ---------------------------------------------------------------------------------------------
// Pass 3: instructions selected

/// An instruction before it has registers: operands are indices of tape values.
struct Selected {
    Op op = Op::copy;
    std::uint32_t value = 0;  // the tape value that it defines
    std::array<std::int64_t, 4> operands = {kNone, kNone, kNone, kNone};
    std::array<double, 3> k{};
    const Table* table = nullptr;
    const Lattice* lattice = nullptr;
    const CompiledCurve* curve = nullptr;
    int channel = 0;  // of the lattice
    int sibling = 0;  // 0, or how many siblings come before: they are one instruction
    bool wide = false;
    bool is_positive = false;
};

/// One instruction computes both: two channels of one lattice at one place, two rows of a matrix,
/// two tables with the same positions.
bool are_siblings(const Selected& x, const Selected& y) {
    if (x.op != y.op || x.operands != y.operands) return false;
    switch (x.op) {
        case Op::lattice:
            return x.lattice == y.lattice;
        case Op::dot3:
            return true;
        case Op::lookup_nonuniform:
            return x.table->positions == y.table->positions;
        default:
            return false;
    }
}

/// What is computed of positions and slopes has its place in floats.
bool fits_floats(const Table& table) {
    for (std::size_t i = 0; i < table.positions.size(); ++i) {
        const double slope = i > 0 ? cell_slope(table, i - 1) : 0;
        if (!(std::max(std::fabs(table.positions[i]), std::fabs(slope)) < 1e30)) return false;
    }
    return true;
}

/// The operation of the same name.
constexpr Op same_operation(ExprOp op) {
    const std::string_view name = name_of(op);
    const auto is_same = [name](const Operation& other) { return name == other.name; };
    return static_cast<Op>(std::find_if(std::begin(kOperations), std::end(kOperations), is_same) -
                           std::begin(kOperations));
}
static_assert(std::all_of(std::begin(kScalarOperations), std::end(kScalarOperations),
                          [](const ScalarOperation& op) {
                              const auto i = static_cast<std::size_t>(&op - kScalarOperations);
                              return op.operands == 0 ||
                                     static_cast<std::size_t>(same_operation(
                                         static_cast<ExprOp>(i))) < std::size(kOperations);
                          }));

class Selector {
  public:
    /// @param in_double  gets those, too, that are computed and read in double anyway
    Selector(const FloatTape& tape, std::vector<bool>& in_double)
        : code_(tape.code()), in_double_(in_double), uses_(code_.size()), is_needed_(code_.size()) {
        for (const TapeInstruction& step : code_) {
            for (const std::uint32_t operand : operands_of(step))
                ++uses_[operand];
        }
        for (const std::uint32_t output : tape.outputs()) {
            uses_[output] += 2;  // never absorbed
            is_needed_[output] = true;
        }
    }

    /// From the outputs back, each value as the largest pattern that ends in it.
    std::vector<Selected> select() {
        std::vector<Selected> result;
        for (std::size_t i = code_.size(); i-- > 0;) {
            const ExprOp op = code_[i].op;
            if (!is_needed_[i] || is_number(op) || op == ExprOp::input) continue;
            current_ = Selected{};
            current_.value = static_cast<std::uint32_t>(i);
            current_.wide = in_double_[i];
            match(code_[i]);
            // Rounding is monotone, so rounding the operands gives the rounded result, except for
            // the sign of a zero.
            const bool rounds_before = !is_read_in_double_[i] &&
                                       (current_.op == Op::clamp || current_.op == Op::minimum ||
                                        current_.op == Op::maximum || current_.op == Op::negate ||
                                        current_.op == Op::absolute);
            if (rounds_before) current_.wide = in_double_[i];
            const auto each_operand = [&](const auto& visit) {
                for (const std::int64_t v : current_.operands)
                    if (v != kNone) visit(static_cast<std::size_t>(v));
            };
            each_operand([&](std::size_t v) {
                is_needed_[v] = true;
                if (in_double_[v] && !current_.curve && !rounds_before) current_.wide = true;
            });
            if (current_.wide && is_read_in_double_[i]) in_double_[i] = true;
            if (current_.wide && !current_.curve)
                each_operand([&](std::size_t v) { is_read_in_double_[v] = true; });
            result.push_back(current_);
        }
        std::reverse(result.begin(), result.end());
        gather_siblings(result);
        return result;
    }

  private:
    /// Up to three siblings one behind the other: their operands are there at the first.
    static void gather_siblings(std::vector<Selected>& program) {
        for (std::size_t i = 0; i < program.size();) {
            std::size_t end = i + 1;
            for (std::size_t k = end; k < program.size() && end - i < 3; ++k) {
                if (!are_siblings(program[i], program[k])) continue;
                std::rotate(program.begin() + static_cast<std::ptrdiff_t>(end),
                            program.begin() + static_cast<std::ptrdiff_t>(k),
                            program.begin() + static_cast<std::ptrdiff_t>(k) + 1);
                program[end].sibling = static_cast<int>(end - i);
                ++end;
            }
            // One of them, or an operand, in double, and all are computed in double.
            bool wide = false;
            for (std::size_t k = i; k < end; ++k)
                wide = wide || program[k].wide;
            for (std::size_t k = i; k < end; ++k)
                program[k].wide = wide;
            i = end;
        }
    }

    [[nodiscard]] bool is(std::uint32_t i, ExprOp op) const { return code_[i].op == op; }
    [[nodiscard]] bool is_constant(std::uint32_t i) const { return is(i, ExprOp::constant); }
    /// Value i is computed by `op`, and for this one use alone: it can become a part of the user.
    [[nodiscard]] bool absorbs(std::uint32_t i, ExprOp op) const {
        return is(i, op) && uses_[i] == 1;
    }

    /// A finite number, because it is a sum of multiples of inputs, or a limit of one.
    [[nodiscard]] bool is_finite(std::uint32_t i) const {
        constexpr double kLargest = 0x1p20;
        const TapeInstruction& step = code_[i];
        switch (step.op) {
            case ExprOp::input:
                return step.is_limited;
            case ExprOp::constant:
                return std::fabs(step.value) <= kLargest;
            case ExprOp::uniform:
                return std::fabs(step.least) <= kLargest && std::fabs(step.most) <= kLargest;
            case ExprOp::multiply:
                return (is_number(code_[step.a].op) || is_number(code_[step.b].op)) &&
                       is_finite(step.a) && is_finite(step.b);
            case ExprOp::add:
            case ExprOp::subtract:
            case ExprOp::minimum:
            case ExprOp::maximum:
                return (is_finite(step.a) && is_finite(step.b)) || is_limited_exposure(code_, i);
            default:
                return false;
        }
    }
    /// Limited to positive numbers that are no denormals. A limit of NaN is NaN.
    [[nodiscard]] bool is_positive(std::uint32_t i) const {
        const TapeInstruction& step = code_[i];
        constexpr auto kLeast = static_cast<double>(std::numeric_limits<float>::min());
        if (step.op == ExprOp::constant) return step.value >= kLeast;
        if (step.op == ExprOp::maximum)
            return (is_positive(step.a) || is_positive(step.b)) && is_finite(i);
        return step.op == ExprOp::minimum && is_positive(step.a) && is_positive(step.b);
    }

    /// Makes the pattern's instruction; `absorbed` values become part of it.
    void emit(Op op, std::initializer_list<std::uint32_t> operands,
              std::initializer_list<std::uint32_t> absorbed = {}) {
        current_.op = op;
        std::size_t n = 0;
        for (const std::uint32_t operand : operands)
            current_.operands[n++] = operand;
        for (const std::uint32_t value : absorbed)
            current_.wide = current_.wide || in_double_[value];
    }

    /// Product of a constant and another value, used here alone.
    bool is_term(std::uint32_t i, double& k, std::uint32_t& x) const {
        if (!absorbs(i, ExprOp::multiply)) return false;
        const TapeInstruction& step = code_[i];
        if (is_constant(step.a) == is_constant(step.b)) return false;
        k = code_[is_constant(step.a) ? step.a : step.b].value;
        x = is_constant(step.a) ? step.b : step.a;
        return true;
    }

    /// (k0 a + k1 b) + k2 c: a row of a matrix, or a luminance.
    bool match_rows3(const TapeInstruction& sum) {
        if (!absorbs(sum.a, ExprOp::add)) return false;
        const TapeInstruction& first = code_[sum.a];
        std::array<double, 3> k{};
        std::array<std::uint32_t, 3> x{};
        if (!is_term(first.a, k[0], x[0]) || !is_term(first.b, k[1], x[1]) ||
            !is_term(sum.b, k[2], x[2])) {
            return false;
        }
        emit(Op::dot3, {x[0], x[1], x[2]}, {sum.a, first.a, first.b, sum.b});
        current_.k = k;
        return true;
    }

    void match(const TapeInstruction& step) {
        const std::uint32_t a = step.a;
        const std::uint32_t b = step.b;
        const auto product = [&](std::uint32_t i) -> const TapeInstruction& { return code_[i]; };
        switch (step.op) {
            case ExprOp::constant:
            case ExprOp::input:
            case ExprOp::uniform:
                return;
            case ExprOp::add:
                if (match_rows3(step)) return;
                if (absorbs(b, ExprOp::multiply)) {
                    return emit(Op::multiply_add, {product(b).a, product(b).b, a}, {b});
                }
                if (absorbs(a, ExprOp::multiply)) {
                    return emit(Op::multiply_add, {product(a).a, product(a).b, b}, {a});
                }
                return emit(Op::add, {a, b});
            case ExprOp::subtract:
                if (absorbs(b, ExprOp::multiply)) {
                    return emit(Op::subtract_product, {product(b).a, product(b).b, a}, {b});
                }
                if (absorbs(a, ExprOp::multiply)) {
                    return emit(Op::multiply_subtract, {product(a).a, product(a).b, b}, {a});
                }
                return emit(Op::subtract, {a, b});
            case ExprOp::minimum:
                if (absorbs(a, ExprOp::maximum)) {
                    return emit(Op::clamp, {code_[a].a, code_[a].b, b}, {a});
                }
                return emit(Op::minimum, {a, b});
            case ExprOp::power:
                if (is_constant(b) && code_[b].value != std::floor(code_[b].value)) {
                    current_.k[0] = code_[b].value;
                    current_.is_positive = is_positive(a);
                    return emit(Op::power_constant, {a}, {b});
                }
                return emit(Op::power, {a, b});
            case ExprOp::select: {
                const TapeInstruction& c = code_[a];
                switch (c.op) {
                    case ExprOp::less:
                        return emit(Op::select_less, {c.a, c.b, b, step.c});
                    case ExprOp::less_equal:
                        return emit(Op::select_less_equal, {c.a, c.b, b, step.c});
                    case ExprOp::equal:
                        return emit(Op::select_equal, {c.a, c.b, b, step.c});
                    default:
                        return emit(Op::select, {a, b, step.c});
                }
            }
            case ExprOp::lookup:
                current_.table = step.table;
                current_.curve = step.curve;
                if (!step.curve && !fits_floats(*step.table)) current_.wide = true;
                return emit(step.curve                      ? Op::curve
                            : step.table->positions.empty() ? Op::lookup
                                                            : Op::lookup_nonuniform,
                            {a});
            case ExprOp::lattice:
                current_.lattice = step.lattice;
                current_.channel = step.input;
                return emit(Op::lattice, {a, b, step.c});
            default: {
                current_.op = same_operation(step.op);
                current_.is_positive = step.op == ExprOp::log2 && is_positive(a);
                const std::vector<std::uint32_t> operands = operands_of(step);
                std::copy(operands.begin(), operands.end(), current_.operands.begin());
            }
        }
    }

    const std::vector<TapeInstruction>& code_;
    std::vector<bool>& in_double_;
    std::vector<int> uses_;
    std::vector<bool> is_needed_;
    std::vector<bool> is_read_in_double_ = std::vector<bool>(code_.size());
    Selected current_;
};

// ---------------------------------------------------------------------------------------------
// Pass 4: registers, constants, tables

/// Every value that an instruction defines, inputs first, with registers of two kinds.
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
        // Outputs leave as float.
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

    Code assemble(const Target& target) {
        allocate();
        Code code;
        code.target = &target;
        code.tile = tile_;
        for (std::size_t slot = 0; slot < steps_.size(); ++slot) {
            const Selected& s = steps_[slot];
            const TapeInstruction& origin = tape_[s.value];
            if (origin.op == ExprOp::input) {
                const auto channel = static_cast<std::size_t>(origin.input);
                code.reads_input[channel] = true;
                code.limits_input = origin.is_limited;
                code.input_offset[channel] = place(slot).offset;
                continue;
            }
            if (s.sibling > 0) {
                add_result(code.instructions.back(), slot);
                continue;
            }
            Instruction step;
            step.op = s.op;
            step.wide = s.wide || s.op == Op::sine || s.op == Op::cosine || s.op == Op::atan2;
            step.is_positive = s.is_positive;
            if (s.op == Op::lookup) step.table = table(*s.table);
            if (s.op == Op::curve) step.table = curve(*s.curve);
            if (s.op == Op::lattice) step.table = lattice(*s.lattice, step.wide);
            if (s.op == Op::lookup_nonuniform) {
                step.table = static_cast<std::uint32_t>(positioned_.size());
                positioned_.push_back(at_positions(slot, step.wide));
            }
            add_result(step, slot);
            for (std::size_t k = 0; k < 4; ++k) {
                if (s.operands[k] == kNone) continue;
                step.in[k] = operand(static_cast<std::uint32_t>(s.operands[k]), step.wide);
            }
            code.instructions.push_back(step);
        }
        for (std::size_t c = 0; c < 3; ++c) {
            code.output[c] = is_number(tape_[outputs_[c]].op) ? number(outputs_[c], false)
                                                              : place(output_slot_[c]);
        }
        code.numbers.constants = std::move(constants_);
        code.uniforms = std::move(uniforms_);
        code.tables = std::move(tables_);
        code.positioned = std::move(positioned_);
        code.lattices = std::move(lattices_);
        code.curves = std::move(curves_);
        code.is_one_function = is_one_function();
        if (target.machine) code.machine = MachineCode::make(code);
        return code;
    }

    [[nodiscard]] const CurveIndex& curve_index() const { return curve_index_; }

  private:
    /// True when each channel of the result is the same function of that channel alone.
    [[nodiscard]] bool is_one_function() const {
        for (const int channel : {1, 2}) {
            std::map<std::uint32_t, std::uint32_t> counterpart;
            if (!is_same(outputs_[0], outputs_[static_cast<std::size_t>(channel)], channel,
                         counterpart))
                return false;
        }
        return true;
    }
    /// True when value b makes of the channel what value a makes of the first one.
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

    /// One vector full of the constant or the uniform.
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

    /// Where the result goes, and what it is made with.
    void add_result(Instruction& step, std::size_t slot) {
        const Selected& s = steps_[slot];
        const auto n = static_cast<std::size_t>(s.sibling);
        step.out[s.op == Op::lattice ? static_cast<std::size_t>(s.channel) : n] = place(slot);
        std::copy(s.k.begin(), s.k.end(),
                  step.k.begin() + 3 * static_cast<std::ptrdiff_t>(s.sibling));
    }

    static void add(Samples& to, double number, bool is_wide) {
        is_wide ? to.wide.push_back(number) : to.narrow.push_back(static_cast<float>(number));
    }

    /// The tables of a step and of its siblings.
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
        std::vector<std::size_t> part;  // in which each cell begins, as the kernel computes it
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
                // Before the first position, the first sample exactly.
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

    /// Where the form of a source is among all, made where it is the first time.
    template <class Source, class Form, class Make>
    static std::uint32_t find(std::map<const Source*, std::uint32_t>& index, const Source& source,
                              std::vector<Form>& all, const Make& make) {
        const auto [it, is_new] =
            index.try_emplace(&source, static_cast<std::uint32_t>(all.size()));
        if (is_new) all.push_back(make());
        return it->second;
    }

    std::uint32_t lattice(const Lattice& source, bool is_wide) {
        const std::uint32_t found = find(lattice_index_, source, lattices_, [&] {
            return SampledLattice{source.edge(), {}};
        });
        Samples& nodes = lattices_[found].nodes;
        if (!(is_wide ? nodes.wide.empty() : nodes.narrow.empty())) return found;
        for (std::size_t i = 0; i < source.nodes().size(); ++i) {
            add(nodes, source.nodes()[i], is_wide);
            if (i % 3 == 2) add(nodes, 0, is_wide);
        }
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
    std::vector<SampledLattice> lattices_;
    std::map<const Lattice*, std::uint32_t> lattice_index_;
    std::vector<CompiledCurve> curves_;
    CurveIndex curve_index_;
};

/// What a pipeline's programs for the targets of one curve form share.
struct Form {
    std::shared_ptr<const Tape> source;
    FloatTape tape;
    CurveCache curves;  // owns what the tape refers to
    std::vector<bool> in_double;
    std::vector<Selected> selected;

    Code assemble(const Target& target, CurveIndex* curve_index = nullptr) const {
        Assembler assembler(tape, in_double, selected);
        Code code = assembler.assemble(target);
        code.source = source;
        if (curve_index) *curve_index = assembler.curve_index();
        return code;
    }
};

/// The numbers of the tape with uniforms at their ends: with all at the same end, and in turns.
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

std::atomic<std::size_t> compiled_forms = 0;

Form make_form(const Pipeline& pipeline, const LiveUniforms& uniforms, double max_error,
               CurveForm curve_form) {
    ++compiled_forms;
    const bool has_curves = curve_form != CurveForm::none;
    const auto source = std::make_shared<const Tape>(simplify(pipeline), uniforms);
    const FloatTape plain(*source);
    Sensitivity sensitivity;
    const std::vector<std::vector<double>> ends = numbers_at_ends(*source, uniforms);
    if (has_curves) sensitivity = measure_influence(plain.code(), plain.outputs(), ends);
    CurveCache curves;
    while (true) {
        FloatTape tape = plain;
        if (has_curves) tape.fold(sensitivity, curves, curve_form);
        Precision precision = choose_precision(tape.code(), tape.outputs(), max_error, ends);
        // Exact enough where it stands, or compiled again or not at all.
        for (const CompiledCurve* curve : precision.too_coarse)
            reject_curve(curves, curve);
        if (!precision.too_coarse.empty()) continue;
        std::vector<Selected> selected = Selector(tape, precision.in_double).select();
        return {source, std::move(tape), std::move(curves), std::move(precision.in_double),
                std::move(selected)};
    }
}

std::vector<Code> compile_for_all_targets(const Pipeline& pipeline, double max_error) {
    std::map<CurveForm, Form> forms;
    std::vector<Code> codes;
    for (const Target& target : targets()) {
        if (!forms.contains(target.curve_form))
            forms.emplace(target.curve_form, make_form(pipeline, {}, max_error, target.curve_form));
        codes.push_back(forms.at(target.curve_form).assemble(target));
    }
    return codes;
}

}  // namespace

Code compile(const Pipeline& pipeline, double max_error, const Target& target, bool has_curves,
             const LiveUniforms& uniforms) {
    return make_form(pipeline, uniforms, max_error,
                     has_curves ? target.curve_form : CurveForm::none)
        .assemble(target);
}

Steps compile_in_steps(const Pipeline& pipeline, const LiveUniforms& uniforms, double max_error,
                       const Target& target) {
    Form form = make_form(pipeline, uniforms, max_error, target.curve_form);
    Steps steps;
    steps.code = form.assemble(target, &steps.curve_index);
    steps.tape = form.tape.code();
    steps.outputs = form.tape.outputs();
    steps.in_double = std::move(form.in_double);
    steps.curves = std::move(form.curves);
    return steps;
}

std::size_t compilations() noexcept { return compiled_forms; }

void set_uniforms(const Code& code, const std::vector<double>& values, Numbers& numbers) {
    const auto set = [&](const std::vector<UniformPlace>& places, std::vector<ConstantVector>& to) {
        for (const UniformPlace& place : places) {
            const double value = values[place.source];
            fill(reinterpret_cast<unsigned char*>(to.data()) + place.offset, place.bytes,
                 place.is_rounded ? static_cast<double>(static_cast<float>(value)) : value,
                 place.wide);
        }
    };
    set(code.uniforms, numbers.constants);
    if (code.machine) set(code.machine->program().uniforms, numbers.pool);
}

}  // namespace simd

struct SimdEngine::Program {
    std::shared_ptr<const simd::Code> code;
    /// Those of the code, or the code's own where this is empty.
    std::optional<simd::Numbers> numbers;

    explicit Program(simd::Code c) : code(std::make_shared<const simd::Code>(std::move(c))) {}
};

SimdEngine::SimdEngine(std::unique_ptr<const Program> program) : program_(std::move(program)) {}

SimdEngine::SimdEngine(const Pipeline& pipeline, double max_error, std::string_view target)
    : SimdEngine(pipeline, LiveUniforms{}, max_error, target) {}
SimdEngine::SimdEngine(const Pipeline& pipeline, const LiveUniforms& uniforms, double max_error,
                       std::string_view target)
    : program_(std::make_unique<const Program>(
          simd::compile(pipeline, max_error, simd::find_target(target), true, uniforms))) {}
SimdEngine::~SimdEngine() = default;
SimdEngine::SimdEngine(SimdEngine&&) noexcept = default;
SimdEngine& SimdEngine::operator=(SimdEngine&&) noexcept = default;

void SimdEngine::run(const std::array<const float*, 3>& in, std::ptrdiff_t in_stride,
                     const std::array<float*, 3>& out, std::ptrdiff_t out_stride,
                     std::size_t count) const noexcept {
    const Program& program = *program_;
    simd::run(*program.code, program.numbers ? *program.numbers : program.code->numbers, in,
              in_stride, out, out_stride, count);
}

void SimdEngine::run_rgb(const float* in, float* out, std::size_t pixel_count) const noexcept {
    run({in, in + 1, in + 2}, 3, {out, out + 1, out + 2}, 3, pixel_count);
}

SimdEngine SimdEngine::with_uniforms(const UniformValues& values) const {
    const simd::Code& code = *program_->code;
    auto program = std::make_unique<Program>(*program_);
    program->numbers = code.numbers;
    simd::set_uniforms(code, code.source->evaluate_numbers(values), *program->numbers);
    return SimdEngine(std::unique_ptr<const Program>(std::move(program)));
}

std::vector<std::string> SimdEngine::targets() {
    std::vector<std::string> names;
    for (const simd::Target& target : simd::targets())
        names.emplace_back(target.target);
    return names;
}

std::vector<SimdEngine> SimdEngine::of_all_targets(const Pipeline& pipeline, double max_error) {
    std::vector<SimdEngine> engines;
    for (simd::Code& code : simd::compile_for_all_targets(pipeline, max_error)) {
        engines.push_back(SimdEngine(std::make_unique<const Program>(std::move(code))));
    }
    return engines;
}

TONEWRIGHT_NAMESPACE_END
