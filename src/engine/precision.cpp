// SPDX-License-Identifier: Apache-2.0
#include "engine/precision.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.h"
#include "engine/probe_block.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr double kHalfUlp = ProbeBlock::kHalfUlp;
constexpr double kSmallestStep = ProbeBlock::kSmallestStep;

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
    for (int i = 0; i < 500; ++i) {  // colors of wider gamuts, for which rows nearly cancel
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

/// True if a cell of the table is so steep that rounding the index to float takes more than an
/// eighth of the error bound.
bool is_steep(const Table& table, double max_error) {
    if (table.interpolation == Table::Interpolation::step) return false;
    for (std::size_t i = 0; i + 1 < table.samples.size(); ++i) {
        const double reach =
            std::max(std::fabs(cell_begin(table, i)), std::fabs(cell_begin(table, i + 1)));
        if (!(std::fabs(cell_slope(table, i)) * reach * kHalfUlp < max_error / 8)) return true;
    }
    return false;
}

/// True if the result is exact: an operand, its negative, or an integer.
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
        case ExprOp::grid:  // nodes, weights, and a sum of four products
            return 4;
        default:
            return 1;
    }
}

/// Approximate cost of computing an operation in double.
double cost_of_double(ExprOp op) {
    switch (op) {
        case ExprOp::exp2:
        case ExprOp::log2:
        case ExprOp::power:
        case ExprOp::lookup:
        case ExprOp::grid:
            return 4;
        default:
            return 1;
    }
}

class PrecisionChooser {
  public:
    PrecisionChooser(const std::vector<TapeInstruction>& code,
                     const std::array<std::uint32_t, 3>& outputs, double max_error,
                     const std::vector<std::vector<double>>& settings)
        : code_(code),
          outputs_(outputs),
          settings_(settings),
          max_error_(max_error),
          largest_sum_(0.25 * 0.25 * max_error * max_error),
          in_double_(code.size()),
          block_(code, outputs, false) {
        for (const TapeInstruction& step : code) {
            nodes_.push_back({{step.a, step.b, step.c},
                              static_cast<std::size_t>(operand_count(step.op)),
                              is_exact(step.op),
                              half_ulps(step.op)});
        }
        for (const std::uint32_t output : outputs)
            nodes_[output].is_output = true;
    }

    Precision choose() {
        const std::vector<Vector3> probes = probe_colors();
        for (std::size_t i = 0; i < code_.size(); ++i)
            in_double_[i] = code_[i].curve && code_[i].curve->is_precise;
        // If a row of a matrix cancels, the loss has no bound, and no set of probe colors comes
        // close enough to every zero of every row. So such rows are double from the start.
        for (std::size_t i = 0; i < code_.size(); ++i) {
            if (const std::vector<std::uint32_t> terms = terms_of_cancelling_row(i);
                !terms.empty()) {
                keep_in_double(i);
                for (const std::uint32_t term : terms) {
                    for (const std::uint32_t step : exposure_steps(code_, term))
                        keep_in_double(step);
                }
            }
            // In float, the rounding of y log2(x) grows with its size, and kernels have no better
            // method for an exponent that is not constant. The base is double, too: a small power
            // of a ratio that is too small for float is not small.
            if (code_[i].op == ExprOp::power && code_[code_[i].b].op != ExprOp::constant) {
                keep_in_double(i);
                keep_in_double(code_[i].a);
            }
        }
        // A narrow and steep cell of a table may contain no probe color. So the index of such a
        // table is double from the start, with all values that it is computed from.
        for (std::size_t i = 0; i < code_.size(); ++i) {
            if (code_[i].op == ExprOp::lookup && !code_[i].curve &&
                is_steep(*code_[i].table, max_error_)) {
                keep_in_double(i);
                keep_index_in_double(code_[i].a);
            }
        }
        for (std::size_t i = 0; i < code_.size(); ++i) {
            if (is_branch(code_[i].op)) branches_.push_back({static_cast<std::uint32_t>(i), {}});
        }
        keep_large_in_double(probes);
        // Most curves that are too coarse are too coarse for many colors, so a part of them is
        // enough to find these curves.
        std::vector<Vector3> every_7th;
        for (std::size_t p = 0; p < probes.size(); p += 7)
            every_7th.push_back(probes[p]);
        visit(every_7th);
        std::vector<Outcomes> of_settings(settings_.size());
        visit_settings(every_7th, of_settings);
        if (!too_coarse_.empty()) return {in_double_, too_coarse_};
        // A copy (min, select, ...) of a float is exact, but a copy of a double is not. So a choice
        // can change the errors that an earlier choice relied on, and there are several passes.
        std::vector<Vector3> near_branches;
        Outcomes of_probes, of_near_branches;
        for (int pass = 0; pass < 4; ++pass) {
            const std::vector<bool> before = in_double_;
            std::vector<Probe> visited;
            const auto each = [&](std::size_t p, std::size_t lane, double worst) {
                visited.push_back({probes[p], worst});
                if (pass == 0) collect_sides(probes[p], lane);
            };
            visit(probes, of_probes, each);
            climb(visited);
            if (!too_coarse_.empty()) break;
            if (pass == 0) near_branches = approach_branches();
            visit(near_branches, of_near_branches);
            visit_settings(every_7th, of_settings);
            if (in_double_ == before) break;
        }
        return {in_double_, too_coarse_};
    }

  private:
    static constexpr std::size_t kLanes = ProbeBlock::kLanes;
    using Row = ProbeBlock::Row;

    /// Properties of an instruction that are read often.
    struct Node {
        std::array<std::uint32_t, 3> operand;
        std::size_t operands;
        bool is_exact;
        double half_ulps;
        bool is_output = false;
    };
    struct Share {
        double error;
        std::size_t index;
    };
    struct Probe {
        Vector3 rgb;
        double worst;  // see visit_lane()
    };
    /// A value with two sides to take, and probe colors that take each of them.
    struct Branch {
        std::uint32_t index;
        std::array<std::vector<Vector3>, 2> sides;
    };
    static constexpr std::size_t kPairs = 4;
    /// Results of visit_lane() for a block of colors that changed nothing. They hold as long as
    /// changes_ has the same value.
    struct Outcome {
        std::size_t changes = ~std::size_t{0};
        std::array<double, kLanes> worst{};
    };
    /// By block.
    using Outcomes = std::vector<Outcome>;

    /// The values in a sum of constant multiples that may cancel; empty for any other value. It may
    /// cancel if a constant is negative, or if a value is an input, because inputs may be negative:
    /// random floats found colors at which rows of positive constants cancel.
    [[nodiscard]] std::vector<std::uint32_t> terms_of_cancelling_row(std::size_t i) const {
        std::vector<std::uint32_t> values;
        if (code_[i].op != ExprOp::add) return values;
        bool may_cancel = false;
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
            if (!left && !right) return {};
            values.push_back(left ? term.b : term.a);
            may_cancel = may_cancel || code_[left ? term.a : term.b].value < 0 ||
                         code_[values.back()].op == ExprOp::input ||
                         !exposure_steps(code_, values.back()).empty();
        }
        return may_cancel ? values : std::vector<std::uint32_t>{};
    }
    void keep_index_in_double(std::uint32_t index) {
        std::vector<bool> seen(code_.size());
        std::vector<std::uint32_t> rest = {index};
        while (!rest.empty()) {
            const std::uint32_t i = rest.back();
            rest.pop_back();
            const TapeInstruction& step = code_[i];
            const std::vector<std::uint32_t> operands = operands_of(step);
            if (operands.empty() || seen[i]) continue;
            seen[i] = true;
            // No curve is as exact as a double.
            if (step.curve) {
                reject(step.curve);
            } else {
                put_in_double(i);
            }
            rest.insert(rest.end(), operands.begin(), operands.end());
        }
    }

    /// Keeps values in double that may overflow float when the uniforms are at the ends of their
    /// ranges.
    void keep_large_in_double(const std::vector<Vector3>& probes) {
        for (const auto end : {&TapeInstruction::least, &TapeInstruction::most}) {
            if (!block_.set_uniforms(end)) return;
            for (std::size_t p = 0; p < probes.size(); p += kLanes) {
                block_.evaluate(&probes[p], std::min(kLanes, probes.size() - p));
                const Row largest = block_.largest_values();
                for (std::size_t lane = 0; lane < block_.size(); ++lane) {
                    if (largest.lane[lane] > kTooLarge) keep_large_in_double(lane);
                }
            }
            block_.set_uniforms(&TapeInstruction::value);
        }
    }
    void keep_large_in_double(std::size_t lane) {
        for (std::size_t i = 0; i < code_.size(); ++i) {
            const double size = std::fabs(block_.value(i, lane));
            if (std::isfinite(size) && size > kTooLarge) keep_in_double(i);
        }
    }

    /// Evaluates a block of colors, and the errors that roundings add to its outputs.
    void look_at(const Vector3* colors, std::size_t n) {
        block_.evaluate(colors, n);
        block_.differentiate();
        largest_ = block_.largest_values();
        sum_squares();
    }

    /// Sums the squares of the errors that roundings add to each output, with the precision chosen
    /// so far.
    void sum_squares() {
        sums_ = {};
        summed_after_ = changes_;
        Row error;
        for (std::size_t i = 0; i < code_.size(); ++i) {
            if (in_double_[i] && !code_[i].curve) continue;
            if (nodes_[i].is_output) {
                for (std::size_t o = 0; o < 3; ++o) {
                    for (std::size_t lane = 0; lane < block_.size(); ++lane) {
                        const double share =
                            std::fabs(block_.adjoint(o, i, lane)) * rounding(i, lane, outputs_[o]);
                        if (share > 0) sums_[o].lane[lane] += share * share;
                    }
                }
            } else if (is_number(code_[i].op)) {
                error.lane.fill(rounding(i, 0, kNoOutput));
                block_.add_squares(i, error, sums_);
            } else if (code_[i].op == ExprOp::lookup || code_[i].op == ExprOp::grid) {
                for (std::size_t lane = 0; lane < block_.size(); ++lane)
                    error.lane[lane] = rounding(i, lane, kNoOutput);
                block_.add_squares(i, error, sums_);
            } else if (const double units = units_of(i); units > 0) {
                block_.add_squares(i, units, sums_);
            }
        }
    }

    /// Chooses double for values until the errors of this color are within the budget.
    /// @return  the squared error of the worst output, relative to the budget
    double visit_lane(std::size_t lane) {
        if (largest_.lane[lane] > kTooLarge) keep_large_in_double(lane);
        if (summed_after_ != changes_) sum_squares();
        double worst = 0;
        for (std::size_t o = 0; o < 3; ++o)
            worst = std::max(worst, keep_within_budget(o, lane));
        return worst;
    }

    /// Visits one color after the other.
    /// @param each  called after each color with its number, its lane and the result of
    ///              visit_lane()
    /// @param known  outcomes of earlier visits of the same colors. A block is not computed again
    ///               if nothing has changed since.
    template <class F>
    void visit(const std::vector<Vector3>& colors, Outcomes& known, const F& each) {
        known.resize((colors.size() + kLanes - 1) / kLanes);
        for (std::size_t p = 0; p < colors.size(); p += kLanes) {
            const std::size_t n = std::min(kLanes, colors.size() - p);
            Outcome& outcome = known[p / kLanes];
            const bool is_known = outcome.changes == changes_;
            if (!is_known) {
                outcome.changes = changes_;
                look_at(&colors[p], n);
            }
            for (std::size_t lane = 0; lane < n; ++lane) {
                if (!is_known) outcome.worst[lane] = visit_lane(lane);
                each(p + lane, lane, outcome.worst[lane]);
            }
            if (outcome.changes != changes_) outcome = {};
        }
    }
    void visit(const std::vector<Vector3>& colors, Outcomes& known) {
        visit(colors, known, [](std::size_t, std::size_t, double) {});
    }
    void visit(const std::vector<Vector3>& colors) {
        Outcomes unknown;
        visit(colors, unknown);
    }

    void visit_settings(const std::vector<Vector3>& colors, std::vector<Outcomes>& known) {
        for (std::size_t i = 0; i < settings_.size(); ++i) {
            block_.set_uniforms(settings_[i]);
            visit(colors, known[i]);
        }
        if (!settings_.empty()) block_.set_uniforms(&TapeInstruction::value);
    }

    /// Searches for worse colors near the worst probe colors. Colors for which rows of matrices
    /// nearly cancel or a curve is steep may be few, without a probe color among them.
    void climb(std::vector<Probe>& probes) {
        constexpr std::size_t kStarts = 24;
        constexpr std::size_t kSteps = 40;
        std::sort(probes.begin(), probes.end(),
                  [](const Probe& x, const Probe& y) { return x.worst > y.worst; });
        probes.resize(std::min(probes.size(), kStarts));
        std::vector<std::array<Vector3, kSteps>> change(probes.size());
        for (auto& steps : change) {
            for (std::size_t step = 0; step < kSteps; ++step) {
                const double reach = step < kSteps / 2 ? 0.3 : 0.03;
                for (double& x : steps[step])
                    x = random_.uniform(-reach, reach);
            }
        }
        for (std::size_t first = 0; first < probes.size(); first += kLanes) {
            std::vector<Vector3> colors(std::min(kLanes, probes.size() - first));
            for (std::size_t step = 0; step < kSteps; ++step) {
                for (std::size_t lane = 0; lane < colors.size(); ++lane) {
                    for (std::size_t c = 0; c < 3; ++c) {
                        const double x =
                            probes[first + lane].rgb[c] * (1 + change[first + lane][step][c]);
                        colors[lane][c] = static_cast<double>(
                            static_cast<float>(std::clamp(x, -kHalfMax, kHalfMax)));
                    }
                }
                Outcomes unknown;
                visit(colors, unknown, [&](std::size_t, std::size_t lane, double worst) {
                    Probe& probe = probes[first + lane];
                    if (worst > probe.worst) probe = {colors[lane], worst};
                });
            }
        }
    }

    [[nodiscard]] bool takes_first(std::size_t i, std::size_t lane) const {
        const TapeInstruction& step = code_[i];
        const double a = block_.value(step.a, lane);
        switch (step.op) {
            case ExprOp::minimum:
            case ExprOp::maximum:
                return a < block_.value(step.b, lane);
            case ExprOp::select:
                return a != 0;
            default:
                return a < 0;
        }
    }

    void collect_sides(const Vector3& rgb, std::size_t lane) {
        for (Branch& branch : branches_) {
            auto& side = branch.sides[takes_first(branch.index, lane) ? 0 : 1];
            if (side.size() < kPairs) {
                side.push_back(rgb);
            } else if (random_.uniform(0, 1) < 0.02) {
                side[random_.bits() % kPairs] = rgb;
            }
        }
    }

    /// Makes probe colors that approach the border between the sides of each branch, from both
    /// sides. A power display has an infinite slope at black, and random colors do not come close
    /// enough to show it.
    std::vector<Vector3> approach_branches() {
        constexpr std::size_t kSteps = 50;
        struct Pair {
            std::uint32_t branch;
            Vector3 first, second;
        };
        std::vector<Pair> pairs;
        for (const Branch& branch : branches_) {
            const std::size_t n = std::min(branch.sides[0].size(), branch.sides[1].size());
            for (std::size_t p = 0; p < n; ++p)
                pairs.push_back({branch.index, branch.sides[0][p], branch.sides[1][p]});
        }
        std::vector<Vector3> result;
        for (std::size_t begin = 0; begin < pairs.size(); begin += kLanes) {
            const std::size_t n = std::min(kLanes, pairs.size() - begin);
            std::vector<std::uint32_t> branches;
            for (std::size_t lane = 0; lane < n; ++lane)
                branches.push_back(pairs[begin + lane].branch);
            const std::vector<std::uint32_t> steps = computed_for(branches);
            std::array<std::vector<Vector3>, kLanes> kept;
            std::array<Vector3, kLanes> middle{};
            for (std::size_t step = 0; step < kSteps; ++step) {
                for (std::size_t lane = 0; lane < n; ++lane) {
                    const Pair& pair = pairs[begin + lane];
                    for (std::size_t c = 0; c < 3; ++c)
                        middle[lane][c] = 0.5 * (pair.first[c] + pair.second[c]);
                    if (step % 4 == 3) kept[lane].push_back(middle[lane]);
                }
                block_.evaluate(middle.data(), n, steps);
                for (std::size_t lane = 0; lane < n; ++lane) {
                    Pair& pair = pairs[begin + lane];
                    (takes_first(pair.branch, lane) ? pair.first : pair.second) = middle[lane];
                }
            }
            for (std::size_t lane = 0; lane < n; ++lane)
                result.insert(result.end(), kept[lane].begin(), kept[lane].end());
        }
        return result;
    }

    /// The values that decide which side each of these branches takes.
    [[nodiscard]] std::vector<std::uint32_t> computed_for(
        const std::vector<std::uint32_t>& branches) const {
        std::vector<bool> is_read(code_.size());
        const auto read = [&](std::size_t i) {
            for (std::size_t k = 0; k < nodes_[i].operands; ++k)
                is_read[nodes_[i].operand[k]] = true;
        };
        for (const std::uint32_t branch : branches)
            read(branch);
        std::vector<std::uint32_t> result;
        for (std::size_t i = code_.size(); i-- > 0;) {
            if (!is_read[i] || is_number(code_[i].op)) continue;
            result.push_back(static_cast<std::uint32_t>(i));
            read(i);
        }
        std::reverse(result.begin(), result.end());
        return result;
    }

    /// Rounding error of value i in half units in the last place.
    [[nodiscard]] double units_of(std::size_t i) const {
        const Node& node = nodes_[i];
        if (!node.is_exact) return node.half_ulps;
        for (std::size_t k = 0; k < node.operands; ++k) {
            if (in_double_[node.operand[k]]) return 1;
        }
        return 0;
    }

    [[nodiscard]] double rounding(std::size_t i, std::size_t lane, std::size_t output) const {
        const TapeInstruction& step = code_[i];
        const double v = block_.value(i, lane);
        if (step.op == ExprOp::constant) {
            return std::fabs(v - static_cast<double>(static_cast<float>(v)));
        }
        if (step.op == ExprOp::uniform)
            return kHalfUlp * std::fabs(v);  // for any value that it takes
        if (step.curve) {
            const double x = block_.value(step.a, lane);
            double error = step.curve->tolerance.at(x, v);
            // The tolerance of a curve in float holds for an x in float.
            if (!step.curve->is_precise && in_double_[step.a])
                error += std::fabs(step.curve->slope(x) * x) * kHalfUlp;
            return i == output ? std::max(0.0, error - kHalfUlp * std::fabs(v)) : error;
        }
        double units = units_of(i);
        double of_position = 0;
        if (step.op == ExprOp::lookup) {
            const double x = block_.value(step.a, lane);
            if (step.table->positions.empty()) {
                of_position = std::fabs(table_slope(*step.table, x) * x) * kHalfUlp;
            } else {
                // Two units for the sample and the sum. Four units of the rise: the slope, the
                // distance, their product, and the sample once more, because it may be larger than
                // the sum.
                units = 2;
                of_position = 4 * std::fabs(table_rise(*step.table, x)) * kHalfUlp;
            }
        }
        if (step.op == ExprOp::grid) {
            const std::array<double, 3> at = {
                block_.value(step.a, lane), block_.value(step.b, lane), block_.value(step.c, lane)};
            const std::array<double, 3> slope =
                step.grid->gradient(step.input, at[0], at[1], at[2]);
            for (std::size_t k = 0; k < 3; ++k) {
                if (!in_double_[nodes_[i].operand[k]])
                    of_position += std::fabs(slope[k] * at[k]) * kHalfUlp;
            }
        }
        if (i == output)
            units = std::max(0.0, units - 1);  // the output is rounded to float in any case
        return units * std::max(kHalfUlp * std::fabs(v), kSmallestStep) + of_position;
    }

    /// Collects the errors that roundings add to an output at one color, in curves_ and shares_
    /// (all others).
    /// @return  the sum of their squares
    double collect_shares(std::size_t number, std::size_t lane) {
        const std::uint32_t output = outputs_[number];
        shares_.clear();
        curves_.clear();
        double sum = 0;
        for (std::size_t i = 0; i <= output; ++i) {
            const bool is_curve = code_[i].curve != nullptr;
            const double adjoint = block_.adjoint(number, i, lane);
            if (adjoint == 0 || (in_double_[i] && !is_curve)) continue;
            const double error = std::fabs(adjoint) * rounding(i, lane, output);
            if (!(error > 0)) continue;
            sum += error * error;
            (is_curve ? curves_ : shares_).push_back({error, i});
        }
        std::sort(curves_.begin(), curves_.end(),
                  [](const Share& x, const Share& y) { return x.error > y.error; });
        return sum;
    }

    /// Keeps one output at one color within the budget.
    /// @return  its squared error, relative to the budget
    double keep_within_budget(std::size_t number, std::size_t lane) {
        const double most = largest_sum_;
        double sum = sums_[number].lane[lane];
        if (sum <= most) return sum / most;
        sum = collect_shares(number, lane);
        const auto double_has_more_merit = [&](const Share& x, const Share& y) {
            return x.error / cost_of_double(code_[x.index].op) >
                   y.error / cost_of_double(code_[y.index].op);
        };
        std::sort(shares_.begin(), shares_.end(), double_has_more_merit);
        for (const Share& share : shares_) {
            if (sum <= most) return sum / most;
            put_in_double(share.index);
            sum -= share.error * share.error;
        }
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
            put_in_double(i);
        }
    }
    void put_in_double(std::size_t i) {
        if (!in_double_[i]) ++changes_;
        in_double_[i] = true;
    }

    static constexpr double kTooLarge =
        0.5 * static_cast<double>(std::numeric_limits<float>::max());
    static constexpr std::size_t kNoOutput = ~std::size_t{0};

    const std::vector<TapeInstruction>& code_;
    const std::array<std::uint32_t, 3>& outputs_;
    const std::vector<std::vector<double>>& settings_;
    double max_error_;
    double largest_sum_;  // the budget: largest sum of the squares of an output's errors
    std::vector<bool> in_double_;
    std::size_t changes_ = 0;  // number of changes of in_double_
    std::vector<const CompiledCurve*> too_coarse_;
    ProbeBlock block_;
    // For the block's colors:
    Row largest_;
    ProbeBlock::OutputRows sums_;
    std::size_t summed_after_ = 0;  // the value of changes_ when sums_ was computed
    std::vector<Node> nodes_;
    std::vector<Share> shares_, curves_;
    std::vector<Branch> branches_;
    SampleRandom random_{11};
};

}  // namespace

Sensitivity measure_sensitivity(const std::vector<TapeInstruction>& code,
                                const std::array<std::uint32_t, 3>& outputs,
                                const std::vector<std::vector<double>>& settings) {
    /// Sensitivity for an infinite derivative.
    constexpr double kPole = 1e12;
    constexpr std::size_t kStride = 3;
    std::vector<Vector3> probes;
    const std::vector<Vector3> all = probe_colors();
    for (std::size_t p = 0; p < all.size(); p += kStride)
        probes.push_back(all[p]);
    const std::vector<double> of_colors(probes.size() * (settings.size() + 1));
    Sensitivity result = {std::vector(code.size(), of_colors), std::vector(code.size(), of_colors)};
    ProbeBlock block(code, outputs, true);
    for (std::size_t setting = 0; setting <= settings.size(); ++setting) {
        if (setting > 0) block.set_uniforms(settings[setting - 1]);
        for (std::size_t p = 0; p < probes.size(); p += ProbeBlock::kLanes) {
            block.evaluate(&probes[p], std::min(ProbeBlock::kLanes, probes.size() - p));
            block.differentiate();
            const std::size_t first = setting * probes.size() + p;
            for (std::size_t i = 0; i < code.size(); ++i) {
                for (std::size_t lane = 0; lane < block.size(); ++lane) {
                    result.value[i][first + lane] = block.value(i, lane);
                    double& largest = result.sensitivity[i][first + lane];
                    for (std::size_t o = 0; o < 3; ++o) {
                        largest = std::max(largest, block.has_pole(o, i, lane)
                                                        ? kPole
                                                        : std::fabs(block.adjoint(o, i, lane)));
                    }
                }
            }
        }
    }
    return result;
}

Precision choose_precision(const std::vector<TapeInstruction>& code,
                           const std::array<std::uint32_t, 3>& outputs, double max_error,
                           const std::vector<std::vector<double>>& settings) {
    return PrecisionChooser(code, outputs, max_error, settings).choose();
}

TONEWRIGHT_NAMESPACE_END
