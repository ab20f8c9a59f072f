// SPDX-License-Identifier: Apache-2.0
#include "shader/guaranteed_bound.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "shader/error_curve.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Color = std::array<Bounded, 3>;
using Box = std::array<Interval, 3>;

double relative(const Bounded& x) {
    const Interval& t = x.exact;
    const double least = t.lo > 0 ? t.lo : t.hi < 0 ? -t.hi : 0;
    return x.error / std::max(1.0, least);
}

double worst_of(const Color& c) {
    return std::max({relative(c[0]), relative(c[1]), relative(c[2])});
}

class BoundedProgram {
  public:
    BoundedProgram(const ShaderProgram& program, const Expr& metric)
        : program_(program), metric_(metric, false) {
        for (const ScalarFunction& f : program.scalars)
            scalars_.emplace_back(f.f, true);
        for (const ColorFunction& f : program.colors) {
            Function function{.calls = {}, .f = RunningError({f.f.begin(), f.f.end()})};
            for (const ColorFunction::Call& call : f.calls)
                function.calls.emplace_back(std::vector<Expr>{call.argument});
            size_ += function.f.size();
            colors_.push_back(std::move(function));
        }
        // Cost of reading a curve.
        constexpr std::size_t kCurve = 100;
        for (const ProgramStep& step : program.steps)
            size_ += std::holds_alternative<ScalarStep>(step) ? 3 * kCurve : 20;
    }

    /// @param worst_step  set to the function after which the bound has grown most
    [[nodiscard]] double over(const Box& box, std::size_t* worst_step = nullptr) {
        Color c;
        for (std::size_t i = 0; i < 3; ++i) {
            // Denormals may be flushed to 0.
            const bool may_vanish = box[i].lo < kSmallestFloat;
            c[i] = {box[i], box[i], may_vanish ? kSmallestFloat : 0};
            if (may_vanish) c[i].computed.lo = 0;
        }
        double growth = 1;
        double before = kHalfUlp;
        for (std::size_t i = 0; i < program_.steps.size(); ++i) {
            std::visit([&](const auto& step) { apply(step, c); }, program_.steps[i]);
            if (!worst_step) continue;
            const double after = worst_of(c);
            if (after / before > growth && !name_of(i).empty()) {
                growth = after / before;
                *worst_step = i;
            }
            before = std::max(after, kHalfUlp);
        }
        for (Bounded& x : c)
            x = metric_(x);
        return worst_of(c);
    }

    /// True if no channel of the result depends on another one.
    [[nodiscard]] bool is_of_each_channel() const {
        return program_.matrices.empty() && program_.colors.empty();
    }
    [[nodiscard]] std::size_t size() const { return size_; }
    /// Empty for a step that is no function.
    [[nodiscard]] std::string name_of(std::size_t step) const {
        const ProgramStep& s = program_.steps[step];
        if (const auto* matrix = std::get_if<MatrixStep>(&s))
            return program_.matrices[matrix->function].name;
        if (const auto* scalar = std::get_if<ScalarStep>(&s))
            return program_.scalars[scalar->function].name;
        if (const auto* color = std::get_if<ColorStep>(&s))
            return program_.colors[color->function].name;
        return "";
    }

  private:
    struct Function {
        std::vector<RunningError> calls;
        RunningError f;
    };

    void apply(const ScaleStep& s, Color& c) const {
        const double of_factor = 2 * kHalfUlp * std::fabs(s.factor);
        for (Bounded& x : c) {
            const double rounding = of_factor * magnitude(x.computed) + kSmallestFloat;
            const auto scaled = [&](const Interval& t) {
                return widened(
                    interval_of(ExprOp::multiply, t, {s.factor, s.factor}, {}, nullptr, nullptr));
            };
            const Interval computed = scaled(x.computed);
            x = {scaled(x.exact),
                 {computed.lo - rounding, computed.hi + rounding},
                 std::fabs(s.factor) * x.error + rounding};
        }
    }

    void apply(const MatrixStep& s, Color& c) const {
        const Color in = c;
        const Matrix3& m = program_.matrices[s.function].m;
        for (std::size_t i = 0; i < 3; ++i) {
            Bounded sum{{0, 0}, {0, 0}, 0};
            double size = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto scaled = [&](const Interval& t) {
                    return interval_of(ExprOp::multiply, t, {m[i][k], m[i][k]}, {}, nullptr,
                                       nullptr);
                };
                const auto added = [&](Interval& t, const Interval& part) {
                    t = widened({t.lo + part.lo, t.hi + part.hi});
                };
                added(sum.exact, scaled(in[k].exact));
                added(sum.computed, scaled(in[k].computed));
                sum.error += std::fabs(m[i][k]) * in[k].error;
                size += std::fabs(m[i][k]) * magnitude(in[k].computed);
            }
            // Rounding of the coefficient, the product and two sums, in any order, with or without
            // fused products.
            const double rounding = 4.001 * kHalfUlp * size + 6 * kSmallestFloat;
            sum.error += rounding;
            const bool is_above = sum.computed.lo >= 0;
            sum.computed = {sum.computed.lo - rounding, sum.computed.hi + rounding};
            // Sums of non-negative terms are not negative.
            if (is_above && *std::min_element(m[i].begin(), m[i].end()) >= 0)
                sum.computed.lo = std::max(sum.computed.lo, 0.0);
            c[i] = sum;
        }
    }

    void apply(const ClampStage& s, Color& c) const {
        const double of_ends = kHalfUlp * (std::isfinite(s.lo) ? std::fabs(s.lo) : 0) +
                               kHalfUlp * (std::isfinite(s.hi) ? std::fabs(s.hi) : 0);
        const auto limited = [&](const Interval& t) {
            return Interval{std::clamp(t.lo, s.lo, s.hi), std::clamp(t.hi, s.lo, s.hi)};
        };
        const bool is_exact = static_cast<double>(static_cast<float>(s.lo)) == s.lo &&
                              static_cast<double>(static_cast<float>(s.hi)) == s.hi;
        for (Bounded& x : c) {
            x = {limited(x.exact), limited(x.computed), x.error + (is_exact ? 0 : of_ends)};
            x.error = std::min(x.error, x.computed.hi - x.exact.lo + x.exact.hi - x.computed.lo);
        }
    }

    void apply(const ScalarStep& s, Color& c) {
        for (Bounded& x : c)
            x = scalars_[s.function](x);
    }

    void apply(const ColorStep& s, Color& c) {
        const Function& function = colors_[s.function];
        std::vector<Bounded> inputs(c.begin(), c.end());
        for (std::size_t i = 0; i < function.calls.size(); ++i) {
            const std::size_t called = program_.colors[s.function].calls[i].function;
            inputs.push_back(scalars_[called](function.calls[i](inputs)[0]));
        }
        const std::vector<Bounded> out = function.f(inputs);
        std::copy(out.begin(), out.end(), c.begin());
    }

    const ShaderProgram& program_;
    ErrorCurve metric_;
    std::vector<ErrorCurve> scalars_;
    std::vector<Function> colors_;
    std::size_t size_ = 0;
};

/// Channel to halve: the widest one; channels much smaller than the largest one count less.
struct Cut {
    std::size_t channel = 0;
    double at = 0;
};

Cut cut_of(const Box& box) {
    constexpr double kFactor = 256;  // of what is next to 0
    const double largest = std::max({box[0].hi, box[1].hi, box[2].hi});
    Cut cut;
    double widest = -1;
    for (std::size_t i = 0; i < 3; ++i) {
        const Interval& x = box[i];
        if (x.hi == 0) continue;
        const double lo = std::max(x.lo, x.hi / kFactor);
        const double width = std::log2(x.hi / lo) * std::pow(x.hi / largest, 0.25);
        if (width <= widest) continue;
        widest = width;
        cut = {i, x.lo * 4 < x.hi ? std::max(x.hi / kFactor, std::sqrt(x.lo * x.hi))
                                  : (x.lo + x.hi) / 2};
    }
    return cut;
}

}  // namespace

GuaranteedBound guaranteed_bound(const ShaderProgram& program, const Expr& metric, double useful) {
    // Operations that may be computed: 50 ms.
    constexpr std::size_t kEffort = 2'000'000;
    // After this many halvings a bound far from useful will not become useful.
    constexpr std::size_t kTrial = 200;
    constexpr double kHopeless = 1000;
    struct Candidate {
        double error;
        Box box;
        bool operator<(const Candidate& other) const { return error < other.error; }
    };
    BoundedProgram bounded(program, metric);
    std::priority_queue<Candidate> queue;
    const auto add = [&](const Box& box) { queue.push({bounded.over(box), box}); };
    const Interval all{0, kHalfMax};
    add({all, all, all});
    const std::size_t rounds = kEffort / (2 * bounded.size());
    for (std::size_t i = 0; i < rounds; ++i) {
        if (i == kTrial && !(queue.top().error < kHopeless * useful)) break;
        const Box worst = queue.top().box;
        const Cut cut = cut_of(worst);
        const Interval& x = worst[cut.channel];
        // The box is a single float.
        if (!(cut.at > x.lo && cut.at < x.hi) || x.hi < kSmallestFloat ||
            x.hi - x.lo < x.hi * kHalfUlp)
            break;
        queue.pop();
        for (const Interval& half : {Interval{x.lo, cut.at}, Interval{cut.at, x.hi}}) {
            Box box = worst;
            if (bounded.is_of_each_channel()) {
                box.fill(half);
            } else {
                box[cut.channel] = half;
            }
            add(box);
        }
    }
    std::size_t step = 0;
    (void)bounded.over(queue.top().box, &step);
    double error = queue.top().error;
    if (!(error <= useful)) error = kInfinity;
    return {error, bounded.name_of(step)};
}

TONEWRIGHT_NAMESPACE_END
