// SPDX-License-Identifier: Apache-2.0
#include "engine/gradient.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/reference_operations.h"
#include "expr/grid_place.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Pixels of a tile. All steps (hundreds for ACES 2.0) are read once for each tile, so longer tiles
/// are faster as long as the live values, 4 KiB each, stay in the second-level cache.
constexpr std::size_t kTile = 128;
/// A value and its derivatives by three inputs.
constexpr std::size_t kRows = 4;

constexpr std::array<double, kTile> kZeros{};

double slope_of(const Table& table, double x) {
    const std::vector<double>& at = table.positions;
    const std::vector<double>& y = table.samples;
    if (table.interpolation == Table::Interpolation::step || y.size() < 2) return 0;
    const double first = at.empty() ? 0 : at.front();
    const double last = at.empty() ? 1 : at.back();
    if (!(x >= first && x <= last)) return 0;
    if (at.empty()) {
        const auto n = static_cast<double>(y.size() - 1);
        const std::size_t i = std::min(static_cast<std::size_t>(x * n), y.size() - 2);
        return (y[i + 1] - y[i]) * n;
    }
    const auto above =
        static_cast<std::size_t>(std::upper_bound(at.begin(), at.end(), x) - at.begin());
    const std::size_t i = std::min(above, at.size() - 1) - 1;
    return (y[i + 1] - y[i]) / (at[i + 1] - at[i]);
}

/// Rows of a step: its value, its operands, and the derivatives of each operand by three inputs.
struct Rows {
    double* y;
    std::array<const double*, 3> x;
    std::array<std::array<const double*, 3>, 3> dx;  // [input][operand]
    std::array<double*, 3> dy;  // null: the value does not depend on that input
};

using Row = std::array<double, kTile>;

/// Sets dy[i] = f(da, db, dc, i) for each input that the value depends on.
template <class F>
[[gnu::always_inline]] inline void fill(const Rows& rows, std::size_t n, const F& f) {
    for (std::size_t k = 0; k < 3; ++k) {
        double* const dy = rows.dy[k];
        if (!dy) continue;
        const auto [da, db, dc] = rows.dx[k];
        for (std::size_t i = 0; i < n; ++i)
            dy[i] = f(da, db, dc, i);
    }
}

/// Sets dy[i] = da[i] slope(i). A slope that is not finite counts as 0.
template <class F>
[[gnu::always_inline]] inline void chain(const Rows& rows, std::size_t n, const F& slope) {
    Row factor{};
    for (std::size_t i = 0; i < n; ++i) {
        const double d = slope(i);
        factor[i] = std::fabs(d) <= std::numeric_limits<double>::max() ? d : 0.0;
    }
    fill(rows, n, [&](const double* da, const double*, const double*, std::size_t i) {
        return factor[i] * da[i];
    });
}

/// A channel of a grid and its derivatives.
void run_grid(const TapeInstruction& step, const Rows& rows, std::size_t n) {
    const auto [a, b, c] = rows.x;
    const auto channel = static_cast<std::size_t>(step.input);
    const double* const nodes = step.grid->nodes().data() + channel;
    const int edge = step.grid->edge();
    std::array<Row, 3> slope{};
    for (std::size_t i = 0; i < n; ++i) {
        const std::array<double, 3> at = {a[i], b[i], c[i]};
        const GridPlace place(edge, at);
        rows.y[i] = place.interpolate(nodes);
        const std::array<double, 3> d = place.gradient(nodes, edge, at);
        for (std::size_t k = 0; k < 3; ++k)
            slope[k][i] = d[k];
    }
    fill(rows, n, [&](const double* da, const double* db, const double* dc, std::size_t i) {
        return slope[0][i] * da[i] + slope[1][i] * db[i] + slope[2][i] * dc[i];
    });
}

/// @param moves_b  false: the second operand depends on no input
[[gnu::always_inline]] inline void differentiate_with_any_target(const TapeInstruction& step,
                                                                 bool moves_b, const Rows& rows,
                                                                 std::size_t n) {
    using D = const double*;
    using I = std::size_t;
    const D a = rows.x[0];
    const D b = rows.x[1];
    const D y = rows.y;
    switch (step.op) {
        case ExprOp::add:
            return fill(rows, n, [&](D da, D db, D, I i) { return da[i] + db[i]; });
        case ExprOp::subtract:
            return fill(rows, n, [&](D da, D db, D, I i) { return da[i] - db[i]; });
        case ExprOp::multiply:
            return fill(rows, n, [&](D da, D db, D, I i) { return da[i] * b[i] + a[i] * db[i]; });
        case ExprOp::divide: {
            Row factor{};
            for (std::size_t i = 0; i < n; ++i)
                factor[i] = b[i] != 0 ? 1 / b[i] : 0;
            return fill(rows, n,
                        [&](D da, D db, D, I i) { return (da[i] - y[i] * db[i]) * factor[i]; });
        }
        case ExprOp::minimum:
            return fill(rows, n, [&](D da, D db, D, I i) { return b[i] < a[i] ? db[i] : da[i]; });
        case ExprOp::maximum:
            return fill(rows, n, [&](D da, D db, D, I i) { return a[i] < b[i] ? db[i] : da[i]; });
        case ExprOp::power: {
            if (!moves_b) return chain(rows, n, [&](I i) { return b[i] * y[i] / a[i]; });
            Row log_a{};
            for (std::size_t i = 0; i < n; ++i)
                log_a[i] = a[i] > 0 ? std::log(a[i]) : 0;
            return fill(rows, n, [&](D da, D db, D, I i) {
                return a[i] != 0 ? y[i] * (da[i] * b[i] / a[i] + log_a[i] * db[i]) : 0.0;
            });
        }
        case ExprOp::atan2:
            return fill(rows, n, [&](D da, D db, D, I i) {
                const double square = a[i] * a[i] + b[i] * b[i];
                return square > 0 ? (da[i] * b[i] - a[i] * db[i]) / square : 0.0;
            });
        case ExprOp::negate:
            return fill(rows, n, [&](D da, D, D, I i) { return -da[i]; });
        case ExprOp::absolute:
            return fill(rows, n, [&](D da, D, D, I i) { return a[i] < 0 ? -da[i] : da[i]; });
        case ExprOp::square_root:
            return chain(rows, n, [&](I i) { return 0.5 / y[i]; });
        case ExprOp::exp2:
            return chain(rows, n, [&](I i) { return y[i] * std::numbers::ln2; });
        case ExprOp::log2:
            return chain(rows, n, [&](I i) { return 1 / (a[i] * std::numbers::ln2); });
        case ExprOp::sine:
            return chain(rows, n, [&](I i) { return std::cos(a[i]); });
        case ExprOp::cosine:
            return chain(rows, n, [&](I i) { return -std::sin(a[i]); });
        case ExprOp::select:
            return fill(rows, n, [&](D, D db, D dc, I i) { return a[i] != 0 ? db[i] : dc[i]; });
        case ExprOp::lookup:
            return chain(rows, n, [&](I i) { return slope_of(*step.table, a[i]); });
        case ExprOp::less:
        case ExprOp::less_equal:
        case ExprOp::equal:
        case ExprOp::floor:
        case ExprOp::constant:
        case ExprOp::input:
        case ExprOp::grid:
        case ExprOp::uniform:
            return;
    }
}

void differentiate_on_baseline(const TapeInstruction& step, bool moves_b, const Rows& rows,
                               std::size_t n) {
    differentiate_with_any_target(step, moves_b, rows, n);
}

#if defined(__x86_64__) && defined(__GNUC__)
/// AVX2 has no fused multiply-add, so the bits are the same.
[[gnu::target("avx2")]] void differentiate_on_avx2(const TapeInstruction& step, bool moves_b,
                                                   const Rows& rows, std::size_t n) {
    differentiate_with_any_target(step, moves_b, rows, n);
}
#endif

auto differentiate_here() {
#if defined(__x86_64__) && defined(__GNUC__)
    static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
    if (has_avx2) return differentiate_on_avx2;
#endif
    return differentiate_on_baseline;
}

bool is_level(ExprOp op) {
    return op == ExprOp::less || op == ExprOp::less_equal || op == ExprOp::equal ||
           op == ExprOp::floor || op == ExprOp::constant;
}

}  // namespace

GradientEngine::GradientEngine(const Pipeline& pipeline) : tape_(pipeline) {
    const std::vector<TapeInstruction>& code = tape_.code();
    const auto operands = [](const TapeInstruction& step) {
        std::vector<std::uint32_t> read = {step.a, step.b, step.c};
        read.resize(static_cast<std::size_t>(operand_count(step.op)));
        return read;
    };
    std::vector<std::size_t> last_use(code.size(), 0);
    for (std::size_t i = 0; i < code.size(); ++i) {
        for (const std::uint32_t x : operands(code[i]))
            last_use[x] = i;
    }
    for (const std::uint32_t x : tape_.outputs())
        last_use[x] = code.size();
    std::vector<std::size_t> free;
    for (std::size_t i = 0; i < code.size(); ++i) {
        // The functions of users run here, and not in a pass over colors.
        if (code[i].grid) (void)code[i].grid->nodes();
        Step step{.instruction = code[i]};
        const std::vector<std::uint32_t> read = operands(code[i]);
        for (std::size_t k = 0; k < 3; ++k) {
            // The first operand replaces operands that the operation does not have.
            const std::size_t x = k < read.size() ? read[k] : read.empty() ? i : read[0];
            if (x == i) continue;
            step.in[k] = steps_[x].out;
            if (k >= read.size()) continue;
            step.operand_inputs[k] = steps_[x].inputs;
            if (!is_level(code[i].op)) step.inputs |= steps_[x].inputs;
        }
        if (code[i].op == ExprOp::input) step.inputs = 1U << static_cast<unsigned>(code[i].input);
        // The register is not one of the operands': their values are read after this value is
        // written.
        if (free.empty()) {
            step.out = register_count_++;
        } else {
            step.out = free.back();
            free.pop_back();
        }
        steps_.push_back(step);
        for (std::size_t k = 0; k < read.size(); ++k) {
            const auto here = read.begin() + static_cast<std::ptrdiff_t>(k);
            const bool is_first = std::find(read.begin(), here, read[k]) == here;
            if (last_use[read[k]] == i && is_first) free.push_back(steps_[read[k]].out);
        }
    }
    for (std::size_t c = 0; c < 3; ++c)
        outputs_[c] = tape_.outputs()[c];
}

void GradientEngine::run(const std::array<const double*, 3>& in, const std::array<double*, 3>& out,
                         const std::array<std::array<double*, 3>, 3>& slope,
                         std::size_t count) const {
    const RunInstruction run_instruction = reference_operations();
    const auto differentiate = differentiate_here();
    std::vector<double> registers(register_count_ * kRows * kTile);
    const auto row = [&](std::size_t value, std::size_t k) {
        return registers.data() + (value * kRows + k) * kTile;
    };
    for (std::size_t begin = 0; begin < count; begin += kTile) {
        const std::size_t n = std::min(kTile, count - begin);
        for (const Step& step : steps_) {
            const TapeInstruction& instruction = step.instruction;
            double* const y = row(step.out, 0);
            if (instruction.op == ExprOp::constant) {
                std::fill_n(y, n, instruction.value);
                continue;
            }
            if (instruction.op == ExprOp::input) {
                const auto k = static_cast<std::size_t>(instruction.input);
                for (std::size_t i = 0; i < n; ++i)
                    y[i] = instruction.is_limited ? sanitize(in[k][begin + i])
                                                  : without_nan(in[k][begin + i]);
                std::fill_n(row(step.out, 1 + k), n, 1.0);
                continue;
            }
            Rows rows{y, {row(step.in[0], 0), row(step.in[1], 0), row(step.in[2], 0)}, {}, {}};
            for (std::size_t k = 0; k < 3; ++k) {
                if ((step.inputs >> k & 1) == 0) continue;
                rows.dy[k] = row(step.out, 1 + k);
                for (std::size_t x = 0; x < 3; ++x) {
                    rows.dx[k][x] =
                        step.operand_inputs[x] >> k & 1 ? row(step.in[x], 1 + k) : kZeros.data();
                }
            }
            if (instruction.op == ExprOp::grid) {
                run_grid(instruction, rows, n);
                continue;
            }
            run_instruction(instruction, y, rows.x[0], rows.x[1], rows.x[2], n);
            if (step.inputs != 0) differentiate(instruction, step.operand_inputs[1] != 0, rows, n);
        }
        for (std::size_t c = 0; c < 3; ++c) {
            const Step& last = steps_[outputs_[c]];
            std::copy_n(row(last.out, 0), n, out[c] + begin);
            for (std::size_t k = 0; k < 3; ++k) {
                const bool moves = last.inputs >> k & 1;
                std::copy_n(moves ? row(last.out, 1 + k) : kZeros.data(), n, slope[c][k] + begin);
            }
        }
    }
}

TONEWRIGHT_NAMESPACE_END
