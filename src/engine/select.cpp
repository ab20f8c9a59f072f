// SPDX-License-Identifier: Apache-2.0
#include "engine/select.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "engine/probe_block.h"
#include "expr/scalar_ops.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace {

/// True if one instruction can compute both: two channels of one grid at one place, two rows of a
/// matrix, two tables with the same positions.
bool are_siblings(const Selected& x, const Selected& y) {
    if (x.op != y.op || x.operands != y.operands) return false;
    switch (x.op) {
        case ProgramOp::grid:
            return x.grid == y.grid;
        case ProgramOp::dot3:
            return true;
        case ProgramOp::lookup_nonuniform:
            return x.table->positions == y.table->positions;
        default:
            return false;
    }
}

/// True if sums and products of the table's positions and slopes do not overflow floats.
bool fits_floats(const Table& table) {
    for (std::size_t i = 0; i < table.positions.size(); ++i) {
        const double slope = i > 0 ? cell_slope(table, i - 1) : 0;
        if (!(std::max(std::fabs(table.positions[i]), std::fabs(slope)) < 1e30)) return false;
    }
    return true;
}

/// The program's operation of the same name.
constexpr ProgramOp same_operation(ExprOp op) {
    const std::string_view name = name_of(op);
    const auto is_same = [name](const Operation& other) { return name == other.name; };
    return static_cast<ProgramOp>(
        std::find_if(std::begin(kOperations), std::end(kOperations), is_same) -
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
    /// @param in_double  see select()
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

    /// Goes from the outputs back to the inputs, and selects for each value the largest pattern
    /// that ends in it.
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
            const bool rounds_before =
                !is_read_in_double_[i] &&
                (current_.op == ProgramOp::clamp || current_.op == ProgramOp::minimum ||
                 current_.op == ProgramOp::maximum || current_.op == ProgramOp::negate ||
                 current_.op == ProgramOp::absolute);
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
    /// Moves up to three siblings next to each other. The operands of all of them are computed
    /// before the first one, because they are the same.
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
            // If one of the siblings is computed in double, all are.
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
    /// True if `op` computes value i and there is only one use of it, so that it can become part of
    /// its user.
    [[nodiscard]] bool absorbs(std::uint32_t i, ExprOp op) const {
        return is(i, op) && uses_[i] == 1;
    }

    /// True if the value is always finite: a sum of multiples of inputs, or a limit of one.
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
    /// True if the value is limited to positive normal floats. It must be finite, because a limit
    /// of NaN is NaN.
    [[nodiscard]] bool is_positive(std::uint32_t i) const {
        const TapeInstruction& step = code_[i];
        constexpr auto kLeast = static_cast<double>(std::numeric_limits<float>::min());
        if (step.op == ExprOp::constant) return step.value >= kLeast;
        if (step.op == ExprOp::maximum)
            return (is_positive(step.a) || is_positive(step.b)) && is_finite(i);
        return step.op == ExprOp::minimum && is_positive(step.a) && is_positive(step.b);
    }

    /// Sets the pattern's instruction. The `absorbed` values become part of it.
    void emit(ProgramOp op, std::initializer_list<std::uint32_t> operands,
              std::initializer_list<std::uint32_t> absorbed = {}) {
        current_.op = op;
        std::size_t n = 0;
        for (const std::uint32_t operand : operands)
            current_.operands[n++] = operand;
        for (const std::uint32_t value : absorbed)
            current_.wide = current_.wide || in_double_[value];
    }

    /// True for a product of a constant k and a value x that is used only once.
    bool is_term(std::uint32_t i, double& k, std::uint32_t& x) const {
        if (!absorbs(i, ExprOp::multiply)) return false;
        const TapeInstruction& step = code_[i];
        if (is_constant(step.a) == is_constant(step.b)) return false;
        k = code_[is_constant(step.a) ? step.a : step.b].value;
        x = is_constant(step.a) ? step.b : step.a;
        return true;
    }

    /// Matches (k0 a + k1 b) + k2 c: a row of a matrix, or a luminance.
    bool match_rows3(const TapeInstruction& sum) {
        if (!absorbs(sum.a, ExprOp::add)) return false;
        const TapeInstruction& first = code_[sum.a];
        std::array<double, 3> k{};
        std::array<std::uint32_t, 3> x{};
        if (!is_term(first.a, k[0], x[0]) || !is_term(first.b, k[1], x[1]) ||
            !is_term(sum.b, k[2], x[2])) {
            return false;
        }
        emit(ProgramOp::dot3, {x[0], x[1], x[2]}, {sum.a, first.a, first.b, sum.b});
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
                    return emit(ProgramOp::multiply_add, {product(b).a, product(b).b, a}, {b});
                }
                if (absorbs(a, ExprOp::multiply)) {
                    return emit(ProgramOp::multiply_add, {product(a).a, product(a).b, b}, {a});
                }
                return emit(ProgramOp::add, {a, b});
            case ExprOp::subtract:
                if (absorbs(b, ExprOp::multiply)) {
                    return emit(ProgramOp::subtract_product, {product(b).a, product(b).b, a}, {b});
                }
                if (absorbs(a, ExprOp::multiply)) {
                    return emit(ProgramOp::multiply_subtract, {product(a).a, product(a).b, b}, {a});
                }
                return emit(ProgramOp::subtract, {a, b});
            case ExprOp::minimum:
                if (absorbs(a, ExprOp::maximum)) {
                    return emit(ProgramOp::clamp, {code_[a].a, code_[a].b, b}, {a});
                }
                return emit(ProgramOp::minimum, {a, b});
            case ExprOp::power:
                if (is_constant(b) && code_[b].value != std::floor(code_[b].value)) {
                    current_.k[0] = code_[b].value;
                    current_.is_positive = is_positive(a);
                    return emit(ProgramOp::power_constant, {a}, {b});
                }
                return emit(ProgramOp::power, {a, b});
            case ExprOp::select: {
                const TapeInstruction& c = code_[a];
                switch (c.op) {
                    case ExprOp::less:
                        return emit(ProgramOp::select_less, {c.a, c.b, b, step.c});
                    case ExprOp::less_equal:
                        return emit(ProgramOp::select_less_equal, {c.a, c.b, b, step.c});
                    case ExprOp::equal:
                        return emit(ProgramOp::select_equal, {c.a, c.b, b, step.c});
                    default:
                        return emit(ProgramOp::select, {a, b, step.c});
                }
            }
            case ExprOp::lookup:
                current_.table = step.table;
                current_.curve = step.curve;
                if (!step.curve && !fits_floats(*step.table)) current_.wide = true;
                return emit(step.curve                      ? ProgramOp::curve
                            : step.table->positions.empty() ? ProgramOp::lookup
                                                            : ProgramOp::lookup_nonuniform,
                            {a});
            case ExprOp::grid:
                current_.grid = step.grid;
                current_.channel = step.input;
                return emit(ProgramOp::grid, {a, b, step.c});
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

}  // namespace

std::vector<Selected> select(const FloatTape& tape, std::vector<bool>& in_double) {
    return Selector(tape, in_double).select();
}

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
