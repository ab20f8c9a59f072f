// SPDX-License-Identifier: Apache-2.0
#include "ocio/hexcone.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/format_number.h"
#include "lut/half_domain.h"
#include "tonewright/engine.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// Works on OCIO's hue, saturation and value. Hue passes through. Every step is a table for each of
// the other two channels, or a matrix that adds one to the other, so a product is a sum of
// logarithms.
//
// OCIO's shader computes the position in a half-domain table as a float between 0 and 65536. It
// grows with the exponent of the input, and a negative sign adds half of the range. So values stay
// positive and small where precision matters.

/// Size of a stop in a channel.
constexpr double kStop = 0x1p-8;

/// A number per half float, in the order of the bit patterns.
using Column = std::vector<double>;

/// The half floats themselves; NaN as 0, infinities as the largest.
const Column& halves() {
    static const Column all = [] {
        Column column(kHalfCount);
        for (unsigned bits = 0; bits < kHalfCount; ++bits)
            column[bits] = sanitize(half_value(bits));
        return column;
    }();
    return all;
}

template <class F>
Column map(const Column& in, const F& f) {
    Column out(in.size());
    std::transform(in.begin(), in.end(), out.begin(), f);
    return out;
}

Column map(const Column& in, const Expr& f) {
    Column out(in.size());
    ReferenceEngine({curve_stage(f)})
        .run({in.data(), in.data(), in.data()}, {out.data(), out.data(), out.data()}, in.size());
    return out;
}

std::vector<float> to_table(const Column& column) {
    std::vector<float> table(column.begin(), column.end());
    table[0x8000] = table[0];
    return table;
}

/// Numbers at the half floats, and which of them are free, @see Lut1DOp::slack.
struct HalfTable {
    std::vector<float> values;
    std::vector<signed char> slack;
};

/// The table, without lookups outside [lo, hi].
HalfTable within(std::vector<float> values, double lo, double hi) {
    std::vector<signed char> slack = unused_entries(values, lo, hi);
    return {std::move(values), std::move(slack)};
}

/// A table of f without lookups outside [lo, hi]: the end values continue there.
template <class F>
HalfTable table_of(double lo, double hi, const F& f) {
    return within(to_table(map(halves(), [&](double x) { return f(std::clamp(x, lo, hi)); })), lo,
                  hi);
}

/// Values in stops below `unit`, positive for darker values. Below the smallest half float a table
/// is a straight line to black, and so is the scale, so the round trip is exact.
class Stops {
  public:
    /// @param to_black  stops from the smallest half float to black
    Stops(double unit, double to_black)
        : unit_(unit), last_(std::log2(unit / kSmallestHalf)), to_black_(to_black) {}

    [[nodiscard]] double of(double light) const {
        return light >= kSmallestHalf
                   ? std::log2(unit_ / light)
                   : last_ + to_black_ * (1 - std::max(light, 0.0) / kSmallestHalf);
    }
    [[nodiscard]] double light(double stops) const {
        // Black starts some table cells earlier, so that no brighter value is interpolated in.
        return stops <= last_
                   ? unit_ * std::exp2(-stops)
                   : kSmallestHalf * std::max(0.0, 1 - (stops - last_) / (to_black_ - 0x1p-4));
    }
    /// Stops of the smallest half float.
    [[nodiscard]] double last() const { return last_; }

  private:
    double unit_;
    double last_;
    double to_black_;
};

/// Adds a function h of the channel `value` to another channel, and keeps `value`, with a strictly
/// monotone function of it, n(value) = sign (k value + h(value)): to the other, times sign, add n;
/// n -> value; take times sign again, and subtract k value.
struct AddedFunction {
    double k = 0;
    double sign = 1;     // such that n falls: it is positive where value is negative
    HalfTable forward;   // value -> n
    HalfTable backward;  // n -> value

    /// `value` as the tables give it back: near the half floats, if n is steep enough.
    [[nodiscard]] Column round_trip() const {
        Lut lut;
        lut.dimension = 1;
        lut.size = static_cast<int>(kHalfCount);
        lut.channels = 1;
        lut.is_half_domain = true;
        lut.values = backward.values;
        return map(Column(forward.values.begin(), forward.values.end()), [&](double n) {
            return interpolate(lut, {n, n, n})[0];
        });
    }
};

/// @param h       of the half floats.
/// @param lo, hi  where `value` is; half floats beyond, by one stop, are in the tables, too.
/// @param margin  least slope of n. The flatter n is, the coarser is its inverse;
///                the larger k is, the coarser is the sum that k value is subtracted from.
AddedFunction add_function(const Column& h, double lo, double hi, double margin) {
    const Column& value = halves();
    std::vector<unsigned> ascending;
    const auto take = [&](unsigned bits) {
        if (value[bits] >= lo - kStop && value[bits] <= hi + kStop) ascending.push_back(bits);
    };
    for (unsigned bits = 0xFBFF; bits > 0x8000; --bits)
        take(bits);
    for (unsigned bits = 0; bits <= 0x7BFF; ++bits)
        take(bits);

    double steepest = 0;
    double least = 0;
    for (std::size_t i = 1; i < ascending.size(); ++i) {
        const unsigned a = ascending[i - 1];
        const unsigned b = ascending[i];
        const double slope = (h[b] - h[a]) / (value[b] - value[a]);
        steepest = std::max(steepest, slope);
        least = std::min(least, slope);
    }
    AddedFunction result;
    result.k = steepest <= -least ? -steepest - margin : margin - least;
    result.sign = result.k < 0 ? 1 : -1;
    Column n(kHalfCount);
    for (unsigned bits = 0; bits < kHalfCount; ++bits) {
        n[bits] =
            result.sign * (result.k * std::clamp(value[bits], lo - kStop, hi + kStop) + h[bits]);
    }
    result.forward = within(to_table(n), lo - kStop, hi + kStop);

    // The inverse of the table itself, including its rounding to float.
    std::vector<std::pair<double, double>> pairs;
    pairs.reserve(ascending.size());
    for (const unsigned bits : ascending)
        pairs.emplace_back(static_cast<double>(result.forward.values[bits]), value[bits]);
    std::reverse(pairs.begin(), pairs.end());
    const auto is_less = [](const auto& a, const auto& b) { return a.first < b.first; };
    result.backward = table_of(pairs.front().first, pairs.back().first, [&](double x) {
        const auto [first, last] =
            std::equal_range(pairs.begin(), pairs.end(), std::pair(x, 0.0), is_less);
        if (first != last) return (first->second + (last - 1)->second) / 2;
        const auto& [x0, y0] = *(first - 1);
        const auto& [x1, y1] = *first;
        return y0 + (x - x0) / (x1 - x0) * (y1 - y0);
    });
    return result;
}

/// Position where value or chroma bends most. Half floats are finest around 0, so stops are counted
/// from there.
double sharpest_bend(const HexconeStage& stage) {
    double best = 1;
    double sharpest = -1;
    for (const Expr& f : {stage.value, stage.chroma}) {
        const Expr slope = derivative(f);
        for (const double x : kinks(f, 0x1p-8, 0x1p8)) {
            const double jump =
                std::fabs(evaluate(slope, x * (1 + 0x1p-30)) - evaluate(slope, x * (1 - 0x1p-30)));
            const double bend = jump > 1e-6 ? jump : 0;  // less is rounding
            if (!(bend > sharpest)) continue;
            sharpest = bend;
            best = x;
        }
    }
    return best;
}

/// Effect of a hexcone stage, for every half float of a channel with stops of p.
///
/// With m the smallest channel minus the offset, saturation is (p - m)/p. It becomes (p - m)
/// chroma/value, so it is multiplied by chroma p/value, which is a loss in stops.
struct HexconeColumns {
    Stops stops;
    Column p;
    Column value;
    Column loss;
};

constexpr double kNone = 64;     // stops below 1 of what is 0
constexpr double kAllLost = 22;  // stops below 1 of a saturation that counts as 0

/// @param hi      largest value of a channel.
/// @throws Error  if a channel would become negative, which HSV cannot represent.
HexconeColumns columns_of(const HexconeStage& stage, double hi) {
    const Stops stops(sharpest_bend(stage), 16);
    // The functions continue beyond the clamp for one table cell if possible. A constant end value
    // would show a kink inside.
    double top = std::min(hi * std::exp2(std::fabs(stops.of(hi)) * 0x1p-9), kHalfMax);
    if (!std::isfinite(evaluate(stage.value, top)) || !std::isfinite(evaluate(stage.chroma, top)))
        top = hi;
    const auto light = [&](double x) { return std::min(stops.light(x / kStop), top); };
    // Below the smallest half float, p is a straight line to 0, which has no saturation.
    const auto seen = [&](double x) { return std::max(light(x), kSmallestHalf); };
    HexconeColumns result = {stops, map(halves(), light), map(map(halves(), light), stage.value),
                             Column(kHalfCount, kAllLost)};
    const Column p = map(halves(), seen);
    const Column value = map(p, stage.value);
    const Column chroma = map(p, stage.chroma);
    for (unsigned bits = 0; bits < kHalfCount; ++bits) {
        const double kept = chroma[bits] * p[bits];
        if (!(kept >= 0 && kept <= value[bits] * (1 + 1e-9))) {
            throw Error("ocio: hexcone stage that makes negative light of p = " +
                        shortest(p[bits]) + "; expected 0 <= chroma(p) p <= value(p)");
        }
        if (kept > 0) result.loss[bits] = std::clamp(std::log2(value[bits] / kept), 0.0, kAllLost);
    }
    return result;
}

/// The loss as an additive function.
/// @throws Error  if it rises and falls too steeply: no k gives an n that a table can invert.
AddedFunction add_loss(const HexconeColumns& columns, const HexconeStage& stage, double at_bend,
                       double hi) {
    const Column h = map(columns.loss, [&](double x) { return kStop * (x - at_bend); });
    const double brightest = kStop * columns.stops.of(hi);
    for (const double margin : {0.125, 0.5, 2.0}) {
        AddedFunction added = add_function(h, brightest, kStop * columns.stops.of(0), margin);
        const Column back = added.round_trip();
        const Column light =
            map(back, [&](double x) { return std::min(columns.stops.light(x / kStop), hi); });
        const Column value = map(light, stage.value);
        bool is_good = true;
        for (unsigned bits = 0; bits < kHalfCount; ++bits) {
            // The loss bends at the end of the domain, so its neighborhood is not tested.
            const double x = halves()[bits];
            if (x < brightest + kStop / 8 || columns.p[bits] < kSmallestHalf) continue;
            constexpr double kTolerance = 4e-6;
            const double stops = added.k * (back[bits] - x) / kStop;
            const double wanted = columns.value[bits];
            is_good = is_good && std::fabs(stops) * std::exp2(-columns.loss[bits]) <= kTolerance &&
                      std::fabs(value[bits] - wanted) <= kTolerance * std::max(1.0, wanted);
        }
        if (is_good) return added;
    }
    throw Error(
        "ocio: hexcone stage whose chroma p/value goes up and down too steeply; expected it to be "
        "smoother");
}

}  // namespace

LoweredOps lower_hexcone(const HexconeStage& stage, double hi) {
    const HexconeColumns columns = columns_of(stage, hi);
    // n is 0 where half floats are finest, unless all saturation is lost there.
    const double at_bend = std::min(columns.loss[0], 1.0);
    const AddedFunction added = add_loss(columns, stage, at_bend, hi);

    // Each table covers its used range and a margin.
    const auto same_number = [](double x) { return x; };
    const HalfTable hue = table_of(0, 1, same_number);
    LoweredOps ops;
    const auto lut = [&](const HalfTable& s, const HalfTable& v) {
        ops.push_back({lut_1d({s.values, v.values, hue.values}, {s.slack, v.slack, hue.slack})});
    };
    // Tables from saturation and value to themselves and to each other.
    const auto mix = [&](double ss, double sv, double vs, double vv, double s_offset = 0) {
        ops.push_back({MatrixOp{{{{ss, sv, 0}, {vs, vv, 0}, {0, 0, 1}}}, {s_offset, 0, 0}}});
    };
    constexpr double kUnseen = 48;  // stops below 1 of what has no effect
    const auto lost = [&](double s) {
        return added.sign * kStop * (s > 0 ? -std::log2(s) : kNone);
    };
    const HalfTable to_p_stops =
        table_of(0, kHalfMax, [&](double x) { return columns.stops.of(x); });

    ops.push_back({FixedFunctionOp{"RGB_TO_HSV"}});
    // Saturation, value, hue: the inverse of a falling half-domain table in OpenColorIO 2.1 sets
    // negatives in the third channel to 0. Hue is never negative.
    const Matrix3 hue_last = {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}};
    ops.push_back({MatrixOp{hue_last}});
    if (stage.offset.is_constant(0)) {
        // (saturation, p) -> stops -> (stops of saturation, n). One table from p to n would be
        // coarser.
        lut(table_of(0, 1, lost), to_p_stops);
        mix(1, 0, 0, kStop);
        lut(table_of(-kNone * kStop, kNone * kStop, same_number), added.forward);
    } else {
        // (saturation, value) = (1 - min/max, max) -> (min/max, max)
        mix(-1, 0, 0, 1, 1);
        // -> stops -> (stops of min, stops of max) -> (min, max)
        const Stops stops(1, 1);
        const auto to_stops = [&](double x) { return kStop * stops.of(x); };
        lut(table_of(0, 1, [&](double x) { return x > 0 ? to_stops(x) : kStop * kNone; }),
            table_of(0, kHalfMax, to_stops));
        mix(1, 1, 0, 1);
        const HalfTable to_light = table_of(-17 * kStop, kUnseen * kStop,
                                            [&](double x) { return stops.light(x / kStop); });
        lut(to_light, to_light);
        // -> (min, max - min) -> (m, max - min) -> (m, p)
        mix(1, 0, -1, 1);
        lut(within(sample_half_domain(Expr::input() - stage.offset, 0, hi), 0, hi),
            table_of(0, kHalfMax, same_number));
        mix(1, 0, 1, 1);
        // -> stops -> (stops of m/p, stops of p)
        lut(to_p_stops, to_p_stops);
        mix(1, -1, 0, kStop);
        // -> (stops of saturation, n)
        lut(table_of(0, kUnseen, [&](double x) { return lost(-std::expm1(-x * std::log(2.0))); }),
            added.forward);
    }
    // -> (stops of saturation + n, n) -> (stops of saturation + loss, stops of p)
    mix(1, 1, 0, 1);
    const double largest = kStop * kNone * (2 + std::fabs(added.k));
    lut(table_of(-largest, largest, same_number), added.backward);
    mix(added.sign, -added.k, 0, 1);
    // -> (saturation, value)
    lut(table_of(-kStop, kAllLost * kStop,
                 [&](double x) {
                     const double stops = at_bend + x / kStop;
                     return stops < kAllLost - 0.5 ? std::exp2(-std::max(stops, 0.0)) : 0;
                 }),
        within(to_table(columns.value), -kHalfMax, kHalfMax));
    ops.push_back({MatrixOp{inverse(hue_last)}});
    ops.push_back({FixedFunctionOp{"RGB_TO_HSV"}, true});
    return ops;
}

TONEWRIGHT_NAMESPACE_END
