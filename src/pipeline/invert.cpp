// SPDX-License-Identifier: Apache-2.0
#include "pipeline/invert.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include "base/format_number.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Range {
    double lo, hi;
};
constexpr Range kAnything = {-kHalfMax, kHalfMax};

struct Node {
    double x, y;
};

/// Nodes of a curve, so close that it is nearly straight between them, except in jumps as narrow as
/// a float step.
class Sampling {
  public:
    Sampling(const Expr& f, Range domain) : f_(f) {
        std::vector<double> x = {domain.lo, domain.hi};
        constexpr int kEven = 64;
        for (int i = 0; i <= kEven; ++i)
            x.push_back(domain.lo + (domain.hi - domain.lo) * i / kEven);
        // Values span many magnitudes.
        constexpr int kLowestOctave = -64;
        for (int i = 4 * kLowestOctave; i <= 4 * 20; ++i) {
            x.push_back(std::exp2(i / 4.0));
            x.push_back(-x.back());
        }
        x.push_back(0);
        std::erase_if(x, [&](double v) { return v < domain.lo || v > domain.hi; });
        std::sort(x.begin(), x.end());
        x.erase(std::unique(x.begin(), x.end()), x.end());
        nodes_.push_back(at(x.front()));
        for (std::size_t i = 1; i < x.size(); ++i)
            add(nodes_.back(), at(x[i]));
    }

    [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }

  private:
    [[nodiscard]] Node at(double x) const { return {x, evaluate(f_, x)}; }

    /// Nodes after `a`, up to `b`.
    void add(Node a, Node b) {
        std::array<Node, 5> part = {a, {}, {}, {}, b};
        for (std::size_t i = 1; i < 4; ++i)
            part[i] = at(a.x + (b.x - a.x) * static_cast<double>(i) / 4);
        double steepest = 0;
        double flattest = kInfinity;
        for (std::size_t i = 0; i < 4; ++i) {
            const double rise = part[i + 1].y - part[i].y;
            steepest = std::max(steepest, std::fabs(rise));
            flattest = std::min(flattest, std::fabs(rise));
        }
        // With slopes this close, a straight line has an error of a hundredth of the distance, and
        // each step of Newton's method squares it.
        constexpr double kNearlyStraight = 1.06;
        // Single precision distinguishes nodes at this distance.
        constexpr double kNarrow = 0x1p-22;
        constexpr double kDark = 1e-30;
        constexpr std::size_t kMostNodes = 1 << 15;
        const double size = std::max(std::fabs(a.x), std::fabs(b.x));
        const double rounding = 1e-14 * std::max(std::fabs(a.y), std::fabs(b.y));
        if (steepest <= kNearlyStraight * flattest || steepest <= rounding ||
            b.x - a.x <= kNarrow * size || size <= kDark || nodes_.size() > kMostNodes) {
            nodes_.push_back(b);
            return;
        }
        for (std::size_t i = 0; i < 4; ++i)
            add(part[i], part[i + 1]);
    }

    const Expr& f_;
    std::vector<Node> nodes_;
};

/// Nodes with strictly ascending outputs: the ends of each plateau, and between them the position
/// of its smallest input.
std::vector<Node> ascending(std::vector<Node> nodes) {
    if (nodes.back().y < nodes.front().y) std::reverse(nodes.begin(), nodes.end());
    constexpr double kStep = 0x1p-22;  // distance of the nodes at a kink
    std::vector<Node> result;
    const auto push = [&](Node node) {
        if (result.empty() || node.y > result.back().y) result.push_back(node);
    };
    for (std::size_t begin = 0, end = 0; begin < nodes.size(); begin = end) {
        std::size_t smallest = begin;
        for (end = begin; end < nodes.size() && nodes[end].y <= nodes[begin].y; ++end) {
            if (std::fabs(nodes[end].x) < std::fabs(nodes[smallest].x)) smallest = end;
        }
        const double y = nodes[begin].y;
        const double step = kStep * std::max(std::fabs(y), 1e-30);
        if (smallest != begin) push({nodes[begin].x, y - step});
        push({nodes[smallest].x, y});
        if (smallest + 1 != end) push({nodes[end - 1].x, y + step});
    }
    return result;
}

/// The x for which f(x) equals input 0.
/// @throws Error  f falls and rises
Expr numeric_inverse(const Expr& f, Range domain, const std::string& name) {
    std::vector<Node> nodes = Sampling(f, domain).nodes();
    std::vector<double> x;
    double largest = 0;
    for (const Node& node : nodes) {
        if (!std::isfinite(node.y))
            throw Error(name + " is " + shortest(node.y) + " at x = " + shortest(node.x));
        x.push_back(node.x);
        largest = std::max(largest, std::fabs(node.y));
    }
    const bool falls = nodes.back().y < nodes.front().y;
    const auto values = [&](const std::vector<double>& at) {
        std::vector<double> y;
        y.reserve(at.size());
        for (const double v : at)
            y.push_back(evaluate(f, v) * (falls ? -1 : 1));
        return y;
    };
    // Rounding of formulas with cancellation.
    const double noise = 1e-9 * std::max(largest, 1e-9);
    if (std::optional<Fall> fall = find_fall(values, x, noise)) {
        if (!falls) throw Error(name + " falls " + to_string(*fall));
        fall->y_from = -fall->y_from;
        fall->y_to = -fall->y_to;
        throw Error(name + " falls, but also rises " + to_string(*fall));
    }
    nodes = ascending(std::move(nodes));
    if (nodes.size() < 2) return nodes.front().x;

    Table near;
    Table lower;
    Table upper;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const double next = nodes[std::min(i + 1, nodes.size() - 1)].x;
        near.positions.push_back(nodes[i].y);
        near.samples.push_back(nodes[i].x);
        lower.samples.push_back(std::min(nodes[i].x, next));
        upper.samples.push_back(std::max(nodes[i].x, next));
    }
    lower.interpolation = upper.interpolation = Table::Interpolation::step;
    lower.positions = upper.positions = near.positions;
    const auto of = [](Table& table, const Expr& y) {
        return lookup(std::make_shared<const Table>(std::move(table)), y);
    };
    const Expr y = clamp(Expr::input(), nodes.front().y, nodes.back().y);
    const Expr lo = of(lower, y);
    const Expr hi = of(upper, y);
    Expr result = of(near, y);
    const Expr slope = derivative(f);
    // Converges from a hundredth of the node distance to 1e-4, and then to the rounding of double.
    for (int step = 0; step < 2; ++step) {
        const Expr rise = substitute(slope, std::span(&result, 1));
        const Expr error = substitute(f, std::span(&result, 1)) - y;
        // If the curve is flat, or its slope is no number, uses the table.
        const Expr moved = falls ? select(less(rise, 0), result - error / rise, result)
                                 : select(less(0, rise), result - error / rise, result);
        result = clamp(moved, lo, hi);
    }
    return result;
}

/// From the last stage to the first. The domain of each stage is the output of the previous ones.
class Inversion {
  public:
    Pipeline run(const Pipeline& pipeline) {
        for (const Stage& stage : pipeline) {
            ++number_;
            std::visit([&](const auto& s) { invert(s); }, stage);
        }
        std::reverse(inverse_.begin(), inverse_.end());
        return std::move(inverse_);
    }

  private:
    [[nodiscard]] std::string name(const Stage& stage) const {
        return "stage " + std::to_string(number_) + ", a " + std::string(stage_kind(stage)) + ",";
    }
    [[noreturn]] void refuse(const Stage& stage) const {
        throw Error("stage " + std::to_string(number_) + " is a " + std::string(stage_kind(stage)) +
                    ", which mixes channels");
    }

    void invert(const MatrixStage& s) {
        inverse_.emplace_back(MatrixStage{inverse(s.m)});
        const std::array<Range, 3> in = domain_;
        for (std::size_t i = 0; i < 3; ++i) {
            domain_[i] = {0, 0};
            for (std::size_t j = 0; j < 3; ++j) {
                const double a = s.m[i][j] * in[j].lo;
                const double b = s.m[i][j] * in[j].hi;
                domain_[i].lo += std::min(a, b);
                domain_[i].hi += std::max(a, b);
            }
        }
    }

    void invert(const ClampStage& s) {
        inverse_.emplace_back(s);
        for (Range& r : domain_)
            r = {std::clamp(r.lo, s.lo, s.hi), std::clamp(r.hi, s.lo, s.hi)};
    }

    void invert(const CurveStage& s) {
        std::array<Expr, 3> back = {0, 0, 0};
        std::array<Range, 3> range{};
        for (std::size_t c = 0; c < 3; ++c) {
            const Range d = {std::max(domain_[c].lo, -kHalfMax), std::min(domain_[c].hi, kHalfMax)};
            const double a = evaluate(s.f[c], d.lo);
            const double b = evaluate(s.f[c], d.hi);
            range[c] = {std::min(a, b), std::max(a, b)};
            const bool is_known =
                c > 0 && same(s.f[c], s.f[0]) && d.lo == domain_[0].lo && d.hi == domain_[0].hi;
            back[c] = s.inverse  ? clamp((*s.inverse)[c], d.lo, d.hi)
                      : is_known ? back[0]
                                 : numeric_inverse(s.f[c], d, name(s));
            // A stated inverse holds for the outputs of the curve.
            const Expr y = clamp(Expr::input(), range[c].lo, range[c].hi);
            if (s.inverse) back[c] = substitute(back[c], std::span(&y, 1));
        }
        inverse_.emplace_back(CurveStage{back, std::nullopt});
        domain_ = range;
    }

    void invert(const ToneScaleStage& s) {
        double hi = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double most = std::max(domain_[c].hi, 0.0);
            hi = s.norm == ToneScaleStage::Norm::max_rgb ? std::max(hi, most)
                                                         : hi + std::max(s.weights[c], 0.0) * most;
        }
        // The norm of the output is f of the norm.
        inverse_.emplace_back(ToneScaleStage{
            s.norm, s.weights, numeric_inverse(s.f, {0, std::min(hi, kHalfMax)}, name(s))});
        domain_.fill(kAnything);
    }

    void invert(const HuePreservingStage& s) {
        const Range d = {
            std::max({-kHalfMax, std::min({domain_[0].lo, domain_[1].lo, domain_[2].lo})}),
            std::min({kHalfMax, std::max({domain_[0].hi, domain_[1].hi, domain_[2].hi})})};
        // The largest channel stays the largest.
        inverse_.emplace_back(HuePreservingStage{numeric_inverse(s.f, d, name(s))});
        domain_.fill({evaluate(s.f, d.lo), evaluate(s.f, d.hi)});
    }

    void invert(const HexconeStage& s) { refuse(s); }
    void invert(const CrossTalkStage& s) { refuse(s); }
    void invert(const GridStage& s) { refuse(s); }

    std::size_t number_ = 0;
    std::array<Range, 3> domain_ = {kAnything, kAnything, kAnything};
    Pipeline inverse_;
};

}  // namespace

std::optional<Fall> find_fall(const Curve& f, const std::vector<double>& x, double noise) {
    const std::vector<double> y = f(x);
    std::size_t top = 0;
    std::size_t low = 0;
    for (std::size_t i = 1; i < y.size(); ++i) {
        if (y[i] < y[low]) low = i;
        const bool has_fallen = y[low] < y[top] - noise;
        if (has_fallen && y[i] > y[low] + noise) break;
        if (!has_fallen && y[i] >= y[top]) top = low = i;
    }
    if (!(y[low] < y[top] - noise)) return std::nullopt;
    // The turning points are between the positions.
    const auto refine = [&](std::size_t i, double sign) {
        const double from = x[i == 0 ? 0 : i - 1];
        const double to = x[std::min(i + 1, x.size() - 1)];
        std::vector<double> near = {x[i]};
        constexpr int kParts = 256;
        for (int k = 0; k <= kParts; ++k)
            near.push_back(from + (to - from) * k / kParts);
        const std::vector<double> values = f(near);
        std::size_t best = 0;
        for (std::size_t k = 1; k < near.size(); ++k) {
            if (sign * values[k] > sign * values[best]) best = k;
        }
        return Node{near[best], values[best]};
    };
    const Node from = refine(top, 1);
    const Node to = refine(low, -1);
    if (!(from.x < to.x)) return Fall{x[top], y[top], x[low], y[low]};
    return Fall{from.x, from.y, to.x, to.y};
}

std::string to_string(const Fall& fall) {
    // Enough digits to distinguish the values, and at least three.
    int digits = 3;
    while (digits < 9 && rounded(fall.y_from, digits) == rounded(fall.y_to, digits))
        ++digits;
    return "from " + rounded(fall.y_from, digits) + " at x = " + rounded(fall.x_from, 3) + " to " +
           rounded(fall.y_to, digits) + " at x = " + rounded(fall.x_to, 3);
}

Pipeline invert_stages(const Pipeline& pipeline) { return Inversion().run(pipeline); }

TONEWRIGHT_NAMESPACE_END
