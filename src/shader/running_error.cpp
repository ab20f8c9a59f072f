// SPDX-License-Identifier: Apache-2.0
#include "shader/running_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "expr/nodes.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// 0 times infinity is 0, because infinite ends stand for finite numbers.
double times(double a, double b) { return a == 0 || b == 0 ? 0 : a * b; }

/// Number of samples and nodes that are read one by one.
constexpr std::size_t kMostSamples = 500;

/// @param whole  interval of all samples, used if there are too many to read
TableReading read(const Table& table, const Interval& a, const TableReading& whole) {
    const std::vector<double>& samples = table.samples;
    const std::size_t n = samples.size();
    const bool is_step = table.interpolation == Table::Interpolation::step;
    TableReading reading;
    std::size_t begin = 0;
    std::size_t end;
    // One more sample on both sides, because a rounded position may lie beyond.
    if (table.positions.empty()) {
        const auto place = [&](double x) {
            const double t = std::clamp(x, 0.0, 1.0) * static_cast<double>(is_step ? n : n - 1);
            return std::min(static_cast<std::size_t>(t), n - 1);
        };
        begin = place(a.lo);
        end = place(a.hi) + 1;
    } else {
        const auto place = [&](double x) {
            const auto at = std::upper_bound(table.positions.begin(), table.positions.end(), x);
            return static_cast<std::size_t>(at - table.positions.begin());
        };
        begin = place(a.lo);
        begin -= begin > 0 ? 1 : 0;
        end = place(a.hi);
    }
    begin -= begin > 0 ? 1 : 0;
    end = std::min(end + 1, n - 1);
    if (end - begin > kMostSamples && whole.values.lo <= whole.values.hi) return whole;
    for (std::size_t i = begin; i <= end; ++i) {
        reading.values = {std::min(reading.values.lo, samples[i]),
                          std::max(reading.values.hi, samples[i])};
        if (i == begin) continue;
        const double step = std::fabs(samples[i] - samples[i - 1]);
        if (is_step) {
            reading.jump += step;
            continue;
        }
        if (table.positions.empty()) {
            reading.slope = std::max(reading.slope, step * static_cast<double>(n - 1));
        } else {
            const double width = table.positions[i] - table.positions[i - 1];
            reading.slope = std::max(reading.slope, step / width);
            // Both positions of the quotient are rounded, and the quotient.
            const double of_quotient =
                2 * kHalfUlp * (std::fabs(table.positions[i]) + std::fabs(table.positions[i - 1])) /
                    width +
                8 * kHalfUlp;
            reading.of_position = std::max(reading.of_position, step * of_quotient);
        }
    }
    return reading;
}

/// Values of the nodes that the three read, and of their neighbors.
/// @param whole  interval of all nodes, used if there are too many to read
Interval read(const Grid& grid, int channel, const std::array<Interval, 3>& at,
              const Interval& whole) {
    const auto n = static_cast<std::size_t>(grid.edge());
    std::array<std::size_t, 3> begin{};
    std::array<std::size_t, 3> end{};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto place = [&](double x) {
            return static_cast<std::size_t>(std::clamp(x, 0.0, 1.0) * static_cast<double>(n - 1));
        };
        begin[i] = place(at[i].lo) - (place(at[i].lo) > 0 ? 1 : 0);
        end[i] = std::min(place(at[i].hi) + 2, n - 1);
    }
    const std::size_t count =
        (end[0] - begin[0] + 1) * (end[1] - begin[1] + 1) * (end[2] - begin[2] + 1);
    if (count > kMostSamples) return whole;
    const std::vector<double>& nodes = grid.nodes();
    Interval values{kInfinity, -kInfinity};
    for (std::size_t x = begin[0]; x <= end[0]; ++x) {
        for (std::size_t y = begin[1]; y <= end[1]; ++y) {
            for (std::size_t z = begin[2]; z <= end[2]; ++z) {
                const double v =
                    nodes[3 * ((x * n + y) * n + z) + static_cast<std::size_t>(channel)];
                values = {std::min(values.lo, v), std::max(values.hi, v)};
            }
        }
    }
    return values;
}

/// Largest derivative of x^y by x on [lo, hi].
double steepest_power(const Interval& x, double y) {
    if (y == 0) return 0;
    return std::fabs(y) * std::max(std::pow(x.lo, y - 1), std::pow(x.hi, y - 1));
}

/// True, false or unknown result of a comparison.
Interval compared(ExprOp op, const Interval& a, const Interval& b) {
    switch (op) {
        case ExprOp::less:
            return {a.hi < b.lo ? 1.0 : 0.0, a.lo < b.hi ? 1.0 : 0.0};
        case ExprOp::less_equal:
            return {a.hi <= b.lo ? 1.0 : 0.0, a.lo <= b.hi ? 1.0 : 0.0};
        default: {
            const bool is_same = a.lo == a.hi && b.lo == b.hi && a.lo == b.lo;
            return {is_same ? 1.0 : 0.0, a.hi < b.lo || b.hi < a.lo ? 0.0 : 1.0};
        }
    }
}

/// True for operations that jump.
bool is_choice(ExprOp op) {
    return op == ExprOp::less || op == ExprOp::less_equal || op == ExprOp::equal ||
           op == ExprOp::floor;
}

bool is_point(const Interval& x) { return x.lo == x.hi; }
bool is_float(double x) { return static_cast<double>(static_cast<float>(x)) == x; }

/// Largest distance of a member of x from one of y.
double apart(const Interval& x, const Interval& y) { return std::max(y.hi - x.lo, x.hi - y.lo); }

/// Propagates the errors of the operands through an operation without rounding.
double propagated(const Expr& e, const Bounded& a, const Bounded& b, const Bounded& c,
                  const Interval& quotient) {
    const Interval x = hull(a.exact, a.computed);
    switch (e.op()) {
        case ExprOp::add:
        case ExprOp::subtract:
            return a.error + b.error;
        case ExprOp::multiply:
            return times(magnitude(a.computed), b.error) + times(magnitude(b.exact), a.error);
        case ExprOp::divide: {
            const Interval& d = b.computed;
            const double smallest = d.lo > 0 ? d.lo : d.hi < 0 ? -d.hi : 0;
            return (a.error + times(magnitude(quotient), b.error)) / smallest;
        }
        case ExprOp::minimum:
        case ExprOp::maximum: {
            const Bounded& low = e.op() == ExprOp::minimum ? a : b;
            const Bounded& high = e.op() == ExprOp::minimum ? b : a;
            const bool is_a = low.exact.hi < high.exact.lo && low.computed.hi < high.computed.lo;
            const bool is_b = high.exact.hi < low.exact.lo && high.computed.hi < low.computed.lo;
            return is_a ? a.error : is_b ? b.error : std::max(a.error, b.error);
        }
        case ExprOp::sine:
        case ExprOp::cosine:  // Vulkan gives no bound beyond
            if (!(magnitude(a.computed) <= std::numbers::pi)) return kInfinity;
            return a.error;
        case ExprOp::negate:
        case ExprOp::absolute:
            return a.error;
        case ExprOp::square_root:
            if (x.lo < 0) return kInfinity;
            return std::min(std::sqrt(a.error), a.error / (2 * std::sqrt(x.lo)));
        case ExprOp::exp2:
            return times(std::numbers::ln2 * std::exp2(x.hi), a.error);
        case ExprOp::log2:
            return x.lo > 0 ? a.error / (std::numbers::ln2 * x.lo) : kInfinity;
        case ExprOp::power: {
            if (x.lo < 0) return kInfinity;
            const Interval y = hull(b.exact, b.computed);
            double sum = times(std::max(steepest_power(x, y.lo), steepest_power(x, y.hi)), a.error);
            // For exponents below 1, two powers differ by at most the power of the difference of
            // their bases.
            if (y.lo > 0 && y.hi <= 1) sum = std::min(sum, std::pow(a.error, y.lo));
            if (b.error > 0) {
                const double largest = std::max({std::pow(x.lo, y.lo), std::pow(x.lo, y.hi),
                                                 std::pow(x.hi, y.lo), std::pow(x.hi, y.hi)});
                const double logarithm =
                    std::max(std::fabs(std::log(x.lo)), std::fabs(std::log(x.hi)));
                sum += times(times(largest, logarithm), b.error);
            }
            return sum;
        }
        case ExprOp::atan2: {
            const auto nearest = [](const Interval& t) {
                return t.lo > 0 ? t.lo : t.hi < 0 ? -t.hi : 0;
            };
            const double radius = std::hypot(nearest(x), nearest(hull(b.exact, b.computed)));
            return (a.error + b.error) / radius;
        }
        case ExprOp::floor:
            return std::floor(x.hi) - std::floor(x.lo);
        case ExprOp::less:
        case ExprOp::less_equal:
        case ExprOp::equal: {
            if (a.error == 0 && b.error == 0) return 0;
            const Interval right = compared(e.op(), a.exact, b.exact);
            const Interval got = compared(e.op(), a.computed, b.computed);
            return right.lo == right.hi && got.lo == got.hi && right.lo == got.lo ? 0 : 1;
        }
        case ExprOp::select: {
            const auto is_true = [](const Interval& t) { return t.lo > 0 || t.hi < 0; };
            const auto is_false = [](const Interval& t) { return t.lo == 0 && t.hi == 0; };
            if (is_true(a.exact) && is_true(a.computed)) return b.error;
            if (is_false(a.exact) && is_false(a.computed)) return c.error;
            const double same_branch = std::max(b.error, c.error);
            if (a.error == 0) return same_branch;
            return same_branch + apart(b.exact, c.exact);
        }
        default:
            return 0;
    }
}

}  // namespace

Interval widened(const Interval& x) {
    constexpr double kWider = 0x1p-50;
    return {x.lo - std::fabs(x.lo) * kWider, x.hi + std::fabs(x.hi) * kWider};
}

double magnitude(const Interval& x) { return std::max(std::fabs(x.lo), std::fabs(x.hi)); }

Interval hull(const Interval& a, const Interval& b) {
    return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}

RunningError::RunningError(const std::vector<Expr>& outputs) {
    std::unordered_map<const ExprNode*, std::size_t> index;
    for (const Expr& e : nodes_of(outputs)) {
        Step step{.e = e, .whole = {}, .table = {}};
        const auto at = [&](int i) {
            return i < e.operand_count() ? index.at(e.operand(i).node()) : 0;
        };
        step.a = at(0);
        step.b = at(1);
        step.c = at(2);
        if (e.op() == ExprOp::lookup) step.table = read(*e.table(), {-kInfinity, kInfinity}, {});
        if (e.op() == ExprOp::grid) {
            step.whole = interval_of(e.op(), {}, {}, {}, nullptr, e.grid().get());
            const std::vector<double>& nodes = e.grid()->nodes();
            const auto n = static_cast<std::size_t>(e.grid()->edge());
            const std::size_t stride[3] = {n * n, n, 1};
            for (std::size_t i = 0; i < n * n * n; ++i) {
                for (std::size_t k = 0; k < 3; ++k) {
                    if (i / stride[k] % n == n - 1) continue;
                    const auto channel = static_cast<std::size_t>(e.channel());
                    const double step_size =
                        nodes[3 * (i + stride[k]) + channel] - nodes[3 * i + channel];
                    step.slope[k] =
                        std::max(step.slope[k], std::fabs(step_size) * static_cast<double>(n - 1));
                }
            }
        }
        index.emplace(e.node(), nodes_.size());
        nodes_.push_back(std::move(step));
    }
    for (const Expr& e : outputs)
        outputs_.push_back(index.at(e.node()));
}

std::vector<Bounded> RunningError::operator()(const std::vector<Bounded>& inputs,
                                              bool* has_choice) const {
    Choices choices;
    std::vector<Bounded> result = run(inputs, {}, &choices);
    if (has_choice) *has_choice = choices.others || !choices.open.empty();
    // Evaluates every combination of comparison results separately, so that all readers of a
    // comparison see the same result.
    constexpr std::size_t kMost = 3;
    const std::size_t n = choices.open.size();
    if (n == 0 || n > kMost) return result;
    std::vector<std::vector<Bounded>> cases;
    for (unsigned answers = 0; answers < 1U << n; ++answers) {
        Answers given;
        for (std::size_t i = 0; i < n; ++i)
            given[choices.open[i]] = answers >> i & 1U ? 1 : 0;
        cases.push_back(run(inputs, given, nullptr));
    }
    for (std::size_t i = 0; i < result.size(); ++i) {
        Bounded all = cases.front()[i];
        for (const std::vector<Bounded>& one : cases) {
            all.exact = hull(all.exact, one[i].exact);
            all.computed = hull(all.computed, one[i].computed);
            all.error = std::max(all.error, one[i].error);
        }
        // The computed comparison may differ from the exact one.
        double between = 0;
        for (const std::vector<Bounded>& one : cases) {
            for (const std::vector<Bounded>& other : cases)
                between = std::max(between, apart(one[i].exact, other[i].exact));
        }
        if (choices.may_differ) all.error += between;
        if (all.error < result[i].error) result[i] = all;
    }
    return result;
}

std::vector<Bounded> RunningError::run(const std::vector<Bounded>& inputs, const Answers& answers,
                                       Choices* choices) const {
    std::vector<Bounded> values;
    values.reserve(nodes_.size());
    const Bounded nothing;
    for (std::size_t at = 0; at < nodes_.size(); ++at) {
        const Step& step = nodes_[at];
        const Expr& e = step.e;
        const int operands = e.operand_count();
        const Bounded& a = operands > 0 ? values[step.a] : nothing;
        const Bounded& b = operands > 1 ? values[step.b] : nothing;
        const Bounded& c = operands > 2 ? values[step.c] : nothing;
        Bounded r;
        double error = 0;
        Interval computed;
        if (e.op() == ExprOp::input) {
            values.push_back(inputs.at(static_cast<std::size_t>(e.input_index())));
            continue;
        }
        if (e.is_constant()) {
            const auto x = static_cast<double>(static_cast<float>(e.value()));
            values.push_back({{e.value(), e.value()}, {x, x}, std::fabs(x - e.value())});
            continue;
        }
        if (const auto given = answers.find(at); !answers.empty() && given != answers.end()) {
            values.push_back({{given->second, given->second}, {given->second, given->second}, 0});
            continue;
        }
        if (e.op() == ExprOp::lookup) {
            const TableReading exact = read(*e.table(), a.exact, step.table);
            const TableReading both = read(*e.table(), hull(a.exact, a.computed), step.table);
            r.exact = exact.values;
            if (choices && exact.jump > 0) choices->others = true;
            computed = read(*e.table(), a.computed, step.table).values;
            const double of_place = kHalfUlp * magnitude(a.computed);
            error = times(both.slope, a.error + 2 * of_place) + both.of_position + both.jump;
        } else if (e.op() == ExprOp::grid) {
            r.exact = read(*e.grid(), e.channel(), {a.exact, b.exact, c.exact}, step.whole);
            computed =
                read(*e.grid(), e.channel(), {a.computed, b.computed, c.computed}, step.whole);
            const Bounded* parts[3] = {&a, &b, &c};
            for (int k = 0; k < 3; ++k)
                error += times(step.slope[k], parts[k]->error + 2 * kHalfUlp);
        } else {
            const auto over = [&](const Interval& x, const Interval& y, const Interval& z) {
                if (is_choice(e.op()) && e.op() != ExprOp::floor) return compared(e.op(), x, y);
                if (e.op() == ExprOp::select) {
                    if (x.lo > 0 || x.hi < 0) return y;
                    if (x.lo == 0 && x.hi == 0) return z;
                    return hull(y, z);
                }
                Interval result = interval_of(e.op(), x, y, z, nullptr, nullptr);
                if (e.op() == ExprOp::multiply && same(e.operand(0), e.operand(1)))
                    result.lo = std::max(result.lo, 0.0);
                return is_point(result) && is_float(result.lo) ? result : widened(result);
            };
            r.exact = over(a.exact, b.exact, c.exact);
            computed = over(a.computed, b.computed, c.computed);
            error = propagated(e, a, b, c, r.exact);
            const bool is_open = is_choice(e.op()) && (error > 0 || !is_point(r.exact));
            if (choices && is_open && e.op() == ExprOp::floor) {
                choices->others = true;
            } else if (choices && is_open) {
                choices->open.push_back(at);
                choices->may_differ = choices->may_differ || error > 0;
            }
        }
        double rounding = rounding_of(e.op(), magnitude(computed), a.computed, b.computed).vulkan;
        // Operations that are exact or correctly rounded.
        const bool is_exact =
            is_point(computed) && is_float(computed.lo) &&
            (e.op() == ExprOp::add || e.op() == ExprOp::subtract || e.op() == ExprOp::multiply);
        if (is_exact) rounding = 0;
        // A result below the smallest float may become 0.
        if (rounding > 0 && computed.lo < kSmallestFloat && computed.hi > -kSmallestFloat)
            rounding += kSmallestFloat;
        r.computed = {computed.lo - rounding, computed.hi + rounding};
        // A product, a quotient, a root and a power keep their sign when they are rounded.
        if (computed.lo >= 0) r.computed.lo = std::max(r.computed.lo, 0.0);
        if (computed.hi <= 0) r.computed.hi = std::min(r.computed.hi, 0.0);
        r.error = error + rounding;
        if (!(r.error <= apart(r.exact, r.computed))) r.error = apart(r.exact, r.computed);
        if (std::isnan(r.error)) r.error = kInfinity;
        values.push_back(r);
    }
    std::vector<Bounded> result;
    for (const std::size_t i : outputs_)
        result.push_back(values[i]);
    return result;
}

TONEWRIGHT_NAMESPACE_END
