// SPDX-License-Identifier: Apache-2.0
#include "engine/precision.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.h"
#include "expr/scalar_ops.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Half a unit in the last place of 1 in float.
constexpr double kHalfUlp = 0x1p-24;
/// Half the smallest denormal.
constexpr double kSmallestStep = 0x1p-150;

/// Colors where roundings show: grays, colors of all saturations and signs, and the extremes.
std::vector<Vector3> probe_colors() {
    std::vector<Vector3> probes;
    SampleRandom random(7);
    const auto add = [&](double r, double g, double b) {
        const auto rounded = [](double x) {
            return static_cast<double>(static_cast<float>(std::clamp(x, -kHalfMax, kHalfMax)));
        };
        probes.push_back({rounded(r), rounded(g), rounded(b)});
    };
    const auto log_uniform = [&](double lo, double hi) {
        return std::exp2(random.uniform(lo, hi));
    };

    for (double stops = -20; stops <= 16; stops += 0.5) {
        const double gray = std::exp2(stops);
        add(gray, gray, gray);
    }
    for (int i = 0; i < 700; ++i) {  // a brightness, and channels up to 8 stops below it
        const double peak = log_uniform(-10, 14);
        Vector3 v = {peak * log_uniform(-8, 0), peak * log_uniform(-8, 0),
                     peak * log_uniform(-8, 0)};
        const auto k = static_cast<std::size_t>(i);
        if (i % 5 == 0) v[k / 5 % 3] = 0;
        if (i % 7 == 0) v[k / 7 % 3] = peak;
        add(v[0], v[1], v[2]);
    }
    for (std::size_t i = 0; i < 700; ++i) {  // mixed signs
        Vector3 v = {log_uniform(-12, 16), log_uniform(-12, 16), log_uniform(-12, 16)};
        v[i % 3] *= -1;
        if (i % 2) v[(i + 1) % 3] *= -1;
        add(v[0], v[1], v[2]);
    }
    for (int i = 0; i < 500; ++i) {  // of wider gamuts, where rows cancel nearly, not wholly
        const double peak = log_uniform(-6, 6);
        // One statement for each channel: compilers evaluate arguments in different orders.
        const double b = peak * random.uniform(-0.3, 1);
        const double g = peak * random.uniform(-0.3, 1);
        const double r = peak * random.uniform(-0.3, 1);
        add(r, g, b);
    }
    for (std::size_t i = 0; i < 120; ++i) {
        Vector3 v = {log_uniform(-149, -20), log_uniform(-149, -20), log_uniform(-149, -20)};
        add(v[0], v[1], v[2]);
        // A small power of the ratio of two channels is not small, however small the ratio.
        v[i % 3] = log_uniform(-8, 16);
        add(v[0], v[1], v[2]);
    }
    for (const double r : {-kHalfMax, 0.0, kHalfMax}) {
        for (const double g : {-kHalfMax, 0.0, kHalfMax}) {
            for (const double b : {-kHalfMax, 0.0, kHalfMax})
                add(r, g, b);
        }
    }
    return probes;
}

/// Where cell i of a table with two samples or more begins.
double cell_begin(const Table& table, std::size_t i) {
    return table.positions.empty()
               ? static_cast<double>(i) / static_cast<double>(table.samples.size() - 1)
               : table.positions[i];
}

double cell_slope(const Table& table, std::size_t i) {
    return (table.samples[i + 1] - table.samples[i]) /
           (cell_begin(table, i + 1) - cell_begin(table, i));
}

double slope(const Table& table, double x) {
    if (table.interpolation == Table::Interpolation::step || table.samples.size() < 2) return 0;
    const std::size_t cells = table.samples.size() - 1;
    if (!(x > cell_begin(table, 0) && x < cell_begin(table, cells))) return 0;
    if (table.positions.empty()) {
        return cell_slope(
            table, std::min(static_cast<std::size_t>(x * static_cast<double>(cells)), cells - 1));
    }
    const auto next = std::upper_bound(table.positions.begin(), table.positions.end(), x);
    return cell_slope(table, static_cast<std::size_t>(next - table.positions.begin()) - 1);
}

/// A cell of it is so steep that a float's half unit in the last place of the index is a good part
/// of the budget.
bool is_steep(const Table& table, double max_error) {
    if (table.interpolation == Table::Interpolation::step) return false;
    for (std::size_t i = 0; i + 1 < table.samples.size(); ++i) {
        const double reach =
            std::max(std::fabs(cell_begin(table, i)), std::fabs(cell_begin(table, i + 1)));
        if (!(std::fabs(cell_slope(table, i)) * reach * kHalfUlp < max_error / 8)) return true;
    }
    return false;
}

/// Nearer to a kink than this, either side may be taken.
constexpr double kNearKink = 1e-5;

/// Derivatives of one instruction by its operands, at the side of a kink that is taken.
std::array<double, 3> partials(const TapeInstruction& step, double value, double a, double b,
                               double c) {
    constexpr double kLn2 = 0.69314718055994531;
    switch (step.op) {
        case ExprOp::add:
            return {1, 1, 0};
        case ExprOp::subtract:
            return {1, -1, 0};
        case ExprOp::multiply:
            return {b, a, 0};
        case ExprOp::divide:
            return {1 / b, -value / b, 0};
        case ExprOp::minimum:
            // So near to the kink either side may be taken, and what rounding adds shows.
            if (std::fabs(a - b) < kNearKink) return {1, 1, 0};
            return b < a ? std::array{0.0, 1.0, 0.0} : std::array{1.0, 0.0, 0.0};
        case ExprOp::maximum:
            if (std::fabs(a - b) < kNearKink) return {1, 1, 0};
            return a < b ? std::array{0.0, 1.0, 0.0} : std::array{1.0, 0.0, 0.0};
        case ExprOp::power:
            return {b * std::pow(a, b - 1), a > 0 ? value * std::log(a) : 0, 0};
        case ExprOp::atan2:
            return {b / (a * a + b * b), -a / (a * a + b * b), 0};
        case ExprOp::negate:
            return {-1, 0, 0};
        case ExprOp::absolute:
            return {a < 0 ? -1.0 : 1.0, 0, 0};
        case ExprOp::square_root:
            return {0.5 / value, 0, 0};
        case ExprOp::exp2:
            return {value * kLn2, 0, 0};
        case ExprOp::log2:
            return {1 / (a * kLn2), 0, 0};
        case ExprOp::sine:
            return {std::cos(a), 0, 0};
        case ExprOp::cosine:
            return {-std::sin(a), 0, 0};
        case ExprOp::select:
            return a != 0 ? std::array{0.0, 1.0, 0.0} : std::array{0.0, 0.0, 1.0};
        case ExprOp::lookup:
            return {step.curve ? step.curve->slope(a) : slope(*step.table, a), 0, 0};
        case ExprOp::lattice:
            return step.lattice->gradient(step.input, a, b, c);
        default:
            return {0, 0, 0};
    }
}

/// The result is one of the operands, exactly, or a whole number.
bool is_exact(ExprOp op) {
    switch (op) {
        case ExprOp::input:
        case ExprOp::minimum:
        case ExprOp::maximum:
        case ExprOp::less:
        case ExprOp::less_equal:
        case ExprOp::equal:
        case ExprOp::negate:
        case ExprOp::absolute:
        case ExprOp::floor:
        case ExprOp::select:
            return true;
        default:
            return false;
    }
}

bool is_branch(ExprOp op) {
    return op == ExprOp::minimum || op == ExprOp::maximum || op == ExprOp::absolute ||
           op == ExprOp::select;
}

/// Bound of the kernel's float error in half units in the last place (see simd_math-inl.h).
double half_ulps(ExprOp op) {
    switch (op) {
        case ExprOp::exp2:
        case ExprOp::log2:
            return 2;
        case ExprOp::power:
        case ExprOp::lookup:
            return 3;
        case ExprOp::lattice:  // nodes, weights, and a sum of four products
            return 4;
        default:
            return 1;
    }
}

/// What computing an operation in double costs over float, roughly.
double cost_of_double(ExprOp op) {
    switch (op) {
        case ExprOp::exp2:
        case ExprOp::log2:
        case ExprOp::power:
        case ExprOp::lookup:
        case ExprOp::lattice:
            return 4;
        default:
            return 1;
    }
}

class PrecisionChooser {
  public:
    PrecisionChooser(const std::vector<TapeInstruction>& code,
                     const std::array<std::uint32_t, 3>& outputs, double max_error)
        : code_(code),
          outputs_(outputs),
          max_error_(max_error),
          in_double_(code.size()),
          value_(code.size()),
          adjoint_(code.size()),
          has_pole_(code.size()),
          partials_(code.size()),
          partials_are_of_(code.size()) {
        for (std::size_t i = 0; i < code.size(); ++i) {
            const TapeInstruction& step = code[i];
            nodes_.push_back({{step.a, step.b, step.c},
                              static_cast<std::size_t>(operand_count(step.op)),
                              is_exact(step.op),
                              half_ulps(step.op)});
            if (is_number(step.op)) {
                value_[i] = step.value;
            } else {
                computed_.push_back(i);
            }
        }
    }

    Sensitivity sensitivity() {
        Sensitivity result;
        const std::vector<Vector3> probes = probe_colors();
        for (std::size_t p = 0; p < probes.size(); p += 3) {
            evaluate(probes[p], code_.size());
            std::vector<double> largest(code_.size());
            for (const std::uint32_t output : outputs_) {
                accumulate(output);
                for (std::size_t i = 0; i < code_.size(); ++i)
                    largest[i] =
                        std::max(largest[i], has_pole_[i] ? kPole : std::fabs(adjoint_[i]));
            }
            result.value.push_back(value_);
            result.sensitivity.push_back(std::move(largest));
        }
        return result;
    }

    Precision choose() {
        const std::vector<Vector3> probes = probe_colors();
        for (std::size_t i = 0; i < code_.size(); ++i)
            in_double_[i] = code_[i].curve && code_[i].curve->is_precise;
        // Where the rows of a matrix cancel, the loss has no bound, and no set of probes comes near
        // enough to every zero of every row: these are double from the start.
        for (std::size_t i = 0; i < code_.size(); ++i) {
            if (is_cancelling_row(i)) keep_in_double(i);
            // In float the rounding of y log2(x) grows with it, and kernels have no better for an
            // exponent that is not constant. A small power of a ratio too small for float is not
            // small.
            if (code_[i].op == ExprOp::power && code_[code_[i].b].op != ExprOp::constant) {
                keep_in_double(i);
                keep_in_double(code_[i].a);
            }
        }
        // Nor need a probe lie in a narrow and steep cell of a table: what such a table is indexed
        // with is double from the start, and all that it is computed from.
        for (std::size_t i = 0; i < code_.size(); ++i) {
            if (code_[i].op == ExprOp::lookup && !code_[i].curve &&
                is_steep(*code_[i].table, max_error_)) {
                keep_in_double(i);
                keep_index_in_double(code_[i].a);
            }
        }
        for (std::size_t i = 0; i < code_.size(); ++i) {
            if (is_branch(code_[i].op)) branches_.push_back({i, {}});
        }
        keep_large_in_double(probes);
        // Most curves that are too coarse are so for many colors: those few are enough to say so.
        for (std::size_t p = 0; p < probes.size(); p += 7)
            visit(probes[p]);
        if (!too_coarse_.empty()) return {in_double_, too_coarse_};
        // A copy (min, select, ...) of a float is exact, one of a double is not: what was decided
        // may have to be looked at again.
        for (int pass = 0; pass < 4; ++pass) {
            const std::vector<bool> before = in_double_;
            std::vector<Probe> visited;
            for (const Vector3& rgb : probes) {
                visited.push_back({rgb, visit(rgb)});
                if (pass == 0) collect_sides(rgb);
            }
            climb(visited);
            if (!too_coarse_.empty()) break;
            for (const Branch& branch : branches_)
                approach(branch);
            if (in_double_ == before) break;
        }
        return {in_double_, too_coarse_};
    }

  private:
    /// What is asked of an instruction again and again.
    struct Node {
        std::array<std::uint32_t, 3> operand;
        std::size_t operands;
        bool is_exact;
        double half_ulps;
    };
    struct Share {
        double error;
        std::size_t index;
    };
    struct Probe {
        Vector3 rgb;
        double worst;  // see visit()
    };
    /// Where the program takes one side or the other, and probes of either.
    struct Branch {
        std::size_t index;
        std::array<std::vector<Vector3>, 2> sides;
    };
    static constexpr std::size_t kPairs = 4;
    /// Sensitivity where the derivative has no end.
    static constexpr double kPole = 1e12;

    /// A sum of constant multiples of values, with a negative constant among them.
    [[nodiscard]] bool is_cancelling_row(std::size_t i) const {
        if (code_[i].op != ExprOp::add) return false;
        bool has_negative = false;
        std::vector<std::uint32_t> terms = {code_[i].a, code_[i].b};
        while (!terms.empty()) {
            const TapeInstruction& term = code_[terms.back()];
            terms.pop_back();
            if (term.op == ExprOp::add) {
                terms.push_back(term.a);
                terms.push_back(term.b);
                continue;
            }
            const bool left = term.op == ExprOp::multiply && code_[term.a].op == ExprOp::constant;
            const bool right = term.op == ExprOp::multiply && code_[term.b].op == ExprOp::constant;
            if (!left && !right) return false;
            has_negative = has_negative || code_[left ? term.a : term.b].value < 0;
        }
        return has_negative;
    }

    void keep_index_in_double(std::uint32_t index) {
        std::vector<bool> seen(code_.size());
        std::vector<std::uint32_t> rest = {index};
        while (!rest.empty()) {
            const std::uint32_t i = rest.back();
            rest.pop_back();
            const TapeInstruction& step = code_[i];
            const int operands = operand_count(step.op);
            if (operands == 0 || seen[i]) continue;
            seen[i] = true;
            // No curve is as exact as a double.
            if (step.curve) {
                reject(step.curve);
            } else {
                in_double_[i] = true;
            }
            const std::array<std::uint32_t, 3> operand = {step.a, step.b, step.c};
            rest.insert(rest.end(), operand.begin(), operand.begin() + operands);
        }
    }

    /// The first `count` values.
    void evaluate(const Vector3& rgb, std::size_t count) {
        ++evaluation_;
        for (const std::size_t i : computed_) {
            if (i >= count) break;
            const TapeInstruction& step = code_[i];
            if (step.op == ExprOp::input) {
                value_[i] = rgb[static_cast<std::size_t>(step.input)];
            } else if (step.op == ExprOp::lattice) {
                value_[i] =
                    (*step.lattice)(step.input, value_[step.a], value_[step.b], value_[step.c]);
            } else if (step.curve) {
                value_[i] = (*step.curve)(value_[step.a]);
            } else {
                value_[i] =
                    scalar_op(step.op, value_[step.a], value_[step.b], value_[step.c], step.table);
            }
        }
    }

    /// What has no place in a float at an end of the uniforms.
    void keep_large_in_double(const std::vector<Vector3>& probes) {
        for (const auto end : {&TapeInstruction::least, &TapeInstruction::most}) {
            bool has_uniforms = false;
            const auto set = [&](auto from) {
                for (std::size_t i = 0; i < code_.size(); ++i) {
                    if (code_[i].op != ExprOp::uniform) continue;
                    value_[i] = code_[i].*from;
                    has_uniforms = true;
                }
            };
            set(end);
            if (!has_uniforms) return;
            for (const Vector3& rgb : probes) {
                evaluate(rgb, code_.size());
                keep_large_in_double();
            }
            set(&TapeInstruction::value);
        }
    }
    void keep_large_in_double() {
        constexpr double kTooLarge = 0.5 * static_cast<double>(std::numeric_limits<float>::max());
        for (std::size_t i = 0; i < code_.size(); ++i) {
            if (std::isfinite(value_[i]) && std::fabs(value_[i]) > kTooLarge) keep_in_double(i);
        }
    }

    /// Keeps the errors of this color within what they may be.
    /// @return  how near the worst output is to it
    double visit(const Vector3& rgb) {
        evaluate(rgb, code_.size());
        keep_large_in_double();
        double worst = 0;
        for (const std::uint32_t output : outputs_)
            worst = std::max(worst, keep_within_budget(output));
        return worst;
    }

    /// From the worst probes on to worse colors: where rows of matrices nearly cancel, or a curve
    /// is steep, there may be few of them, and no probe among them.
    void climb(std::vector<Probe>& probes) {
        constexpr std::size_t kStarts = 24;
        constexpr int kSteps = 40;
        const std::size_t starts = std::min(kStarts, probes.size());
        std::partial_sort(probes.begin(), probes.begin() + static_cast<std::ptrdiff_t>(starts),
                          probes.end(),
                          [](const Probe& x, const Probe& y) { return x.worst > y.worst; });
        for (std::size_t p = 0; p < starts; ++p) {
            Probe here = probes[p];
            for (int step = 0; step < kSteps; ++step) {
                const double reach = step < kSteps / 2 ? 0.3 : 0.03;
                Probe next = here;
                for (double& x : next.rgb) {
                    x = std::clamp(x * (1 + random_.uniform(-reach, reach)), -kHalfMax, kHalfMax);
                    x = static_cast<double>(static_cast<float>(x));
                }
                next.worst = visit(next.rgb);
                if (next.worst > here.worst) here = next;
            }
        }
    }

    [[nodiscard]] bool takes_first(std::size_t i) const {
        const TapeInstruction& step = code_[i];
        const double a = value_[step.a];
        switch (step.op) {
            case ExprOp::minimum:
            case ExprOp::maximum:
                return a < value_[step.b];
            case ExprOp::select:
                return a != 0;
            default:
                return a < 0;
        }
    }

    void collect_sides(const Vector3& rgb) {
        for (Branch& branch : branches_) {
            auto& side = branch.sides[takes_first(branch.index) ? 0 : 1];
            if (side.size() < kPairs) {
                side.push_back(rgb);
            } else if (random_.uniform(0, 1) < 0.02) {
                side[random_.bits() % kPairs] = rgb;
            }
        }
    }

    /// Probes ever nearer to where the branch turns over, from both sides: a power display has no
    /// end of slope at black, and random colors do not come near enough to show it.
    void approach(const Branch& branch) {
        const std::size_t pairs = std::min(branch.sides[0].size(), branch.sides[1].size());
        for (std::size_t p = 0; p < pairs; ++p) {
            Vector3 first = branch.sides[0][p];
            Vector3 second = branch.sides[1][p];
            for (int step = 0; step < 50; ++step) {
                Vector3 middle;
                for (std::size_t c = 0; c < 3; ++c)
                    middle[c] = 0.5 * (first[c] + second[c]);
                evaluate(middle, branch.index);
                if (step % 4 == 3) visit(middle);
                (takes_first(branch.index) ? first : second) = middle;
            }
        }
    }

    /// Adjoints of all values for one output, relative to its size above 1.
    void accumulate(std::uint32_t output) {
        std::fill(adjoint_.begin(), adjoint_.end(), 0.0);
        std::fill(has_pole_.begin(), has_pole_.end(), '\0');
        adjoint_[output] = 1 / std::max(1.0, std::fabs(value_[output]));
        for (auto it = computed_.rbegin(); it != computed_.rend(); ++it) {
            const std::size_t i = *it;
            const Node& node = nodes_[i];
            if (adjoint_[i] == 0 || node.operands == 0) continue;
            const TapeInstruction& step = code_[i];
            // The outputs share most of the program.
            std::array<double, 3>& partial = partials_[i];
            if (partials_are_of_[i] != evaluation_) {
                partials_are_of_[i] = evaluation_;
                partial = partials(step, value_[i], value_[step.a], value_[step.b], value_[step.c]);
            }
            for (std::size_t k = 0; k < node.operands; ++k) {
                // Kernels take a constant exponent in double.
                if (k == 1 && step.op == ExprOp::power && code_[step.b].op == ExprOp::constant)
                    continue;
                const double added = adjoint_[i] * partial[k];
                if (std::isfinite(added)) {  // not at a pole
                    adjoint_[node.operand[k]] += added;
                } else {
                    has_pole_[node.operand[k]] = 1;
                }
            }
        }
    }

    [[nodiscard]] double rounding(std::size_t i, std::uint32_t output) const {
        const TapeInstruction& step = code_[i];
        const double v = value_[i];
        if (step.op == ExprOp::constant) {
            return std::fabs(v - static_cast<double>(static_cast<float>(v)));
        }
        if (step.op == ExprOp::uniform) return kHalfUlp * std::fabs(v);  // of any value
        if (step.curve) {
            const double x = value_[step.a];
            double error = step.curve->tolerance.at(x, v);
            // A curve in float is exact to that for x in float.
            if (!step.curve->is_precise && in_double_[step.a])
                error += std::fabs(step.curve->slope(x) * x) * kHalfUlp;
            return i == output ? std::max(0.0, error - kHalfUlp * std::fabs(v)) : error;
        }
        const Node& node = nodes_[i];
        double units = node.half_ulps;
        if (node.is_exact) {
            units = 0;
            for (std::size_t k = 0; k < node.operands; ++k) {
                if (in_double_[node.operand[k]]) units = 1;
            }
        }
        double of_position = 0;
        if (step.op == ExprOp::lookup) {
            if (step.table->positions.empty()) {
                const double x = value_[step.a];
                of_position = std::fabs(slope(*step.table, x) * x) * kHalfUlp;
            } else {
                units = 1;  // computed in double
            }
        }
        if (step.op == ExprOp::lattice) {
            const std::array<double, 3> at = {value_[step.a], value_[step.b], value_[step.c]};
            const std::array<double, 3> slope =
                step.lattice->gradient(step.input, at[0], at[1], at[2]);
            for (std::size_t k = 0; k < 3; ++k) {
                if (!in_double_[node.operand[k]])
                    of_position += std::fabs(slope[k] * at[k]) * kHalfUlp;
            }
        }
        if (i == output) units = std::max(0.0, units - 1);  // that one there is in any case
        return units * std::max(kHalfUlp * std::fabs(v), kSmallestStep) + of_position;
    }

    double keep_within_budget(std::uint32_t output) {
        accumulate(output);
        shares_.clear();
        curves_.clear();
        const double most = 0.25 * 0.25 * max_error_ * max_error_;
        double sum = 0;  // of squares
        for (std::size_t i = 0; i <= output; ++i) {
            const bool is_curve = code_[i].curve != nullptr;
            if (adjoint_[i] == 0 || (in_double_[i] && !is_curve)) continue;
            const double error = std::fabs(adjoint_[i]) * rounding(i, output);
            if (!(error > 0)) continue;
            sum += error * error;
            (is_curve ? curves_ : shares_).push_back({error, i});
        }
        if (sum <= most) return sum / most;
        const auto double_has_more_merit = [&](const Share& x, const Share& y) {
            return x.error / cost_of_double(code_[x.index].op) >
                   y.error / cost_of_double(code_[y.index].op);
        };
        std::sort(shares_.begin(), shares_.end(), double_has_more_merit);
        for (const Share& share : shares_) {
            if (sum <= most) return sum / most;
            in_double_[share.index] = true;
            sum -= share.error * share.error;
        }
        std::sort(curves_.begin(), curves_.end(),
                  [](const Share& x, const Share& y) { return x.error > y.error; });
        for (const Share& share : curves_) {
            if (sum <= most) return sum / most;
            reject(code_[share.index].curve);
            sum -= share.error * share.error;
        }
        return sum / most;
    }

    void reject(const CompiledCurve* curve) {
        if (std::find(too_coarse_.begin(), too_coarse_.end(), curve) == too_coarse_.end())
            too_coarse_.push_back(curve);
    }

    void keep_in_double(std::size_t i) {
        if (code_[i].curve && !code_[i].curve->is_precise) {
            reject(code_[i].curve);
        } else {
            in_double_[i] = true;
        }
    }

    const std::vector<TapeInstruction>& code_;
    const std::array<std::uint32_t, 3>& outputs_;
    double max_error_;
    std::vector<bool> in_double_;
    std::vector<const CompiledCurve*> too_coarse_;
    std::vector<double> value_;
    std::vector<double> adjoint_;
    std::vector<char> has_pole_;
    std::vector<std::array<double, 3>> partials_;
    std::vector<std::size_t> partials_are_of_;  // the evaluation, counted from 1
    std::size_t evaluation_ = 0;
    std::vector<Node> nodes_;
    std::vector<std::size_t> computed_;  // all values but constants and uniforms
    std::vector<Share> shares_, curves_;
    std::vector<Branch> branches_;
    SampleRandom random_{11};
};

}  // namespace

Sensitivity measure_influence(const std::vector<TapeInstruction>& code,
                              const std::array<std::uint32_t, 3>& outputs) {
    return PrecisionChooser(code, outputs, 0).sensitivity();
}

Precision choose_precision(const std::vector<TapeInstruction>& code,
                           const std::array<std::uint32_t, 3>& outputs, double max_error) {
    return PrecisionChooser(code, outputs, max_error).choose();
}

TONEWRIGHT_NAMESPACE_END
