// SPDX-License-Identifier: Apache-2.0
#include "shader/error_curve.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "expr/nodes.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// One piece below 2^kLowest; no values above 2^kHighest.
constexpr int kLowest = -101;
constexpr int kHighest = 100;
Bounded exactly(const Interval& x) { return {x, x, 0}; }

/// Splits f into a composition: at every value through which all later operations read the
/// argument.
std::vector<Expr> links_of(const Expr& f) {
    const std::vector<Expr> nodes = nodes_of(Span<const Expr>(&f, 1));
    std::unordered_map<const ExprNode*, std::size_t> index;
    // Last reader of each node.
    std::vector<std::size_t> last_use(nodes.size());
    std::vector<bool> depends(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        index.emplace(nodes[i].node(), i);
        depends[i] = nodes[i].op() == ExprOp::input;
        for (int k = 0; k < nodes[i].operand_count(); ++k) {
            const std::size_t operand = index.at(nodes[i].operand(k).node());
            last_use[operand] = i;
            depends[i] = depends[i] || depends[operand];
        }
    }
    std::vector<Expr> links;
    std::unordered_map<const ExprNode*, Expr> rebuilt;
    std::size_t still_read = 0;  // the last reader of the values before this one
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const Expr& e = nodes[i];
        if (e.operand_count() == 0) {
            rebuilt.emplace(e.node(), e);
        } else {
            std::vector<Expr> operands;
            operands.reserve(static_cast<std::size_t>(e.operand_count()));
            for (int k = 0; k < e.operand_count(); ++k)
                operands.push_back(rebuilt.at(e.operand(k).node()));
            rebuilt.insert_or_assign(
                e.node(),
                make_expr(e.op(), operands, e.op() == ExprOp::lookup ? e.table() : nullptr));
        }
        if (!depends[i]) continue;
        if (still_read <= i && e.op() != ExprOp::input) {
            links.push_back(rebuilt.at(e.node()));
            rebuilt.insert_or_assign(e.node(), Expr::input());
        }
        still_read = std::max(still_read, last_use[i]);
    }
    if (links.empty()) links.push_back(f);
    return links;
}

bool is_one_operation(const Expr& f) {
    int count = 0;
    for (const Expr& e : nodes_of(Span<const Expr>(&f, 1)))
        count += e.operand_count() > 0 ? 1 : 0;
    return count <= 1 && f.op() != ExprOp::lookup;
}

}  // namespace

ErrorCurve::ErrorCurve(const Expr& f, bool is_rounded)
    : whole_{RunningError({f}), RunningError({derivative(f)})}, is_rounded_(is_rounded) {
    const std::vector<Expr> links = is_rounded ? links_of(f) : std::vector<Expr>{};
    for (std::size_t i = 0; links.size() > 1 && i < links.size(); ++i) {
        links_.push_back({RunningError({links[i]}), RunningError({derivative(links[i])}),
                          is_one_operation(links[i])});
    }
}

Bounded ErrorCurve::operator()(const Bounded& x) {
    const Bounded whole = whole_.over(x, is_rounded_);
    if (links_.empty()) return whole;
    Bounded y = x;
    for (Link& link : links_)
        y = link.is_one_operation ? link.f({y})[0] : link.over(y, is_rounded_);
    // Both bounds hold.
    const auto common = [](const Interval& s, const Interval& t) {
        return Interval{std::max(s.lo, t.lo), std::min(s.hi, t.hi)};
    };
    return {common(whole.exact, y.exact), common(whole.computed, y.computed),
            std::min(whole.error, y.error)};
}

ErrorCurve::Piece ErrorCurve::Link::piece_of(const Interval& x) const {
    const auto at = [&](double t) { return f({exactly({t, t})})[0]; };
    const double width = x.hi - x.lo;
    const Bounded center = at(x.lo + width / 2);
    bool has_choice = false;
    const Bounded y = f({exactly(x)}, &has_choice)[0];
    Piece piece{.x = x, .value = y.exact, .rounding = y.error};
    piece.slope = magnitude(slope({exactly(x)})[0].exact);
    if (std::isnan(piece.slope)) piece.slope = kInfinity;
    if (has_choice) {
        piece.jump = piece.value.hi - piece.value.lo;
    } else {
        // The slope limits the distance of each value from the middle.
        const double reach = piece.slope * width / 2;
        piece.value = {std::max(piece.value.lo, center.exact.lo - reach),
                       std::min(piece.value.hi, center.exact.hi + reach)};
    }
    const double size = std::max(magnitude(x), std::ldexp(1, kLowest));
    const double secant = std::fabs(at(x.hi).exact.hi - at(x.lo).exact.lo) / width;
    // Typical relative error of an argument.
    constexpr double kArgument = 1e-6;
    double too_much = std::max(piece.rounding - 2 * center.error, piece.jump);
    if (width > size * 0x1p-7 && piece.slope > 1.5 * secant)
        too_much = std::max(too_much, (piece.slope - secant) * size * kArgument);
    piece.too_much = width > size * 0x1p-26 ? too_much : 0;
    return piece;
}

std::vector<ErrorCurve::Piece> ErrorCurve::Link::pieces_of(const Interval& all) {
    constexpr std::size_t kMost = 1024;
    // Operations of all octaves together: 0.1 s.
    constexpr std::size_t kEffort = 150'000;
    // Excess that does not justify two pieces.
    constexpr double kFine = 1e-9;
    const auto is_better = [](const Piece& a, const Piece& b) { return a.too_much < b.too_much; };
    std::vector<Piece> pieces = {piece_of(all)};
    while (pieces.front().too_much > kFine && pieces.size() < kMost &&
           piece_count * f.size() < kEffort) {
        ++piece_count;
        std::pop_heap(pieces.begin(), pieces.end(), is_better);
        const Interval x = pieces.back().x;
        pieces.pop_back();
        const double middle = x.lo + (x.hi - x.lo) / 2;
        for (const Interval& half : {Interval{x.lo, middle}, Interval{middle, x.hi}}) {
            pieces.push_back(piece_of(half));
            std::push_heap(pieces.begin(), pieces.end(), is_better);
        }
    }
    return pieces;
}

const std::vector<ErrorCurve::Piece>& ErrorCurve::Link::octave(int sign, int exponent) {
    const auto [place, is_new] = octaves.try_emplace({sign, exponent});
    if (is_new) {
        const double lo = std::ldexp(1, exponent);
        const double hi = 2 * lo;
        place->second = pieces_of(sign == 0  ? Interval{-lo, lo}
                                  : sign > 0 ? Interval{lo, hi}
                                             : Interval{-hi, -lo});
    }
    return place->second;
}

template <class Visit>
void ErrorCurve::Link::visit(const Interval& x, const Visit& visit_piece) {
    const auto visit_octave = [&](int sign, int exponent) {
        for (const Piece& piece : octave(sign, exponent)) {
            if (piece.x.lo <= x.hi && piece.x.hi >= x.lo) visit_piece(piece);
        }
    };
    const double least = std::ldexp(1, kLowest);
    const auto exponent_of = [&](double t) {
        return t < least ? kLowest : std::min(std::ilogb(t), kHighest);
    };
    if (x.lo <= least && x.hi >= -least) visit_octave(0, kLowest);
    // The upper end of an octave also belongs to the next one.
    if (x.hi >= least) {
        for (int i = exponent_of(x.lo) - (x.lo > least ? 1 : 0); i <= exponent_of(x.hi); ++i)
            if (i >= kLowest) visit_octave(1, i);
    }
    if (x.lo <= -least) {
        for (int i = exponent_of(-x.hi) - (-x.hi > least ? 1 : 0); i <= exponent_of(-x.lo); ++i)
            if (i >= kLowest) visit_octave(-1, i);
    }
}

Bounded ErrorCurve::Link::over(const Bounded& x, bool is_rounded) {
    const Interval nothing{kInfinity, -kInfinity};
    const double least = std::ldexp(1, kHighest);
    const bool is_huge = !(magnitude(x.exact) < least && magnitude(x.computed) < least);
    if (is_huge) return {{}, {}, kInfinity};
    Interval exact = nothing;
    Interval both = nothing;
    Interval computed = nothing;
    double steepest = 0;
    double jump = 0;
    double rounding = 0;
    visit(hull(x.exact, x.computed), [&](const Piece& piece) {
        const auto meets = [&](const Interval& t) {
            return piece.x.lo <= t.hi && piece.x.hi >= t.lo;
        };
        both = hull(both, piece.value);
        if (meets(x.exact)) exact = hull(exact, piece.value);
        if (meets(x.computed)) {
            computed = hull(computed, piece.value);
            rounding = std::max(rounding, piece.rounding);
        }
        steepest = std::max(steepest, piece.slope);
        jump += piece.jump;
    });
    if (!is_rounded) rounding = 0;
    // Between two arguments the function changes by at most its slope and its jumps, and stays in
    // its range.
    const double moved = x.error == 0 ? 0 : std::min(steepest * x.error + jump, both.hi - both.lo);
    return {exact, {computed.lo - rounding, computed.hi + rounding}, moved + rounding};
}

TONEWRIGHT_NAMESPACE_END
