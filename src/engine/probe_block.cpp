// SPDX-License-Identifier: Apache-2.0
#include "engine/probe_block.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "engine/reference_operations.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Row = ProbeBlock::Row;
using OutputRows = ProbeBlock::OutputRows;
constexpr std::size_t kLanes = ProbeBlock::kLanes;

/// Distance from a kink up to which rounding may take either side.
constexpr double kNearKink = 1e-5;

// Compilers unroll such short loops before they look for vector code, so the loops that take the
// time are written with vectors.

/// Vectors that every processor has. A reference to them must not be `auto&`: its type would claim
/// an alignment to their size, which rows do not have. Clang 14 does not align variables of such
/// types where its instructions need it, so it gets vectors of one double: the same bits, slower.
struct Vectors {
#if defined(__clang__)
    using Vector [[gnu::vector_size(8), gnu::may_alias]] = double;
#else
    using Vector [[gnu::vector_size(16), gnu::aligned(8), gnu::may_alias]] = double;
#endif
};
struct Avx2Vectors {
    using Vector [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = double;
};

/// Calls f(i) for each vector of a row.
template <class V, class F>
[[gnu::always_inline]] inline void for_each_part(const F& f) {
    for (std::size_t i = 0; i < kLanes * sizeof(double) / sizeof(typename V::Vector); ++i)
        f(i);
}
template <class V>
[[gnu::always_inline]] inline const typename V::Vector& part(const Row& row, std::size_t i) {
    return reinterpret_cast<const typename V::Vector*>(row.lane.data())[i];
}
template <class V>
[[gnu::always_inline]] inline typename V::Vector& part(Row& row, std::size_t i) {
    return reinterpret_cast<typename V::Vector*>(row.lane.data())[i];
}

/// True if a lane is not 0.
template <class V>
[[gnu::always_inline]] inline bool is_reached(const Row& row) {
    auto any = part<V>(row, 0) != 0;
    for_each_part<V>([&](std::size_t i) { any |= part<V>(row, i) != 0; });
    long long bits = 0;
    for (std::size_t l = 0; l < sizeof(typename V::Vector) / sizeof(double); ++l)
        bits |= any[l];
    return bits != 0;
}

constexpr Row row_of(double x) {
    Row row;
    for (double& lane : row.lane)
        lane = x;
    return row;
}
constexpr Row kZeros = row_of(0);
constexpr Row kOnes = row_of(1);
constexpr Row kMinusOnes = row_of(-1);

/// Derivatives of one instruction by its operands, at the side of a kink that is taken.
struct Partials {
    std::array<const Row*, 3> by{&kZeros, &kZeros, &kZeros};
    std::array<Row, 3> row;  // storage for those that are computed

    /// Sets the derivative of the first n lanes.
    template <class F>
    [[gnu::always_inline]] void set(std::size_t k, std::size_t n, const F& f) {
        for (std::size_t l = 0; l < n; ++l)
            row[k].lane[l] = f(l);
        by[k] = &row[k];
    }
    /// Sets the derivative vector by vector. f writes each one, because functions that return
    /// vectors would need AVX to be called.
    template <class V, class F>
    [[gnu::always_inline]] void set(std::size_t k, const F& f) {
        for_each_part<V>([&](std::size_t i) { f(i, part<V>(row[k], i)); });
        by[k] = &row[k];
    }
};

/// @param n          number of lanes
/// @param of_second  false: the derivative by the second operand is not needed
template <class V>
[[gnu::always_inline]] inline void differentiate(const TapeInstruction& step, std::size_t n,
                                                 bool of_second, const Row& value, const Row& first,
                                                 const Row& second, const Row& third,
                                                 Partials& partials) {
    using Vector = typename V::Vector;
    const auto& a = first.lane;
    const auto& b = second.lane;
    const auto& c = third.lane;
    const auto y = [&](std::size_t i) -> const Vector& { return part<V>(value, i); };
    const auto x0 = [&](std::size_t i) -> const Vector& { return part<V>(first, i); };
    const auto x1 = [&](std::size_t i) -> const Vector& { return part<V>(second, i); };
    const Vector zero = {};
    const Vector one = zero + 1.0;
    // For minimum and maximum: the second operand is the result if `low` is below `high`. Near the
    // kink, rounding may take either side, so both derivatives are 1.
    const auto set_sides = [&](const Row& low, const Row& high) {
        const auto set = [&](std::size_t k) {
            partials.set<V>(k, [&](std::size_t i, Vector& out) {
                const Vector lower = part<V>(low, i);
                const Vector higher = part<V>(high, i);
                const auto takes_second = lower < higher;
                const auto is_near = (lower - higher < kNearKink) & (higher - lower < kNearKink);
                out = (is_near | (k == 0 ? ~takes_second : takes_second)) ? one : zero;
            });
        };
        set(0);
        set(1);
    };
    switch (step.op) {
        case ExprOp::add:
            partials.by = {&kOnes, &kOnes};
            return;
        case ExprOp::subtract:
            partials.by = {&kOnes, &kMinusOnes};
            return;
        case ExprOp::multiply:
            partials.by = {&second, &first};
            return;
        case ExprOp::divide:
            partials.set<V>(0, [&](std::size_t i, Vector& out) { out = 1.0 / x1(i); });
            return partials.set<V>(1, [&](std::size_t i, Vector& out) { out = -y(i) / x1(i); });
        case ExprOp::minimum:
            return set_sides(second, first);
        case ExprOp::maximum:
            return set_sides(first, second);
        case ExprOp::power:
            partials.set(0, n, [&](std::size_t l) { return b[l] * std::pow(a[l], b[l] - 1); });
            if (!of_second) return;
            return partials.set(1, n, [&](std::size_t l) {
                return a[l] > 0 ? value.lane[l] * std::log(a[l]) : 0.0;
            });
        case ExprOp::atan2:
            partials.set<V>(0, [&](std::size_t i, Vector& out) {
                out = x1(i) / (x0(i) * x0(i) + x1(i) * x1(i));
            });
            return partials.set<V>(1, [&](std::size_t i, Vector& out) {
                out = -x0(i) / (x0(i) * x0(i) + x1(i) * x1(i));
            });
        case ExprOp::negate:
            partials.by[0] = &kMinusOnes;
            return;
        case ExprOp::absolute:
            return partials.set<V>(
                0, [&](std::size_t i, Vector& out) { out = x0(i) < 0 ? -one : one; });
        case ExprOp::square_root:
            return partials.set<V>(0, [&](std::size_t i, Vector& out) { out = 0.5 / y(i); });
        case ExprOp::exp2:
            return partials.set<V>(
                0, [&](std::size_t i, Vector& out) { out = y(i) * std::numbers::ln2; });
        case ExprOp::log2:
            return partials.set<V>(
                0, [&](std::size_t i, Vector& out) { out = 1.0 / (x0(i) * std::numbers::ln2); });
        case ExprOp::sine:
            return partials.set(0, n, [&](std::size_t l) { return std::cos(a[l]); });
        case ExprOp::cosine:
            return partials.set(0, n, [&](std::size_t l) { return -std::sin(a[l]); });
        case ExprOp::select:
            partials.by[0] = &kZeros;
            partials.set<V>(1, [&](std::size_t i, Vector& out) { out = x0(i) != 0 ? one : zero; });
            return partials.set<V>(
                2, [&](std::size_t i, Vector& out) { out = x0(i) != 0 ? zero : one; });
        case ExprOp::lookup:
            return partials.set(0, n, [&](std::size_t l) {
                return step.curve ? step.curve->slope(a[l]) : table_slope(*step.table, a[l]);
            });
        case ExprOp::grid:
            for (std::size_t l = 0; l < n; ++l) {
                const std::array<double, 3> slope =
                    step.grid->gradient(step.input, a[l], b[l], c[l]);
                for (std::size_t k = 0; k < 3; ++k)
                    partials.row[k].lane[l] = slope[k];
            }
            partials.by = {&partials.row[0], &partials.row[1], &partials.row[2]};
            return;
        case ExprOp::constant:
        case ExprOp::input:
        case ExprOp::less:
        case ExprOp::less_equal:
        case ExprOp::equal:
        case ExprOp::floor:
        case ExprOp::uniform:
            partials.by = {&kZeros, &kZeros, &kZeros};
            return;
    }
}

/// Data for the way from the outputs back to the inputs.
struct BackwardPass {
    const std::vector<TapeInstruction>& code;
    const std::vector<std::uint32_t>& computed;
    std::size_t n;  // number of lanes
    const Row* value;
    OutputRows* adjoint;
    OutputRows* has_pole;  // null: not recorded
};

template <class V>
[[gnu::always_inline]] inline void run_with(const BackwardPass& pass) {
    Partials partials;
    for (auto it = pass.computed.rbegin(); it != pass.computed.rend(); ++it) {
        const TapeInstruction& step = pass.code[*it];
        const auto operands = static_cast<std::size_t>(operand_count(step.op));
        if (operands == 0) continue;
        const OutputRows& here = pass.adjoint[*it];
        std::array<bool, 3> reaches{};
        for (std::size_t o = 0; o < 3; ++o)
            reaches[o] = is_reached<V>(here[o]);
        if (!reaches[0] && !reaches[1] && !reaches[2]) continue;
        // Kernels take a constant exponent in double, so it has no rounding error.
        const bool of_second = step.op != ExprOp::power || pass.code[step.b].op != ExprOp::constant;
        differentiate<V>(step, pass.n, of_second, pass.value[*it], pass.value[step.a],
                         pass.value[step.b], pass.value[step.c], partials);
        const std::array<std::uint32_t, 3> operand = {step.a, step.b, step.c};
        for (std::size_t k = 0; k < operands; ++k) {
            if (k == 1 && !of_second) continue;
            const Row& by = *partials.by[k];
            for (std::size_t o = 0; o < 3; ++o) {
                if (!reaches[o]) continue;
                Row& to = pass.adjoint[operand[k]][o];
                for_each_part<V>([&](std::size_t i) {
                    const auto added = part<V>(here[o], i) * part<V>(by, i);
                    part<V>(to, i) +=
                        added - added == 0 ? added : typename V::Vector{};  // not at a pole
                });
                if (!pass.has_pole) continue;
                Row& pole = pass.has_pole[operand[k]][o];
                for (std::size_t l = 0; l < pass.n; ++l) {
                    const double added = here[o].lane[l] * by.lane[l];
                    if (here[o].lane[l] != 0 && !std::isfinite(added)) pole.lane[l] = 1;
                }
            }
        }
    }
}

template <class V>
[[gnu::always_inline]] inline void add_squares_with(const OutputRows& adjoint, const Row& error,
                                                    OutputRows& sums) {
    for (std::size_t o = 0; o < 3; ++o) {
        for_each_part<V>([&](std::size_t i) {
            const auto share = part<V>(adjoint[o], i) * part<V>(error, i);
            const auto square = share * share;
            part<V>(sums[o], i) +=
                square == square ? square : typename V::Vector{};  // NaN counts as 0
        });
    }
}

template <class V>
[[gnu::always_inline]] inline void add_roundings_with(const OutputRows& adjoint, const Row& value,
                                                      double half_ulps, OutputRows& sums) {
    Row error;
    for_each_part<V>([&](std::size_t i) {
        const typename V::Vector v = part<V>(value, i);
        const auto unit = ProbeBlock::kHalfUlp * (v < 0 ? -v : v);
        const auto least = typename V::Vector{} + ProbeBlock::kSmallestStep;
        part<V>(error, i) = half_ulps * (unit < least ? least : unit);
    });
    add_squares_with<V>(adjoint, error, sums);
}

/// Largest finite magnitude in each lane.
template <class V>
[[gnu::always_inline]] inline Row largest_with(const std::vector<Row>& rows) {
    Row largest;
    for (const Row& row : rows) {
        for_each_part<V>([&](std::size_t i) {
            const auto value = part<V>(row, i);
            const auto size = value < 0 ? -value : value;
            const auto finite = size - size == 0 ? size : typename V::Vector{};
            part<V>(largest, i) = finite > part<V>(largest, i) ? finite : part<V>(largest, i);
        });
    }
    return largest;
}

struct Functions {
    void (*run_backwards)(const BackwardPass& pass);
    void (*add_squares)(const OutputRows& adjoint, const Row& error, OutputRows& sums);
    void (*add_roundings)(const OutputRows& adjoint, const Row& value, double half_ulps,
                          OutputRows& sums);
    Row (*largest)(const std::vector<Row>& rows);
};

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
// AVX2 has no fused multiply-add, so the bits are the same.
[[gnu::target("avx2")]] void run_on_avx2(const BackwardPass& pass) { run_with<Avx2Vectors>(pass); }
[[gnu::target("avx2")]] void add_squares_on_avx2(const OutputRows& adjoint, const Row& error,
                                                 OutputRows& sums) {
    add_squares_with<Avx2Vectors>(adjoint, error, sums);
}
[[gnu::target("avx2")]] void add_roundings_on_avx2(const OutputRows& adjoint, const Row& value,
                                                   double half_ulps, OutputRows& sums) {
    add_roundings_with<Avx2Vectors>(adjoint, value, half_ulps, sums);
}
[[gnu::target("avx2")]] Row largest_on_avx2(const std::vector<Row>& rows) {
    return largest_with<Avx2Vectors>(rows);
}
#endif

const Functions& functions() {
    static const Functions best = [] {
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
        if (__builtin_cpu_supports("avx2"))
            return Functions{run_on_avx2, add_squares_on_avx2, add_roundings_on_avx2,
                             largest_on_avx2};
#endif
        return Functions{run_with<Vectors>, add_squares_with<Vectors>, add_roundings_with<Vectors>,
                         largest_with<Vectors>};
    }();
    return best;
}

/// The cell of x; nullopt if the table is constant there.
std::optional<std::size_t> sloping_cell(const Table& table, double x) {
    if (table.interpolation == Table::Interpolation::step || table.samples.size() < 2) return {};
    const std::size_t cells = table.samples.size() - 1;
    if (!(x > cell_begin(table, 0) && x < cell_begin(table, cells))) return {};
    if (table.positions.empty())
        return std::min(static_cast<std::size_t>(x * static_cast<double>(cells)), cells - 1);
    const auto next = std::upper_bound(table.positions.begin(), table.positions.end(), x);
    return static_cast<std::size_t>(next - table.positions.begin()) - 1;
}

}  // namespace

double cell_begin(const Table& table, std::size_t i) {
    return table.positions.empty()
               ? static_cast<double>(i) / static_cast<double>(table.samples.size() - 1)
               : table.positions[i];
}

double cell_slope(const Table& table, std::size_t i) {
    return (table.samples[i + 1] - table.samples[i]) /
           (cell_begin(table, i + 1) - cell_begin(table, i));
}

double table_slope(const Table& table, double x) {
    const std::optional<std::size_t> cell = sloping_cell(table, x);
    return cell ? cell_slope(table, *cell) : 0;
}

double table_rise(const Table& table, double x) {
    const std::optional<std::size_t> cell = sloping_cell(table, x);
    return cell ? cell_slope(table, *cell) * (x - cell_begin(table, *cell)) : 0;
}

ProbeBlock::ProbeBlock(const std::vector<TapeInstruction>& code,
                       const std::array<std::uint32_t, 3>& outputs, bool has_poles)
    : code_(code),
      outputs_(outputs),
      value_(code.size()),
      adjoint_(code.size()),
      has_pole_(has_poles ? code.size() : 0) {
    for (std::uint32_t i = 0; i < code.size(); ++i) {
        if (is_number(code[i].op)) {
            value_[i].lane.fill(code[i].value);
        } else {
            computed_.push_back(i);
        }
    }
}

bool ProbeBlock::set_uniforms(double TapeInstruction::*from) {
    bool has_uniforms = false;
    for (std::size_t i = 0; i < code_.size(); ++i) {
        if (code_[i].op != ExprOp::uniform) continue;
        value_[i].lane.fill(code_[i].*from);
        has_uniforms = true;
    }
    return has_uniforms;
}

void ProbeBlock::set_uniforms(const std::vector<double>& values) {
    for (std::size_t i = 0; i < code_.size(); ++i) {
        if (code_[i].op == ExprOp::uniform) value_[i].lane.fill(values[code_[i].source]);
    }
}

void ProbeBlock::evaluate(const Vector3* colors, std::size_t n) { evaluate(colors, n, computed_); }

void ProbeBlock::evaluate(const Vector3* colors, std::size_t n,
                          const std::vector<std::uint32_t>& steps) {
    size_ = n;
    for (const std::uint32_t i : steps)
        run(i, colors);
}

void ProbeBlock::run(std::uint32_t i, const Vector3* colors) {
    static const RunInstruction run_instruction = reference_operations();
    const TapeInstruction& step = code_[i];
    auto& out = value_[i].lane;
    const auto& a = value_[step.a].lane;
    const auto& b = value_[step.b].lane;
    const auto& c = value_[step.c].lane;
    if (step.op == ExprOp::input) {
        // Probe colors are colors after the exposure.
        const double exposure = step.is_limited ? 1 : step.value;
        for (std::size_t l = 0; l < size_; ++l)
            out[l] = colors[l][static_cast<std::size_t>(step.input)] / exposure;
    } else if (step.op == ExprOp::grid) {
        for (std::size_t l = 0; l < size_; ++l)
            out[l] = (*step.grid)(step.input, a[l], b[l], c[l]);
    } else if (step.curve) {
        for (std::size_t l = 0; l < size_; ++l)
            out[l] = (*step.curve)(a[l]);
    } else {
        run_instruction(step, out.data(), a.data(), b.data(), c.data(), size_);
    }
}

void ProbeBlock::differentiate() {
    std::fill(adjoint_.begin(), adjoint_.end(), OutputRows{});
    std::fill(has_pole_.begin(), has_pole_.end(), OutputRows{});
    for (std::size_t o = 0; o < 3; ++o) {
        for (std::size_t l = 0; l < size_; ++l)
            adjoint_[outputs_[o]][o].lane[l] = 1 / std::max(1.0, std::fabs(value(outputs_[o], l)));
    }
    functions().run_backwards({code_, computed_, size_, value_.data(), adjoint_.data(),
                               has_pole_.empty() ? nullptr : has_pole_.data()});
}

Row ProbeBlock::largest_values() const { return functions().largest(value_); }

void ProbeBlock::add_squares(std::size_t i, const Row& error, OutputRows& sums) const {
    functions().add_squares(adjoint_[i], error, sums);
}

void ProbeBlock::add_squares(std::size_t i, double half_ulps, OutputRows& sums) const {
    functions().add_roundings(adjoint_[i], value_[i], half_ulps, sums);
}

TONEWRIGHT_NAMESPACE_END
