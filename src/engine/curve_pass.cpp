// SPDX-License-Identifier: Apache-2.0
#include "engine/curve_pass.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/tape_operands.h"
#include "expr/scalar_ops.h"
#include "tonewright/pipeline.h"

namespace tonewright {
namespace {

/// Rough cost in vector instructions, AVX-512.
double cost(ExprOp op) {
    switch (op) {
        case ExprOp::constant:
        case ExprOp::input:
            return 0;
        case ExprOp::divide:
        case ExprOp::square_root:
            return 8;
        case ExprOp::exp2:
            return 12;
        case ExprOp::log2:
            return 16;
        case ExprOp::power:
            return 32;
        case ExprOp::sine:
        case ExprOp::cosine:
        case ExprOp::atan2:
            return 60;
        case ExprOp::lookup:
            return 40;
        default:
            return 3;
    }
}
constexpr double kCurveCost = 26;
constexpr double kDoubleFactor = 3;

struct Interval {
    double lo = -kInfinity;
    double hi = kInfinity;
};

/// What values can be, whatever the input: enough of interval arithmetic to see through clamps and
/// matrices.
std::vector<Interval> find_intervals(const std::vector<TapeInstruction>& code) {
    std::vector<Interval> range(code.size());
    for (std::size_t i = 0; i < code.size(); ++i) {
        const TapeInstruction& step = code[i];
        const Interval& a = range[step.a];
        const Interval& b = range[step.b];
        const Interval& c = range[step.c];
        Interval& r = range[i];
        switch (step.op) {
            case ExprOp::constant:
                r = {step.value, step.value};
                break;
            case ExprOp::input:
                r = {-kHalfMax, kHalfMax};
                break;
            case ExprOp::add:
                r = {a.lo + b.lo, a.hi + b.hi};
                break;
            case ExprOp::subtract:
                r = {a.lo - b.hi, a.hi - b.lo};
                break;
            case ExprOp::multiply: {
                const std::array<double, 4> p = {a.lo * b.lo, a.lo * b.hi, a.hi * b.lo,
                                                 a.hi * b.hi};
                r = {*std::min_element(p.begin(), p.end()), *std::max_element(p.begin(), p.end())};
                break;
            }
            case ExprOp::minimum:
                r = {std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
                break;
            case ExprOp::maximum:
                r = {std::max(a.lo, b.lo), std::max(a.hi, b.hi)};
                break;
            case ExprOp::negate:
                r = {-a.hi, -a.lo};
                break;
            case ExprOp::absolute:
                r = {0, std::max(-a.lo, a.hi)};
                break;
            case ExprOp::select:
                r = {std::min(b.lo, c.lo), std::max(b.hi, c.hi)};
                break;
            case ExprOp::less:
            case ExprOp::less_equal:
            case ExprOp::equal:
                r = {0, 1};
                break;
            case ExprOp::square_root:
            case ExprOp::exp2:
                r = {0, kInfinity};
                break;
            default:
                break;
        }
        if (std::isnan(r.lo) || std::isnan(r.hi)) r = Interval{};
    }
    return range;
}

/// The steps from a root to a value, constants included, operands before what uses them: in the
/// same order wherever the same function stands.
struct Cone {
    std::uint32_t root;
    std::vector<std::uint32_t> values;
};

class CurveFinder {
  public:
    CurveFinder(const std::vector<TapeInstruction>& code, const std::vector<std::uint32_t>& roots,
                const Precision& precision)
        : code_(code),
          roots_(roots),
          precision_(precision),
          range_(find_intervals(code)),
          tried_(code.size()),
          value_(code.size()) {
        for (std::uint32_t i = 0; i < code_.size(); ++i) {
            if (roots_[i] != i) groups_[key_of(i)].push_back(i);
        }
    }

    Curves find(const std::array<std::uint32_t, 3>& outputs) {
        for (const std::uint32_t output : outputs)
            attempt(output);
        for (std::size_t j = 0; j < code_.size(); ++j) {
            for (const std::uint32_t operand : operands_of(code_[j])) {
                if (roots_[operand] != roots_[j]) attempt(operand);
            }
        }
        return std::move(result_);
    }

  private:
    /// Compiles the value as a curve; when that cannot be, its operands.
    void attempt(std::uint32_t i) {
        if (roots_[i] == i || tried_[i]) return;
        tried_[i] = true;
        if (cone_cost(i) <= kCurveCost) return;
        if (const std::optional<std::uint32_t> curve = curve_of(i)) {
            result_.uses[i] = {roots_[i], *curve};
            return;
        }
        for (const std::uint32_t operand : operands_of(code_[i]))
            attempt(operand);
    }

    [[nodiscard]] Cone cone_of(std::uint32_t i) const {
        Cone cone{roots_[i], {}};
        std::vector<bool> seen(code_.size());
        append(i, cone, seen);
        return cone;
    }

    void append(std::uint32_t i, Cone& cone, std::vector<bool>& seen) const {
        if (seen[i]) return;
        seen[i] = true;
        if (i != cone.root) {
            for (const std::uint32_t operand : operands_of(code_[i]))
                append(operand, cone, seen);
        }
        cone.values.push_back(i);
    }

    [[nodiscard]] double cone_cost(std::uint32_t i) const {
        const Cone cone = cone_of(i);
        double sum = 0;
        for (const std::uint32_t v : cone.values) {
            if (v == cone.root) continue;
            sum += cost(code_[v].op) * (precision_.in_double[v] ? kDoubleFactor : 1);
        }
        return sum;
    }

    /// Equal for values that are the same function of their roots.
    using Key = std::vector<std::uint64_t>;
    [[nodiscard]] Key key_of(std::uint32_t i) const {
        const Cone cone = cone_of(i);
        std::map<std::uint32_t, std::uint64_t> place;
        Key key;
        for (const std::uint32_t v : cone.values) {
            const TapeInstruction& step = code_[v];
            place[v] = place.size();
            if (v == cone.root) {
                key.push_back(~std::uint64_t{0});
                continue;
            }
            key.push_back(static_cast<std::uint64_t>(step.op));
            key.push_back(std::bit_cast<std::uint64_t>(step.value));
            key.push_back(reinterpret_cast<std::uint64_t>(step.table));
            for (const std::uint32_t operand : operands_of(step))
                key.push_back(place[operand]);
        }
        return key;
    }

    std::optional<std::uint32_t> curve_of(std::uint32_t i) {
        const Key key = key_of(i);
        if (auto it = made_.find(key); it != made_.end()) return it->second;
        const std::optional<CompiledCurve> curve = compile(i, groups_[key]);
        std::optional<std::uint32_t> index;
        if (curve) {
            index = static_cast<std::uint32_t>(result_.curves.size());
            result_.curves.push_back(*curve);
        }
        return made_[key] = index;
    }

    /// One curve for all values of a group.
    std::optional<CompiledCurve> compile(std::uint32_t i, const std::vector<std::uint32_t>& group) {
        double x_max = 0;
        bool can_be_negative = false;
        for (const std::uint32_t v : group) {
            const std::uint32_t root = roots_[v];
            if (precision_.in_double[v] || precision_.in_double[root]) return std::nullopt;
            x_max = std::max(x_max, range_[root].hi);
            can_be_negative = can_be_negative || range_[root].lo < 0;
        }
        const Cone cone = cone_of(i);
        const CurveFunction f = [&](double x) { return evaluate(cone, i, x); };
        const double at_zero = f(0).y;
        if (can_be_negative) {
            for (double x = 0x1p-40; x < 0x1p40; x *= 2) {
                if (f(-x).y != at_zero) return std::nullopt;
            }
        }
        if (!(x_max < 0x1p40)) {
            // No limit in sight: then the curve has to be level from some point on.
            const double far = f(0x1p40).y;
            for (x_max = 0x1p20; x_max > 0x1p-10 && f(x_max).y == far; x_max /= 2)
                continue;
            x_max *= 2;
            if (x_max > 0x1p20) return std::nullopt;
        }
        if (!(x_max > 0)) return std::nullopt;
        std::array<double, Precision::kExponents> tolerance = tolerances(group);
        return compile_curve(f, x_max, [&](int exponent) {
            const int last = static_cast<int>(Precision::kExponents) - 1;
            return tolerance[static_cast<std::size_t>(
                std::clamp(exponent - Precision::kLowestExponent, 0, last))];
        });
    }

    [[nodiscard]] std::array<double, Precision::kExponents> tolerances(
        const std::vector<std::uint32_t>& group) const {
        std::array<double, Precision::kExponents> sensitivity{};
        for (const std::uint32_t v : group) {
            for (std::size_t e = 0; e < sensitivity.size(); ++e) {
                sensitivity[e] =
                    std::max(sensitivity[e], static_cast<double>(precision_.sensitivity[v][e]));
            }
        }
        // Probes are few in an octave: its neighbours count, and a tenth of the largest of all.
        const double least = 0.1 * *std::max_element(sensitivity.begin(), sensitivity.end());
        std::array<double, Precision::kExponents> result{};
        for (std::size_t e = 0; e < result.size(); ++e) {
            const std::size_t from = e > 0 ? e - 1 : 0;
            const std::size_t to = std::min(e + 1, result.size() - 1);
            const double s = std::max({sensitivity[from], sensitivity[e], sensitivity[to], least});
            result[e] = kCurveErrorBudget / s;
        }
        return result;
    }

    CurveValue evaluate(const Cone& cone, std::uint32_t top, double x) {
        CurveValue result{0, 0};
        for (const std::uint32_t v : cone.values) {
            const TapeInstruction& step = code_[v];
            if (v == cone.root) {
                value_[v] = x;
                continue;
            }
            if (step.op == ExprOp::constant) {
                value_[v] = step.value;
                continue;
            }
            const double a = value_[step.a];
            const double b = value_[step.b];
            value_[v] = scalar_op(step.op, a, b, value_[step.c], step.table);
            bool side = false;
            switch (step.op) {
                case ExprOp::minimum:
                    side = b < a;
                    break;
                case ExprOp::maximum:
                    side = a < b;
                    break;
                case ExprOp::select:
                    side = a != 0;
                    break;
                case ExprOp::absolute:
                    side = a < 0;
                    break;
                case ExprOp::less:
                case ExprOp::less_equal:
                case ExprOp::equal:
                    side = value_[v] != 0;
                    break;
                default:
                    continue;
            }
            result.sides = result.sides * 2862933555777941757U + (side ? 2 : 1);
        }
        result.y = value_[top];
        return result;
    }

    const std::vector<TapeInstruction>& code_;
    const std::vector<std::uint32_t>& roots_;
    const Precision& precision_;
    std::vector<Interval> range_;
    std::vector<bool> tried_;
    std::vector<double> value_;
    std::map<Key, std::vector<std::uint32_t>> groups_;
    std::map<Key, std::optional<std::uint32_t>> made_;
    Curves result_;
};

}  // namespace

std::vector<std::uint32_t> find_roots(const std::vector<TapeInstruction>& code) {
    std::vector<std::uint32_t> roots(code.size());
    for (std::uint32_t i = 0; i < code.size(); ++i) {
        roots[i] = i;
        bool first = true;
        for (const std::uint32_t operand : operands_of(code[i])) {
            if (code[operand].op == ExprOp::constant) continue;
            if (!first && roots[operand] != roots[i]) {
                roots[i] = i;
                break;
            }
            roots[i] = roots[operand];
            first = false;
        }
    }
    return roots;
}

Curves find_curves(const std::vector<TapeInstruction>& code,
                   const std::array<std::uint32_t, 3>& outputs,
                   const std::vector<std::uint32_t>& roots, const Precision& precision) {
    return CurveFinder(code, roots, precision).find(outputs);
}

}  // namespace tonewright
