// SPDX-License-Identifier: Apache-2.0
#include "engine/curve_fitting.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "engine/precision.h"
#include "engine/reference_operations.h"
#include "expr/interval.h"
#include "expr/scalar_ops.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::int64_t kNone = -1;
/// Error that a curve may add to an output even if that exceeds kHalfUlps of its result.
constexpr double kOutputFloor = 0x1p-26;
/// Allowed relative error of a curve: room for rounding its coefficients, its steps and its result.
constexpr double kHalfUlps = 3;
/// Allowed relative errors of precise curves. The first one that a curve can keep counts. With
/// 0.25, more powers in double become curves (GT7, Unreal and AgX in three.js 1.3 times as fast,
/// BT.2446 A 2.5 times).
constexpr std::array kPreciseHalfUlps = {0.25, 1.5};

constexpr int kCheap = 3;
constexpr int kCheapestFunction = 15;
constexpr int kCheapestCurve = 20;
/// Limit of the steps that fitting the curves of one program computes, at 2 to 5 ns each. Subgraphs
/// that have not been tried by then stay as they are.
constexpr std::size_t kMostWork = 20'000'000;

/// Approximate cost of a tape instruction in processor instructions, loads and stores included.
int cost_of(const TapeInstruction& step) {
    switch (step.op) {
        case ExprOp::constant:
        case ExprOp::input:
        case ExprOp::uniform:
            return 0;
        case ExprOp::power:
            return 35;
        case ExprOp::log2:
            return 20;
        case ExprOp::exp2:
            return 15;
        case ExprOp::sine:
        case ExprOp::cosine:
        case ExprOp::atan2:
            return 60;
        case ExprOp::lookup:
            return 25;
        case ExprOp::grid:
            return 100;
        case ExprOp::divide:
        case ExprOp::square_root:
            return 8;
        default:
            return kCheap;
    }
}

/// cost_of() in double, where polynomials are longer. With 1.4 for functions, too, AgX in three.js
/// is 9 % slower; with 2.5 for other operations, Khronos Neutral is 8 to 20 % slower.
double cost_in_double(const TapeInstruction& step) {
    const int cost = cost_of(step);
    return cost >= kCheapestFunction ? 2.5 * cost : 1.4 * cost;
}

/// The interval that contains the result.
Interval interval_of(const TapeInstruction& step, const Interval& a, const Interval& b,
                     const Interval& c) {
    if (step.op == ExprOp::constant) return {step.value, step.value};
    if (step.op == ExprOp::input)
        return step.is_limited ? Interval{-kHalfMax, kHalfMax} : Interval{};
    if (step.op == ExprOp::uniform) return {step.least, step.most};
    return tonewright::interval_of(step.op, a, b, c, step.table, step.grid);
}

class CurveFitter {
    /// The steps run over this many numbers at a time.
    static constexpr std::size_t kBlock = 32;

  public:
    CurveFitter(std::vector<TapeInstruction>& code, std::array<std::uint32_t, 3>& outputs,
                const Sensitivity& sensitivity, CurveCache& cache, CurveForm form)
        : code_(code),
          outputs_(outputs),
          sensitivity_(sensitivity),
          cache_(cache),
          form_(form),
          value_(code.size()) {
        for (std::size_t i = 0; i < code_.size(); ++i)
            value_[i].fill(code_[i].value);  // for constants
        uses_.resize(code_.size());
        for (std::size_t i = 0; i < code_.size(); ++i) {
            for (const std::uint32_t operand : variables_of(i))
                ++uses_[operand];
        }
        for (std::size_t i = 0; i < code_.size(); ++i) {
            const TapeInstruction& step = code_[i];
            const auto of = [&](std::uint32_t v) { return v < i ? interval_[v] : Interval{}; };
            // A grid has many nodes, and one interval for all of its channels.
            const auto same_grid = std::find_if(
                code_.begin(), code_.begin() + static_cast<std::ptrdiff_t>(i),
                [&](const TapeInstruction& other) { return step.grid && other.grid == step.grid; });
            const auto first = static_cast<std::size_t>(same_grid - code_.begin());
            interval_.push_back(first < i ? interval_[first]
                                          : interval_of(step, of(step.a), of(step.b), of(step.c)));
            dominator_.push_back(is_unlimited_exposure(i) ? kNone : dominator_of(i));
        }
        tried_.resize(code_.size());
    }

    void fit() {
        for (const std::uint32_t output : outputs_)
            fit_value(output);
        count_uses();
        for (TapeInstruction& step : code_) {
            if (!step.curve) continue;
            skip_limits_before(step.a);
            skip_limit_of_exposure(step);
        }
        drop_unread();
    }

  private:
    /// Operands of value i that are no constants.
    [[nodiscard]] std::vector<std::uint32_t> variables_of(std::size_t i) const {
        std::vector<std::uint32_t> result = operands_of(code_[i]);
        std::erase_if(result, [&](std::uint32_t v) { return code_[v].op == ExprOp::constant; });
        return result;
    }

    /// True for an input without limits and for the steps from it to its limit. No curve fits them,
    /// because the range of a curve is bounded and exposures are uniforms.
    [[nodiscard]] bool is_unlimited_exposure(std::size_t i) {
        const TapeInstruction& step = code_[i];
        bool result = step.op == ExprOp::input && !step.is_limited;
        for (const std::uint32_t operand : variables_of(i))
            result = result || (is_unlimited_[operand] && !is_limited_exposure(code_, operand));
        is_unlimited_.push_back(result);
        return result;
    }

    /// The nearest value that all inputs of i pass through on their way to i; kNone if there is
    /// none.
    [[nodiscard]] std::int64_t dominator_of(std::size_t i) const {
        const std::vector<std::uint32_t> operands = variables_of(i);
        if (operands.empty()) return kNone;
        std::int64_t common = operands.front();
        for (const std::uint32_t operand : operands) {
            std::int64_t other = operand;
            while (common != other) {  // dominators have smaller indices
                std::int64_t& later = common > other ? common : other;
                later = dominator_[static_cast<std::size_t>(later)];
                if (later == kNone) return kNone;
            }
        }
        return common;
    }

    /// Values between `root` and i in order, with i.
    [[nodiscard]] std::vector<std::uint32_t> between(std::uint32_t root, std::uint32_t i) const {
        std::vector<bool> is_inside(i + 1);
        is_inside[i] = true;
        std::vector<std::uint32_t> result;
        for (std::uint32_t k = i; k > root; --k) {
            if (!is_inside[k]) continue;
            result.push_back(k);
            for (const std::uint32_t operand : variables_of(k))
                is_inside[operand] = true;
        }
        std::reverse(result.begin(), result.end());
        return result;
    }

    void fit_value(std::uint32_t i) {
        if (tried_[i]) return;
        tried_[i] = true;
        // A matrix multiplies the same curve by several coefficients: fit the curve once, without a
        // coefficient.
        const std::vector<std::uint32_t> operands = variables_of(i);
        if (operands.size() == 1 && uses_[operands[0]] > 1 && cost_of(code_[i]) <= kCheap)
            return fit_value(operands[0]);
        std::vector<std::uint32_t> roots;  // the farthest last
        for (std::int64_t r = dominator_[i]; r != kNone;
             r = dominator_[static_cast<std::size_t>(r)])
            roots.push_back(static_cast<std::uint32_t>(r));
        for (auto root = roots.rbegin(); root != roots.rend(); ++root) {
            const std::vector<std::uint32_t> steps = between(*root, i);
            int cost = 0;
            for (const std::uint32_t k : steps)
                cost += cost_of(code_[k]);
            if (cost < kCheapestCurve) break;
            const FittedCurve& found = find_curve(*root, steps, cost);
            // No curve is precise enough for this value, whichever root it begins at.
            if (found.is_rejected) break;
            const CompiledCurve* curve = found.curve.get();
            if (!curve) continue;
            TapeInstruction fitted;
            fitted.op = ExprOp::lookup;
            fitted.a = *root;
            fitted.curve = curve;
            fitted.node = code_[i].node;
            code_[i] = fitted;
            return fit_value(*root);
        }
        for (const std::uint32_t operand : operands)
            fit_value(operand);
    }

    /// Counts the uses of each value that outputs depend on.
    void count_uses() {
        std::fill(uses_.begin(), uses_.end(), 0);
        for (const std::uint32_t output : outputs_)
            ++uses_[output];
        for (std::size_t i = code_.size(); i-- > 0;) {
            if (uses_[i] == 0) continue;
            for (const std::uint32_t operand : operands_of(code_[i]))
                ++uses_[operand];
        }
    }

    /// Drops redundant clamps if a curve reads x times a positive uniform. A fitted curve is
    /// constant below 0, so a clamp of x at 0 is redundant, and so is an upper limit that x cannot
    /// reach.
    void skip_limits_before(std::uint32_t i) {
        TapeInstruction& product = code_[i];
        if (product.op != ExprOp::multiply || uses_[i] != 1) return;
        if (code_[product.a].op == ExprOp::uniform) std::swap(product.a, product.b);
        if (code_[product.b].op != ExprOp::uniform || !(code_[product.b].least > 0)) return;
        while (true) {
            const TapeInstruction& limit = code_[product.a];
            if (limit.op != ExprOp::maximum && limit.op != ExprOp::minimum) return;
            const TapeInstruction& at = code_[limit.b];
            if (at.op != ExprOp::constant) return;
            if (limit.op == ExprOp::maximum ? at.value != 0 : at.value < interval_[limit.a].hi)
                return;
            product.a = limit.a;
        }
    }

    /// Drops the limits of an exposed input if the range of the curve is within them, because a
    /// curve limits its input.
    void skip_limit_of_exposure(TapeInstruction& step) {
        if (!is_limited_exposure(code_, step.a)) return;
        const CompiledCurve& curve = *step.curve;
        if (curve.lo >= 0 && static_cast<double>(curve.hi) <= kHalfMax)
            step.a = exposure_steps(code_, step.a).back();
    }

    /// Key of the steps between a root and a value. Channels that are treated alike have the same
    /// key.
    [[nodiscard]] std::string text_of(std::uint32_t root,
                                      const std::vector<std::uint32_t>& steps) const {
        std::map<std::uint32_t, std::size_t> number = {{root, 0}};
        std::string text;
        const auto append = [&](const auto& value) {
            // NOLINTNEXTLINE(bugprone-sizeof-expression): the table is known by its address.
            text.append(reinterpret_cast<const char*>(&value), sizeof(value));
        };
        for (const std::uint32_t i : steps) {
            const TapeInstruction& step = code_[i];
            append(step.op);
            append(step.table);
            append(step.grid);
            append(step.curve);
            for (const std::uint32_t v : operands_of(step)) {
                const bool is_constant = code_[v].op == ExprOp::constant;
                append(is_constant);
                if (is_constant) {
                    append(code_[v].value);
                } else {
                    append(number.at(v));
                }
            }
            number.emplace(i, number.size());
        }
        return text;
    }

    /// Replaces each x by the value of the last step.
    void run(const std::vector<std::uint32_t>& steps, std::uint32_t root, std::span<double> x) {
        for (; !x.empty(); x = x.subspan(std::min(kBlock, x.size()))) {
            const std::span<double> block = x.first(std::min(kBlock, x.size()));
            run_block(steps, root, block);
            std::copy_n(value_[steps.back()].begin(), block.size(), block.begin());
        }
    }
    /// @param x  kBlock numbers at most
    void run_block(const std::vector<std::uint32_t>& steps, std::uint32_t root,
                   std::span<const double> x) {
        work_ += steps.size() * x.size();
        std::copy(x.begin(), x.end(), value_[root].begin());
        for (const std::uint32_t i : steps) {
            const TapeInstruction& step = code_[i];
            operations_(step, value_[i].data(), value_[step.a].data(), value_[step.b].data(),
                        value_[step.c].data(), x.size());
        }
    }

    /// Allowed error of value i for each exponent of `root`: it adds at most kOutputFloor to an
    /// output.
    [[nodiscard]] std::array<float, CurveTolerance::kExponents> floor_of(std::uint32_t root,
                                                                         std::uint32_t i) const {
        constexpr std::size_t n = CurveTolerance::kExponents;
        std::array<double, n> largest{};
        const std::vector<double>& x = sensitivity_.value[root];
        const std::vector<double>& of_value = sensitivity_.sensitivity[i];
        for (std::size_t p = 0; p < x.size(); ++p) {
            double& here = largest[CurveTolerance::exponent_of(x[p])];
            here = std::max(here, of_value[p]);
        }
        // Neighboring exponents count, too. If a neighbor has no probe color, the nearest exponent
        // with one counts.
        std::array<double, n> below{}, above{};
        for (std::size_t e = 1; e < n; ++e)
            below[e] = largest[e - 1] > 0 ? largest[e - 1] : below[e - 1];
        for (std::size_t e = n - 1; e-- > 0;)
            above[e] = largest[e + 1] > 0 ? largest[e + 1] : above[e + 1];
        std::array<float, n> floor{};
        double last = 0;  // most exponents have the sensitivity of the one before
        for (std::size_t e = 0; e < n; ++e) {
            const double sensitivity = std::max({largest[e], below[e], above[e], 1e-3});
            // Rounded to powers of 8, so that channels that are treated alike share a curve.
            floor[e] = sensitivity == last
                           ? floor[e - 1]
                           : static_cast<float>(std::exp2(
                                 std::floor(std::log2(kOutputFloor / sensitivity) / 3) * 3));
            last = sensitivity;
        }
        return floor;
    }

    const FittedCurve& find_curve(std::uint32_t root, const std::vector<std::uint32_t>& steps,
                                  int cost) {
        static const FittedCurve none;
        for (const std::uint32_t i : steps) {
            if (code_[i].op == ExprOp::grid || code_[i].curve) return none;
        }
        // The upper end is rounded up to a power of 2^16, so that channels that are treated alike
        // share a curve.
        const Interval range = {interval_[root].lo < 0 ? -kInfinity : 0,
                                std::exp2(16 * std::ceil(std::log2(interval_[root].hi) / 16))};
        CurveTolerance tolerance;
        tolerance.floor = floor_of(root, steps.back());
        std::string key = text_of(root, steps);
        for (const double part : {range.lo, range.hi})
            key.append(reinterpret_cast<const char*>(&part), sizeof(part));
        key.append(reinterpret_cast<const char*>(tolerance.floor.data()), sizeof(tolerance.floor));
        FittedCurve& fitted = cache_[key];
        if (!fitted.is_tried && work_ < kMostWork) {
            fitted.is_tried = true;
            const auto f = [&](std::span<double> x) { run(steps, root, x); };
            std::span<const double> half_ulps(&kHalfUlps, 1);
            if (fitted.is_precise) half_ulps = kPreciseHalfUlps;
            std::optional<CompiledCurve> curve;
            if (const auto kinks = find_kinks(root, steps)) {
                for (auto units = half_ulps.begin(); !curve && units != half_ulps.end(); ++units) {
                    tolerance.half_ulps = *units;
                    curve = compile_curve(f, {range.lo, range.hi}, *kinks, tolerance, form_,
                                          fitted.is_precise);
                }
            }
            // Without a precise curve, these steps would be computed in double.
            double of_steps = cost;
            if (fitted.is_precise) {
                of_steps = 0;
                for (const std::uint32_t i : steps)
                    of_steps += cost_in_double(code_[i]);
            }
            if (curve && curve->cost() < of_steps)
                fitted.curve = std::make_unique<const CompiledCurve>(*curve);
        }
        return fitted;
    }

    /// The x > 0 at which a branch changes sides; nullopt if a step has kinks that are no branches.
    std::optional<std::vector<double>> find_kinks(std::uint32_t root,
                                                  const std::vector<std::uint32_t>& steps) {
        for (const std::uint32_t i : steps) {
            if (code_[i].op == ExprOp::floor || code_[i].op == ExprOp::lookup) return std::nullopt;
        }
        std::vector<double> kinks;
        // If a kink is missed here, the fit fails.
        const double top = std::min(interval_[root].hi, 1e12);
        std::vector<double> places;
        for (double x = 1e-12; x < top; x *= 1.2)
            places.push_back(x);
        places.push_back(top);
        for (std::size_t i = 1; i < places.size(); i += kBlock - 1) {
            const std::size_t n = std::min(kBlock, places.size() - (i - 1));
            find_kinks_between(std::span(places).subspan(i - 1, n), root, steps, kinks);
        }
        return kinks;
    }

    /// @param places  at most kBlock, ascending
    void find_kinks_between(std::span<const double> places, std::uint32_t root,
                            const std::vector<std::uint32_t>& steps, std::vector<double>& kinks) {
        run_block(steps, root, places);
        // True where a branch takes another side than at the place before.
        std::array<bool, kBlock> changes{};
        for (const std::uint32_t i : steps) {
            const TapeInstruction& step = code_[i];
            const auto compare = [&](const auto& takes_first) {
                for (std::size_t k = 1; k < places.size(); ++k) {
                    changes[k] =
                        changes[k] || takes_first(value_[step.a][k], value_[step.b][k]) !=
                                          takes_first(value_[step.a][k - 1], value_[step.b][k - 1]);
                }
            };
            if (step.op == ExprOp::minimum || step.op == ExprOp::maximum ||
                step.op == ExprOp::less) {
                compare([](double a, double b) { return a < b; });
            } else if (step.op == ExprOp::less_equal) {
                compare([](double a, double b) { return a <= b; });
            } else if (step.op == ExprOp::absolute) {
                compare([](double a, double /*b*/) { return a < 0; });
            }
        }
        constexpr std::size_t kParts = 16;
        for (std::size_t k = 1; k < places.size(); ++k) {
            if (!changes[k]) continue;
            const double lo = places[k - 1];
            const double hi = places[k];
            // No two floats are closer together, and curves read floats.
            if (!(hi - lo > 1e-9 * hi)) {
                kinks.push_back(hi);
                continue;
            }
            std::array<double, kParts + 1> between;
            for (std::size_t i = 0; i < kParts; ++i)
                between[i] = lo + (hi - lo) * static_cast<double>(i) / kParts;
            between[kParts] = hi;
            find_kinks_between(between, root, steps, kinks);
        }
    }

    void drop_unread() {
        count_uses();
        std::vector<std::uint32_t> moved(code_.size());
        std::vector<TapeInstruction> kept;
        for (std::size_t i = 0; i < code_.size(); ++i) {
            if (uses_[i] == 0) continue;
            TapeInstruction step = code_[i];
            if (operand_count(step.op) > 0) {
                step.a = moved[step.a];
                step.b = moved[step.b];
                step.c = moved[step.c];
            }
            moved[i] = static_cast<std::uint32_t>(kept.size());
            kept.push_back(step);
        }
        for (std::uint32_t& output : outputs_)
            output = moved[output];
        code_ = std::move(kept);
    }

    std::vector<TapeInstruction>& code_;
    std::array<std::uint32_t, 3>& outputs_;
    const Sensitivity& sensitivity_;
    CurveCache& cache_;
    CurveForm form_;
    std::vector<Interval> interval_;
    std::vector<std::int64_t> dominator_;
    std::vector<int> uses_;
    std::vector<bool> tried_;
    std::vector<bool> is_unlimited_;
    RunInstruction operations_ = reference_operations();
    std::vector<std::array<double, kBlock>> value_;
    std::size_t work_ = 0;
};

}  // namespace

void reject_curve(CurveCache& cache, const CompiledCurve* curve) {
    for (auto& [description, fitted] : cache) {
        if (fitted.curve.get() != curve) continue;
        fitted.is_rejected = fitted.is_precise;
        fitted.is_tried = fitted.is_rejected;
        fitted.is_precise = true;
        fitted.curve.reset();
        return;
    }
}

void fit_curves(std::vector<TapeInstruction>& code, std::array<std::uint32_t, 3>& outputs,
                const Sensitivity& sensitivity, CurveCache& cache, CurveForm form) {
    CurveFitter(code, outputs, sensitivity, cache, form).fit();
}

TONEWRIGHT_NAMESPACE_END
