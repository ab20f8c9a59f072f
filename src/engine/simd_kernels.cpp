// SPDX-License-Identifier: Apache-2.0
//
// The one file that Highway compiles once for each instruction set; the best one is chosen when
// it runs. A separate function for each operation over a tile, so that the choice of what to do is
// made once in 256 pixels or so, and the values of a tile never leave the first-level cache.
#include "engine/simd_kernels.h"

#include <algorithm>
#include <cstring>
#include <span>

#if defined(__GNUC__) && !defined(__clang__)
// GCC's AVX-512 header hands an undefined vector to instructions that do not read it.
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include "base/strings.h"
#include "engine/kernel_targets.h"
#include "tonewright/error.h"

#ifndef TONEWRIGHT_SIMD_KERNELS_ONCE
#define TONEWRIGHT_SIMD_KERNELS_ONCE
TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace {
/// See kernels_of_this_machine().
struct Compiled {
    template <std::int64_t kTarget>
    static constexpr const Target* kernels = nullptr;
};
}  // namespace
}  // namespace simd
TONEWRIGHT_NAMESPACE_END
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/simd_kernels.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep

#include "engine/machine_code.h"
#include "engine/simd_math-inl.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace HWY_NAMESPACE {

using DF = hn::ScalableTag<float>;
using DD = hn::ScalableTag<double>;
/// As many floats as there are doubles in a vector.
using DFOfDD = hn::Rebind<float, DD>;

/// Where the values of a tile are.
struct Frame {
    unsigned char* registers;
    const unsigned char* constants;
    std::size_t count;  // padded to whole vectors of the widest kind
};

/// One operand, ready to be read: a constant is read from the same vector again and again.
struct Source {
    const unsigned char* data;
    std::size_t step;  // 1, or 0 for a constant
    bool wide;

    Source(const Frame& frame, const Operand& operand)
        : data((operand.constant ? frame.constants : frame.registers) + operand.offset),
          step(operand.constant ? 0 : 1),
          wide(operand.wide) {}

    HWY_INLINE Vec<DF> load(DF d, std::size_t i) const {
        return hn::Load(d, reinterpret_cast<const float*>(data) + i * step);
    }
    HWY_INLINE Vec<DFOfDD> load(DFOfDD d, std::size_t i, int /*half*/) const {
        return hn::Load(d, reinterpret_cast<const float*>(data) + i * step);
    }
    HWY_INLINE Vec<DD> load(DD d, std::size_t i) const {
        if (wide) return hn::Load(d, reinterpret_cast<const double*>(data) + i * step);
        return hn::PromoteTo(d, load(DFOfDD(), i, 0));
    }
};

/// f(d, a, b, ...) over a tile of floats.
template <class F, class... S>
HWY_INLINE void map_float(const Frame& frame, const Instruction& step, F f, S... source) {
    const DF d;
    const std::size_t count = frame.count;
    auto* const out = reinterpret_cast<float*>(frame.registers + step.out.offset);
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        hn::Store(f(d, source.load(d, i)...), d, out + i);
    }
}

HWY_INLINE void store_wide(const Frame& frame, const Operand& out, std::size_t i, Vec<DD> value) {
    if (out.wide) {
        hn::Store(value, DD(), reinterpret_cast<double*>(frame.registers + out.offset) + i);
    } else {
        const DFOfDD d;
        hn::Store(hn::DemoteTo(d, value), d,
                  reinterpret_cast<float*>(frame.registers + out.offset) + i);
    }
}

/// As a double; `kIsWide`: it is one.
template <bool kIsWide>
HWY_INLINE Vec<DD> load_double(DD d, const Source& source, std::size_t i) {
    if constexpr (kIsWide) {
        return hn::Load(d, reinterpret_cast<const double*>(source.data) + i * source.step);
    } else {
        return source.load(d, i);
    }
}

template <bool kAllWide, bool kIsOutWide, class F, class... S>
HWY_INLINE void map_double_as(const Frame& frame, const Instruction& step, F f, S... source) {
    const DD d;
    const DFOfDD narrow;
    const std::size_t count = frame.count;
    unsigned char* const out = frame.registers + step.out.offset;
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        const auto value = f(d, load_double<kAllWide>(d, source, i)...);
        if constexpr (kIsOutWide) {
            hn::Store(value, d, reinterpret_cast<double*>(out) + i);
        } else {
            hn::Store(hn::DemoteTo(narrow, value), narrow, reinterpret_cast<float*>(out) + i);
        }
    }
}

/// The same computed in double; operands and result are either, and what they are is decided before
/// the loop.
template <class F, class... S>
HWY_INLINE void map_double(const Frame& frame, const Instruction& step, F f, S... source) {
    if ((source.wide && ...)) {
        if (step.out.wide) return map_double_as<true, true>(frame, step, f, source...);
        return map_double_as<true, false>(frame, step, f, source...);
    }
    if (step.out.wide) return map_double_as<false, true>(frame, step, f, source...);
    map_double_as<false, false>(frame, step, f, source...);
}

/// f over N operands, in float or double as the instruction says.
template <class F, std::size_t... N>
HWY_INLINE void map(const Frame& frame, const Instruction& step, F f, std::index_sequence<N...>) {
    if (step.wide) {
        map_double(frame, step, f, Source(frame, step.in[N])...);
    } else {
        map_float(frame, step, f, Source(frame, step.in[N])...);
    }
}
template <int kOperands, class F>
HWY_INLINE void map(const Frame& frame, const Instruction& step, F f) {
    map(frame, step, f, std::make_index_sequence<kOperands>());
}

/// One for true, as the comparisons of expressions are.
template <class D, class M>
HWY_INLINE Vec<D> one_where(D d, M mask) {
    return hn::IfThenElseZero(mask, hn::Set(d, static_cast<hn::TFromD<D>>(1)));
}

// Min and Max of the processor return their second operand when equal or not ordered; with the
// operands in this order that is what expressions mean: b < a ? b : a.
template <class V>
HWY_INLINE V minimum(V a, V b) {
    return hn::Min(b, a);
}
template <class V>
HWY_INLINE V maximum(V a, V b) {
    return hn::Max(b, a);
}

/// A result of a wide operation to where it goes.
HWY_INLINE void store_result(const Frame& frame, const Operand& out, std::size_t i, Vec<DD> value) {
    store_wide(frame, out, i, value);
}
HWY_INLINE void store_result(const Frame& frame, const Operand& out, std::size_t i, Vec<DF> value) {
    hn::Store(value, DF(), reinterpret_cast<float*>(frame.registers + out.offset) + i);
}

/// Operands loaded, and converted, once for all rows.
template <class D>
HWY_INLINE void dot3(D d, const Frame& frame, const Instruction& step) {
    using T = hn::TFromD<D>;
    const Source a(frame, step.in[0]);
    const Source b(frame, step.in[1]);
    const Source c(frame, step.in[2]);
    const auto k = [&step, d](std::size_t i)
                       HWY_ATTR { return hn::Set(d, static_cast<T>(step.k[i])); };
    for (std::size_t i = 0; i < frame.count; i += hn::Lanes(d)) {
        const auto va = a.load(d, i);
        const auto vb = b.load(d, i);
        const auto vc = c.load(d, i);
        for (std::size_t row = 0; row < 3; ++row) {
            if (step.channel[row].constant) continue;
            const auto sum = hn::MulAdd(k(3 * row + 2), vc,
                                        hn::MulAdd(k(3 * row + 1), vb, hn::Mul(k(3 * row), va)));
            store_result(frame, step.channel[row], i, sum);
        }
    }
}

HWY_NOINLINE void dot3(const Frame& frame, const Instruction& step) {
    if (step.wide) {
        dot3(DD(), frame, step);
    } else {
        dot3(DF(), frame, step);
    }
}

HWY_NOINLINE void exp2(const Frame& frame, const Instruction& step) {
    const Source a(frame, step.in[0]);
    if (step.wide) {
        map_double(
            frame, step, [](DD d, Vec<DD> x) HWY_ATTR { return exp2_double(d, x); }, a);
    } else {
        map_float(
            frame, step, [](DF d, Vec<DF> x) HWY_ATTR { return exp2_float(d, x); }, a);
    }
}

HWY_NOINLINE void log2(const Frame& frame, const Instruction& step) {
    const Source a(frame, step.in[0]);
    if (step.wide || !HWY_NATIVE_FMA) {  // the float form needs the product rounded with the sum
        map_double(
            frame, step, [](DD d, Vec<DD> x) HWY_ATTR { return log2_double(d, x); }, a);
    } else {
        map_float(
            frame, step, [](DF d, Vec<DF> x) HWY_ATTR { return log2_float(d, x); }, a);
    }
}

HWY_NOINLINE void power(const Frame& frame, const Instruction& step) {
    const Source a(frame, step.in[0]);
    const Source b(frame, step.in[1]);
    if (step.wide) {
        const auto power = [](DD d, Vec<DD> x, Vec<DD> y) HWY_ATTR {
            return power_of_any(d, x, y, power_double(d, hn::Abs(x), y));
        };
        map_double(frame, step, power, a, b);
        return;
    }
    const DD d;
    const DFOfDD df;
    auto* out = reinterpret_cast<float*>(frame.registers + step.out.offset);
    for (std::size_t i = 0; i < frame.count; i += hn::Lanes(d)) {
        const auto x = a.load(df, i, 0);
        const auto y = b.load(df, i, 0);
        const auto magnitude = power_float(d, hn::Abs(x), hn::PromoteTo(d, y));
        hn::Store(power_of_any(df, x, y, magnitude), df, out + i);
    }
}

HWY_NOINLINE void power_constant(const Frame& frame, const Instruction& step) {
    const Source a(frame, step.in[0]);
    const double y = step.k[0];
    const auto y_float = static_cast<float>(y);
    auto* out = reinterpret_cast<float*>(frame.registers + step.out.offset);
    if (step.wide) {
        const auto power = [y](DD d, Vec<DD> x) HWY_ATTR {
            return power_of_any(d, x, y, power_double(d, x, hn::Set(d, y)));
        };
        map_double(frame, step, power, a);
    } else if (-kNearPower <= y && y <= kNearPower) {
        const auto power = [y, y_float](DF d, Vec<DF> x) HWY_ATTR {
            return power_of_any(d, x, y_float, power_near(d, x, y));
        };
        map_float(frame, step, power, a);
    } else {
        const DD d;
        const DFOfDD df;
        for (std::size_t i = 0; i < frame.count; i += hn::Lanes(d)) {
            const auto x = a.load(df, i, 0);
            const auto result = power_float(d, x, hn::Set(d, y));
            hn::Store(power_of_any(df, x, y_float, result), df, out + i);
        }
    }
}

HWY_NOINLINE void lookup(const Frame& frame, const Instruction& step, const SampledTable& table) {
    const Source a(frame, step.in[0]);
    const std::size_t n = table.wide.size();
    const bool linear = table.interpolation == Table::Interpolation::linear;
    const auto in_float = [&](DF d, Vec<DF> x) HWY_ATTR {
        return linear ? lookup_linear(d, x, table.narrow.data(), n)
                      : lookup_step(d, x, table.narrow.data(), n);
    };
    const auto in_double = [&](DD d, Vec<DD> x) HWY_ATTR {
        return linear ? lookup_linear(d, x, table.wide.data(), n)
                      : lookup_step(d, x, table.wide.data(), n);
    };
    if (step.wide) {
        map_double(frame, step, in_double, a);
    } else {
        map_float(frame, step, in_float, a);
    }
}

/// One value of an operand at a time, as its own type.
template <class F>
HWY_INLINE void with_number(const Frame& frame, const Operand& operand, std::size_t i, F use) {
    if (operand.wide) {
        use(reinterpret_cast<double*>(frame.registers + operand.offset)[i]);
    } else {
        use(reinterpret_cast<float*>(frame.registers + operand.offset)[i]);
    }
}

/// Always in double. Pixel by pixel: gathers are slower, and all tables lie in one line of memory.
HWY_NOINLINE void lookup_nonuniform(const Frame& frame, const Instruction& step,
                                    const NonuniformTables& tables) {
    const DD d;
    const hn::CappedTag<double, 4> part;
    const std::size_t lanes = hn::Lanes(d);
    const Source source(frame, step.in[0]);
    const auto first = hn::Set(d, tables.first);
    const auto last = hn::Set(d, tables.last);
    const auto parts_per_unit = hn::Set(d, tables.parts_per_unit);
    alignas(kVectorBytes) double place[kLaneMultiple];
    alignas(kVectorBytes) double part_of[kLaneMultiple];
    alignas(kVectorBytes) double values[4];
    for (std::size_t i = 0; i < frame.count; i += lanes) {
        const auto x = source.load(d, i);
        // NaN -> the first position: the comparison fails.
        const auto t = hn::Min(hn::IfThenElse(hn::Gt(x, first), x, first), last);
        hn::Store(t, d, place);
        hn::Store(hn::Mul(hn::Sub(t, first), parts_per_unit), d, part_of);
        for (std::size_t p = 0; p < lanes; ++p) {
            std::size_t cell = tables.first_cell[static_cast<std::size_t>(part_of[p])];
            for (int k = 0; k < tables.steps; ++k)
                cell += place[p] >= tables.end[cell] ? 1 : 0;
            const NonuniformTables::Line& line = tables.lines[cell];
            const auto at = hn::Set(part, place[p]);
            for (std::size_t c = 0; c < 4; c += hn::Lanes(part)) {
                hn::Store(hn::MulAdd(hn::Load(part, line.slope.data() + c), at,
                                     hn::Load(part, line.constant.data() + c)),
                          part, values + c);
            }
            for (std::size_t c = 0; c < 3; ++c) {
                if (step.channel[c].constant) continue;
                with_number(frame, step.channel[c], i + p, [&](auto& out) {
                    out = static_cast<std::decay_t<decltype(out)>>(values[c]);
                });
            }
        }
    }
}

/// A float operand, or a double one rounded to float.
HWY_INLINE Vec<DF> load_narrow(DF d, const Source& source, std::size_t i) {
    if (!source.wide) return source.load(d, i);
#if HWY_TARGET == HWY_SCALAR
    return hn::DemoteTo(d, source.load(DD(), i));
#else
    const hn::Half<DF> half;
    const auto lower = hn::DemoteTo(half, source.load(DD(), i));
    const auto upper = hn::DemoteTo(half, source.load(DD(), i + hn::Lanes(half)));
    return hn::Combine(d, upper, lower);
#endif
}

#if HWY_TARGET <= HWY_AVX3

/// The curve's degree as a constant.
template <class F>
HWY_INLINE void with_degree(const CompiledCurve& curve, F run) {
    static_assert(CompiledCurve::kMinDegree == 3 && CompiledCurve::kMaxDegree == 9);
    switch (curve.degree) {
        case 3:
            return run(std::integral_constant<int, 3>());
        case 4:
            return run(std::integral_constant<int, 4>());
        case 5:
            return run(std::integral_constant<int, 5>());
        case 6:
            return run(std::integral_constant<int, 6>());
        case 7:
            return run(std::integral_constant<int, 7>());
        case 8:
            return run(std::integral_constant<int, 8>());
        default:
            return run(std::integral_constant<int, 9>());
    }
}

/// 16, 32 or 64 numbers, and those of them that a vector of indices picks.
template <int kSize>
struct PermutedTable {
    Vec<DF> part[kSize / 16];

    HWY_INLINE explicit PermutedTable(const float* numbers) {
        for (int i = 0; i < kSize / 16; ++i)
            part[i] = hn::Load(DF(), numbers + 16 * i);
    }
    HWY_INLINE Vec<DF> at(Vec<hn::RebindToSigned<DF>> index) const {
        if constexpr (kSize == 16) {
            return Vec<DF>{_mm512_permutexvar_ps(index.raw, part[0].raw)};
        } else {
            const auto low = _mm512_permutex2var_ps(part[0].raw, index.raw, part[1].raw);
            if constexpr (kSize == 32) return Vec<DF>{low};
            const auto high = _mm512_permutex2var_ps(part[kSize / 16 - 2].raw, index.raw,
                                                     part[kSize / 16 - 1].raw);
            const __mmask16 is_high = _mm512_test_epi32_mask(index.raw, _mm512_set1_epi32(32));
            return Vec<DF>{_mm512_mask_blend_ps(is_high, low, high)};
        }
    }
};

/// The segment that x is in.
template <int kCells, int kSegments>
struct SegmentFinder {
    using DI = hn::RebindToSigned<DF>;
    PermutedTable<kCells> threshold;
    PermutedTable<kCells> segment;
    Vec<DF> cell_floor;
    Vec<DI> first_cell;
    int shift;

    HWY_INLINE explicit SegmentFinder(const CompiledCurve& curve)
        : threshold(curve.threshold.data()),
          segment(reinterpret_cast<const float*>(curve.segment.data())),
          cell_floor(hn::Set(DF(), curve.cell_floor)),
          first_cell(hn::Set(DI(), static_cast<std::int32_t>(curve.first_cell))),
          shift(curve.shift) {}

    HWY_INLINE Vec<DI> operator()(Vec<DF> x) const {
        const DI di;
        const auto bits = hn::BitCast(di, hn::Max(x, cell_floor));
        const auto cell = hn::Sub(hn::ShiftRightSame(bits, shift), first_cell);
        const auto is_behind = hn::RebindMask(di, hn::Ge(x, threshold.at(cell)));
        return hn::Sub(hn::BitCast(di, segment.at(cell)), hn::VecFromMask(di, is_behind));
    }
};

/// Without cells: a bit of the index at a time, the highest first.
template <int kSegments>
struct SegmentFinder<0, kSegments> {
    using DI = hn::RebindToSigned<DF>;
    PermutedTable<kSegments> threshold;

    HWY_INLINE explicit SegmentFinder(const CompiledCurve& curve)
        : threshold(curve.threshold.data()) {}

    HWY_INLINE Vec<DI> operator()(Vec<DF> x) const {
        const DI di;
        auto index = hn::Zero(di);
        for (int bit = kSegments / 2; bit > 0; bit /= 2) {
            const auto next = hn::Or(index, hn::Set(di, bit));
            const auto is_there = hn::RebindMask(di, hn::Ge(x, threshold.at(next)));
            index = hn::IfThenElse(is_there, next, index);
        }
        return index;
    }
};

/// Two vectors of doubles, as many as there are floats in one.
struct DoublePair {
    Vec<DD> lower, upper;
};

HWY_INLINE DoublePair promote(Vec<DF> x) {
    const hn::Half<DF> half;
    return {hn::PromoteTo(DD(), hn::LowerHalf(half, x)),
            hn::PromoteTo(DD(), hn::UpperHalf(half, x))};
}
HWY_INLINE Vec<DF> demote(const DoublePair& x) {
    const hn::Half<DF> half;
    return hn::Combine(DF(), hn::DemoteTo(half, x.upper), hn::DemoteTo(half, x.lower));
}

template <int kCells, int kSegments, int kDegree, bool kIsPrecise>
HWY_NOINLINE void run_curve(const Frame& frame, const Instruction& step,
                            const CompiledCurve& curve) {
    const DF d;
    const SegmentFinder<kCells, kSegments> find_segment(curve);
    const PermutedTable<kSegments> scale(curve.scale.data());
    const PermutedTable<kSegments> offset(curve.offset.data());
    const auto coefficient = [&curve](int k) HWY_ATTR {
        return PermutedTable<kSegments>(curve.coefficient[static_cast<std::size_t>(k)].data());
    };
    const auto lo = hn::Set(d, curve.lo);
    const auto hi = hn::Set(d, curve.hi);
    // NaN is not above lo.
    const auto finished = [&curve](auto tag, auto y, auto is_above) HWY_ATTR {
        using T = hn::TFromD<decltype(tag)>;
        const auto number = [tag](auto k) HWY_ATTR { return hn::Set(tag, static_cast<T>(k)); };
        const auto limited = hn::Min(hn::Max(y, number(curve.least)), number(curve.most));
        return hn::IfThenElse(is_above, limited, number(curve.at_lo));
    };
    const Source source(frame, step.in[0]);
    for (std::size_t i = 0; i < frame.count; i += hn::Lanes(d)) {
        const auto given = load_narrow(d, source, i);
        const auto x = hn::Min(hn::Max(given, lo), hi);
        const auto index = find_segment(x);
        auto t = hn::MulAdd(x, scale.at(index), offset.at(index));
        if (kIsPrecise && source.wide) {
            const DD dd;
            const DoublePair rounded = promote(given);
            const auto rest = demote({hn::Sub(source.load(dd, i), rounded.lower),
                                      hn::Sub(source.load(dd, i + hn::Lanes(dd)), rounded.upper)});
            const auto is_inside = hn::Eq(given, x);
            t = hn::MulAdd(hn::IfThenElseZero(is_inside, rest), scale.at(index), t);
        }
        auto y = coefficient(kDegree).at(index);
        for (int k = kDegree - 1; k >= 1; --k)
            y = hn::MulAdd(y, t, coefficient(k).at(index));
        const auto first = coefficient(0).at(index);
        if constexpr (kIsPrecise) {
            const PermutedTable<kSegments> rest(curve.rest.data());
            const DoublePair base = promote(first);
            const DoublePair change = promote(hn::MulAdd(y, t, rest.at(index)));
            const DoublePair sum = {hn::Add(base.lower, change.lower),
                                    hn::Add(base.upper, change.upper)};
            const DD dd;
            const DoublePair from = promote(x);
            const auto at_lo = hn::Set(dd, static_cast<double>(curve.lo));
            store_wide(frame, step.out, i, finished(dd, sum.lower, hn::Gt(from.lower, at_lo)));
            store_wide(frame, step.out, i + hn::Lanes(dd),
                       finished(dd, sum.upper, hn::Gt(from.upper, at_lo)));
        } else {
            hn::Store(finished(d, hn::MulAdd(y, t, first), hn::Gt(x, lo)), d,
                      reinterpret_cast<float*>(frame.registers + step.out.offset) + i);
        }
    }
}

template <int kCells, int kSegments, int kDegree>
HWY_INLINE void run_curve(const Frame& frame, const Instruction& step, const CompiledCurve& curve) {
    if (curve.is_precise) return run_curve<kCells, kSegments, kDegree, true>(frame, step, curve);
    run_curve<kCells, kSegments, kDegree, false>(frame, step, curve);
}

template <int kCells, int kSegments>
HWY_INLINE void run_curve(const Frame& frame, const Instruction& step, const CompiledCurve& curve) {
    with_degree(curve, [&](auto degree)
                           HWY_ATTR { run_curve<kCells, kSegments, degree>(frame, step, curve); });
}

HWY_NOINLINE void curve(const Frame& frame, const Instruction& step, const CompiledCurve& curve) {
    if (curve.cells == 0) {
        if (curve.segments <= 16) return run_curve<0, 16>(frame, step, curve);
        if (curve.segments <= 32) return run_curve<0, 32>(frame, step, curve);
        return run_curve<0, 64>(frame, step, curve);
    }
    if (curve.cells <= 32) {
        if (curve.segments <= 16) return run_curve<32, 16>(frame, step, curve);
        if (curve.segments <= 32) return run_curve<32, 32>(frame, step, curve);
        return run_curve<32, 64>(frame, step, curve);
    }
    if (curve.segments <= 16) return run_curve<64, 16>(frame, step, curve);
    if (curve.segments <= 32) return run_curve<64, 32>(frame, step, curve);
    return run_curve<64, 64>(frame, step, curve);
}

constexpr CurveForm kCurveForm = CurveForm::segments;

#elif HWY_TARGET <= HWY_SSE4

using DI = hn::RebindToSigned<DF>;

/// Whole numbers on their way to addresses: through memory, where a load for each costs less than
/// taking a vector apart.
HWY_INLINE void store_places(Vec<DI> places, std::uint32_t* at) {
    hn::Store(hn::BitCast(hn::RebindToUnsigned<DF>(), places), hn::RebindToUnsigned<DF>(), at);
    __asm__("" : "+m"(*reinterpret_cast<std::uint32_t(*)[kLaneMultiple]>(at)));
}

/// Four numbers in a row for each pixel, as four vectors: twice as fast as gathers.
HWY_INLINE void load_rows(const float* numbers, const std::uint32_t* at, Vec<DF>* result) {
    for (int p = 0; p < 4; ++p) {
        const __m128 row = _mm_loadu_ps(numbers + at[p]);
#if HWY_TARGET <= HWY_AVX2
        result[p].raw =
            _mm256_insertf128_ps(_mm256_castps128_ps256(row), _mm_loadu_ps(numbers + at[p + 4]), 1);
#else
        result[p].raw = row;
#endif
    }
    const DF d;
    const hn::Repartition<double, DF> pairs;
    const auto in_pairs = [&](Vec<DF> x) HWY_ATTR { return hn::BitCast(pairs, x); };
    const auto low01 = in_pairs(hn::InterleaveLower(d, result[0], result[1]));
    const auto high01 = in_pairs(hn::InterleaveUpper(d, result[0], result[1]));
    const auto low23 = in_pairs(hn::InterleaveLower(d, result[2], result[3]));
    const auto high23 = in_pairs(hn::InterleaveUpper(d, result[2], result[3]));
    result[0] = hn::BitCast(d, hn::InterleaveLower(pairs, low01, low23));
    result[1] = hn::BitCast(d, hn::InterleaveUpper(pairs, low01, low23));
    result[2] = hn::BitCast(d, hn::InterleaveLower(pairs, high01, high23));
    result[3] = hn::BitCast(d, hn::InterleaveUpper(pairs, high01, high23));
}

/// The polynomial of a curve in rows, but for its constant.
template <int kLength, bool kHasRestarts>
class RowPolynomial {
  public:
    HWY_INLINE explicit RowPolynomial(const CurveRows& rows)
        : numbers_(rows.numbers.data()),
          restarts_(rows.restarts),
          shift_(rows.shift),
          base_(hn::Set(DI(), static_cast<std::int32_t>(rows.base))) {}

    struct Place {
        Vec<DF> x0, scale;
    };
    /// Of numbers above 0; where their rows begin goes to `at`.
    HWY_INLINE Place find(Vec<DF> x, std::uint32_t* at) const {
        const DF d;
        const DI di;
        auto base = base_;
        const auto bits = hn::BitCast(di, hn::Max(x, hn::BitCast(d, base)));
        if constexpr (kHasRestarts) {
            for (const CurveRows::Restart& restart : restarts_) {
                const auto is_behind =
                    hn::Gt(bits, hn::Set(di, static_cast<std::int32_t>(restart.from) - 1));
                base = hn::IfThenElse(is_behind,
                                      hn::Set(di, static_cast<std::int32_t>(restart.base)), base);
            }
        }
        const auto cell = hn::ShiftRightSame(hn::Sub(bits, base), shift_);
        store_places(hn::ShiftLeft<(kLength == 4 ? 2 : 3)>(cell), at);
        const auto x0 = hn::Add(hn::ShiftLeftSame(cell, shift_), base);
        const auto scale = hn::Sub(hn::Set(di, 0x7F000000), hn::And(x0, hn::Set(di, 0x7F800000)));
        return {hn::BitCast(d, x0), hn::BitCast(d, scale)};
    }
    /// @param number  the first four of each row: constant (and rest, of a precise curve) are left
    HWY_INLINE Vec<DF> sum(const std::uint32_t* at, Vec<DF> t, Vec<DF>* number) const {
        auto y = hn::Zero(DF());
        if constexpr (kLength == 8) {
            load_rows(numbers_ + 4, at, number);
            y = number[3];
            for (int k = 2; k >= 0; --k)
                y = hn::MulAdd(y, t, number[k]);
        }
        load_rows(numbers_, at, number);
        y = kLength == 8 ? hn::MulAdd(y, t, number[3]) : number[3];
        return hn::MulAdd(hn::MulAdd(y, t, number[2]), t, number[1]);
    }

  private:
    const float* numbers_;
    std::span<const CurveRows::Restart> restarts_;
    int shift_;
    Vec<DI> base_;
};

/// A curve of floats. Its numbers are vectors from the start: what is written may not be them.
template <int kLength, bool kHasRestarts>
class RowCurve {
  public:
    HWY_INLINE explicit RowCurve(const CompiledCurve& curve)
        : polynomial_(*curve.rows),
          lo_(hn::Set(DF(), curve.lo)),
          hi_(hn::Set(DF(), curve.hi)),
          least_(hn::Set(DF(), curve.least)),
          most_(hn::Set(DF(), curve.most)),
          at_lo_(hn::Set(DF(), static_cast<float>(curve.at_lo))) {}

    HWY_INLINE Vec<DF> operator()(Vec<DF> given) const {
        alignas(kVectorBytes) std::uint32_t at[kLaneMultiple];
        const auto x = hn::Min(hn::Max(given, lo_), hi_);
        const auto place = polynomial_.find(x, at);
        const auto t = hn::Mul(hn::Sub(x, place.x0), place.scale);
        Vec<DF> number[4];
        const auto sum = polynomial_.sum(at, t, number);
        const auto y = hn::MulAdd(sum, t, number[0]);
        // NaN is not above lo.
        return hn::IfThenElse(hn::Gt(x, lo_), hn::Min(hn::Max(y, least_), most_), at_lo_);
    }

  private:
    RowPolynomial<kLength, kHasRestarts> polynomial_;
    Vec<DF> lo_, hi_, least_, most_, at_lo_;
};

template <int kLength, bool kHasRestarts>
HWY_NOINLINE void run_rows(const Frame& frame, const Instruction& step,
                           const CompiledCurve& curve) {
    const DF d;
    const RowCurve<kLength, kHasRestarts> at(curve);
    const Source source(frame, step.in[0]);  // float or double
    auto* const out = reinterpret_cast<float*>(frame.registers + step.out.offset);
    for (std::size_t i = 0; i < frame.count; i += hn::Lanes(d))
        hn::Store(at(load_narrow(d, source, i)), d, out + i);
}

template <int kLength, bool kHasRestarts>
HWY_NOINLINE void run_precise_rows(const Frame& frame, const Instruction& step,
                                   const CompiledCurve& curve) {
    const DF d;
    const DD dd;
    const hn::Half<DF> half;
    const RowPolynomial<kLength, kHasRestarts> polynomial(*curve.rows);
    const auto lo = hn::Set(d, curve.lo);
    const auto hi = hn::Set(d, curve.hi);
    const auto lowest = hn::Set(dd, static_cast<double>(curve.lo));
    const auto least = hn::Set(dd, static_cast<double>(curve.least));
    const auto most = hn::Set(dd, static_cast<double>(curve.most));
    const auto at_lo = hn::Set(dd, curve.at_lo);
    const auto promote = [dd, half](Vec<DF> x, bool is_upper) HWY_ATTR {
        return hn::PromoteTo(dd, is_upper ? hn::UpperHalf(half, x) : hn::LowerHalf(half, x));
    };
    alignas(kVectorBytes) std::uint32_t at[kLaneMultiple];
    const Source source(frame, step.in[0]);
    for (std::size_t i = 0; i < frame.count; i += hn::Lanes(d)) {
        const auto given = load_narrow(d, source, i);
        const auto x = hn::Min(hn::Max(given, lo), hi);
        const auto place = polynomial.find(x, at);
        auto distance = hn::Sub(x, place.x0);
        if (source.wide) {
            const auto rest = hn::Combine(
                d,
                hn::DemoteTo(half,
                             hn::Sub(source.load(dd, i + hn::Lanes(dd)), promote(given, true))),
                hn::DemoteTo(half, hn::Sub(source.load(dd, i), promote(given, false))));
            distance = hn::Add(distance, hn::IfThenElseZero(hn::Eq(given, x), rest));
        }
        Vec<DF> number[4];
        const auto change = polynomial.sum(at, hn::Mul(distance, place.scale), number);
        for (int upper = 0; upper < 2; ++upper) {
            const auto y = hn::Add(promote(number[0], upper > 0), promote(change, upper > 0));
            const auto limited = hn::Min(hn::Max(y, least), most);
            // NaN is not above lo.
            store_wide(frame, step.out, i + (upper > 0 ? hn::Lanes(dd) : 0),
                       hn::IfThenElse(hn::Gt(promote(x, upper > 0), lowest), limited, at_lo));
        }
    }
}

HWY_NOINLINE void curve(const Frame& frame, const Instruction& step, const CompiledCurve& curve) {
    const bool has_restarts = !curve.rows->restarts.empty();
    if (curve.is_precise) {
        return has_restarts ? run_precise_rows<8, true>(frame, step, curve)
                            : run_precise_rows<8, false>(frame, step, curve);
    }
    if (curve.rows->length == 8) {
        return has_restarts ? run_rows<8, true>(frame, step, curve)
                            : run_rows<8, false>(frame, step, curve);
    }
    return has_restarts ? run_rows<4, true>(frame, step, curve)
                        : run_rows<4, false>(frame, step, curve);
}

/// The curve of every float.
/// @param is_rgba  every fourth is left as it is
template <int kLength, bool kHasRestarts>
HWY_NOINLINE void run_flat(const CompiledCurve& curve, const float* in, float* out,
                           std::size_t count, bool is_rgba) {
    const DF d;
    const DI di;
    const std::size_t lanes = hn::Lanes(d);
    const RowCurve<kLength, kHasRestarts> at(curve);
    const auto channel = hn::And(hn::Iota(di, 0), hn::Set(di, 3));
    const auto is_left = hn::RebindMask(d, hn::Eq(channel, hn::Set(di, is_rgba ? 3 : 4)));
    const std::size_t whole = count / lanes * lanes;
    for (std::size_t i = 0; i < whole; i += lanes) {
        const auto y = at(hn::LoadU(d, in + i));
        hn::StoreU(is_rgba ? hn::IfThenElse(is_left, hn::LoadU(d, out + i), y) : y, d, out + i);
    }
    alignas(kVectorBytes) float rest[kLaneMultiple] = {};
    std::copy(in + whole, in + count, rest);
    hn::Store(at(hn::Load(d, rest)), d, rest);
    for (std::size_t i = whole; i < count; ++i) {
        if (!is_rgba || i % 4 != 3) out[i] = rest[i - whole];
    }
}

HWY_INLINE void run_flat(const CompiledCurve& curve, const float* in, float* out, std::size_t count,
                         bool is_rgba) {
    const bool has_restarts = !curve.rows->restarts.empty();
    if (curve.rows->length == 8) {
        return has_restarts ? run_flat<8, true>(curve, in, out, count, is_rgba)
                            : run_flat<8, false>(curve, in, out, count, is_rgba);
    }
    return has_restarts ? run_flat<4, true>(curve, in, out, count, is_rgba)
                        : run_flat<4, false>(curve, in, out, count, is_rgba);
}

constexpr CurveForm kCurveForm = HWY_NATIVE_FMA ? CurveForm::rows : CurveForm::rows_unfused;

#else

/// Programs for this instruction set have no compiled curves.
HWY_INLINE void curve(const Frame& /*frame*/, const Instruction& /*step*/,
                      const CompiledCurve& /*curve*/) {
    HWY_ABORT("a compiled curve on an instruction set without them");
}

constexpr CurveForm kCurveForm = CurveForm::none;

#endif

/// Pixels of a lattice at a time. A read that spans several writes which have not reached the cache
/// waits for them: with a loop of its own for each step, and this many pixels between, none does.
inline constexpr std::size_t kLatticeBlock = 64;

/// Nodes and weights of a block of pixels.
template <class T>
struct LatticePlaces {
    /// Where the node's numbers begin among those of all nodes.
    alignas(kVectorBytes) std::int32_t node[4][kLatticeBlock];
    alignas(kVectorBytes) T weight[4][kLatticeBlock];
};

HWY_INLINE Vec<hn::RebindToSigned<DF>> to_whole(Vec<DF> x) {
    return hn::ConvertTo(hn::RebindToSigned<DF>(), x);
}
HWY_INLINE Vec<hn::Rebind<std::int32_t, DD>> to_whole(Vec<DD> x) {
    return hn::DemoteTo(hn::Rebind<std::int32_t, DD>(), x);
}

template <class D>
HWY_INLINE void find_places(D d, const std::array<Source, 3>& source, std::size_t i, int edge,
                            std::size_t in_block, LatticePlaces<hn::TFromD<D>>& places) {
    using T = hn::TFromD<D>;
    const auto one = hn::Set(d, static_cast<T>(1));
    std::array<Vec<D>, 3> cell = {one, one, one};
    std::array<Vec<D>, 3> f = {one, one, one};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto t = hn::Min(hn::Max(source[c].load(d, i), hn::Zero(d)), one);
        const auto place = hn::Mul(t, hn::Set(d, static_cast<T>(edge - 1)));
        cell[c] = hn::Min(hn::Floor(place), hn::Set(d, static_cast<T>(edge - 2)));
        f[c] = hn::Sub(place, cell[c]);
    }
    // Whole numbers below 2^24 are exact in float, and so is their sum.
    const auto n1 = hn::Set(d, static_cast<T>(edge));
    const auto n2 = hn::Mul(n1, n1);
    const auto corner = hn::MulAdd(cell[0], n2, hn::MulAdd(cell[1], n1, cell[2]));
    // Steps of the axes with the largest and the smallest fraction.
    const auto red_below_green = hn::Lt(f[0], f[1]);
    const auto upper = hn::Max(f[0], f[1]);
    const auto lower = hn::Min(f[0], f[1]);
    const auto step_upper = hn::IfThenElse(red_below_green, n1, n2);
    const auto step_lower = hn::IfThenElse(red_below_green, n2, n1);
    const auto step_highest = hn::IfThenElse(hn::Lt(upper, f[2]), one, step_upper);
    const auto step_lowest = hn::IfThenElse(hn::Lt(lower, f[2]), step_lower, one);
    const auto highest = hn::Max(upper, f[2]);
    const auto lowest = hn::Min(lower, f[2]);
    const auto middle = hn::Max(lower, hn::Min(upper, f[2]));
    const auto far = hn::Add(corner, hn::Add(hn::Add(n2, n1), one));
    const auto store = [&](std::size_t k, Vec<D> node, Vec<D> weight) HWY_ATTR {
        const hn::Rebind<std::int32_t, D> di;
        hn::Store(hn::ShiftLeft<2>(to_whole(node)), di, places.node[k] + in_block);
        hn::Store(weight, d, places.weight[k] + in_block);
    };
    store(0, corner, hn::Sub(one, highest));
    store(1, hn::Add(corner, step_highest), hn::Sub(highest, middle));
    store(2, hn::Sub(far, step_lowest), hn::Sub(middle, lowest));
    store(3, far, lowest);
}

/// Four nodes a pixel, each loaded whole: their places and weights for a vector of pixels, then
/// pixel by pixel.
template <class D>
HWY_INLINE void interpolate(D d, const Frame& frame, const Instruction& step, int edge,
                            const hn::TFromD<D>* nodes) {
    using T = hn::TFromD<D>;
    const std::size_t lanes = hn::Lanes(d);
    const hn::CappedTag<T, 4> part;
    const std::array<Source, 3> source = {Source(frame, step.in[0]), Source(frame, step.in[1]),
                                          Source(frame, step.in[2])};
    LatticePlaces<T> places;
    alignas(kVectorBytes) T pixels[4 * kLatticeBlock];
    for (std::size_t begin = 0; begin < frame.count; begin += kLatticeBlock) {
        const std::size_t count = HWY_MIN(kLatticeBlock, frame.count - begin);
        for (std::size_t p = 0; p < count; p += lanes)
            find_places(d, source, begin + p, edge, p, places);
        for (std::size_t p = 0; p < count; ++p) {
            for (std::size_t c = 0; c < 4; c += hn::Lanes(part)) {
                const auto node = [&](std::size_t k) HWY_ATTR {
                    return hn::LoadU(part, nodes + places.node[k][p] + c);
                };
                const auto weight = [&](std::size_t k)
                                        HWY_ATTR { return hn::Set(part, places.weight[k][p]); };
                auto sum = hn::Mul(weight(0), node(0));
                sum = hn::MulAdd(weight(1), node(1), sum);
                sum = hn::MulAdd(weight(2), node(2), sum);
                sum = hn::MulAdd(weight(3), node(3), sum);
                hn::Store(sum, part, pixels + 4 * p + c);
            }
        }
        for (std::size_t p = 0; p < count; p += lanes) {
#if HWY_TARGET == HWY_SCALAR
            const std::array<Vec<D>, 3> rgb = {hn::Load(d, pixels + 4 * p),
                                               hn::Load(d, pixels + 4 * p + 1),
                                               hn::Load(d, pixels + 4 * p + 2)};
#else
            // On NEON, std::array's own constructor cannot inline that of a vector.
            Vec<D> rgb[3];
            auto unused = hn::Undefined(d);
            hn::LoadInterleaved4(d, pixels + 4 * p, rgb[0], rgb[1], rgb[2], unused);
#endif
            for (std::size_t c = 0; c < 3; ++c) {
                if (!step.channel[c].constant)
                    store_result(frame, step.channel[c], begin + p, rgb[c]);
            }
        }
    }
}

HWY_NOINLINE void lattice(const Frame& frame, const Instruction& step,
                          const SampledLattice& table) {
    if (step.wide) {
        interpolate(DD(), frame, step, table.edge, table.wide.data());
    } else {
        interpolate(DF(), frame, step, table.edge, table.narrow.data());
    }
}

HWY_NOINLINE void run_instruction(const Frame& frame, const Code& code, const Instruction& step) {
    switch (step.op) {
        case Op::copy:
            return map<1>(frame, step, [](auto, auto a) HWY_ATTR { return a; });
        case Op::add:
            return map<2>(frame, step, [](auto, auto a, auto b) HWY_ATTR { return hn::Add(a, b); });
        case Op::subtract:
            return map<2>(frame, step, [](auto, auto a, auto b) HWY_ATTR { return hn::Sub(a, b); });
        case Op::multiply:
            return map<2>(frame, step, [](auto, auto a, auto b) HWY_ATTR { return hn::Mul(a, b); });
        case Op::divide:
            return map<2>(frame, step, [](auto, auto a, auto b) HWY_ATTR { return hn::Div(a, b); });
        case Op::multiply_add:
            return map<3>(frame, step, [](auto, auto a, auto b, auto c) HWY_ATTR {
                return hn::MulAdd(a, b, c);
            });
        case Op::multiply_subtract:
            return map<3>(frame, step, [](auto, auto a, auto b, auto c) HWY_ATTR {
                return hn::MulSub(a, b, c);
            });
        case Op::subtract_product:
            return map<3>(frame, step, [](auto, auto a, auto b, auto c) HWY_ATTR {
                return hn::NegMulAdd(a, b, c);
            });
        case Op::dot3:
            return dot3(frame, step);
        case Op::minimum:
            return map<2>(frame, step, [](auto, auto a, auto b) HWY_ATTR { return minimum(a, b); });
        case Op::maximum:
            return map<2>(frame, step, [](auto, auto a, auto b) HWY_ATTR { return maximum(a, b); });
        case Op::clamp:
            return map<3>(frame, step, [](auto, auto a, auto b, auto c) HWY_ATTR {
                return minimum(maximum(a, b), c);
            });
        case Op::negate:
            return map<1>(frame, step, [](auto, auto a) HWY_ATTR { return hn::Neg(a); });
        case Op::absolute:
            return map<1>(frame, step, [](auto, auto a) HWY_ATTR { return hn::Abs(a); });
        case Op::square_root:
            return map<1>(frame, step, [](auto, auto a) HWY_ATTR { return hn::Sqrt(a); });
        case Op::floor:
            return map<1>(frame, step, [](auto, auto a) HWY_ATTR { return hn::Floor(a); });
        case Op::exp2:
            return exp2(frame, step);
        case Op::log2:
            return log2(frame, step);
        case Op::power:
            return power(frame, step);
        case Op::power_constant:
            return power_constant(frame, step);
        case Op::sine:  // always in double: see the reduction
            return map_double(
                frame, step, [](DD d, Vec<DD> x) HWY_ATTR { return sine_double(d, x); },
                Source(frame, step.in[0]));
        case Op::cosine:
            return map_double(
                frame, step, [](DD d, Vec<DD> x) HWY_ATTR { return cosine_double(d, x); },
                Source(frame, step.in[0]));
        case Op::atan2:
            return map_double(
                frame, step,
                [](DD d, Vec<DD> y, Vec<DD> x) HWY_ATTR { return atan2_double(d, y, x); },
                Source(frame, step.in[0]), Source(frame, step.in[1]));
        case Op::less:
            return map<2>(frame, step, [](auto d, auto a, auto b) HWY_ATTR {
                return one_where(d, hn::Lt(a, b));
            });
        case Op::less_equal:
            return map<2>(frame, step, [](auto d, auto a, auto b) HWY_ATTR {
                return one_where(d, hn::Le(a, b));
            });
        case Op::equal:
            return map<2>(frame, step, [](auto d, auto a, auto b) HWY_ATTR {
                return one_where(d, hn::Eq(a, b));
            });
        case Op::select:
            return map<3>(frame, step, [](auto d, auto a, auto b, auto c) HWY_ATTR {
                return hn::IfThenElse(hn::Eq(a, hn::Zero(d)), c, b);
            });
        case Op::select_less:
            return map<4>(frame, step, [](auto, auto a, auto b, auto c, auto e) HWY_ATTR {
                return hn::IfThenElse(hn::Lt(a, b), c, e);
            });
        case Op::select_less_equal:
            return map<4>(frame, step, [](auto, auto a, auto b, auto c, auto e) HWY_ATTR {
                return hn::IfThenElse(hn::Le(a, b), c, e);
            });
        case Op::select_equal:
            return map<4>(frame, step, [](auto, auto a, auto b, auto c, auto e) HWY_ATTR {
                return hn::IfThenElse(hn::Eq(a, b), c, e);
            });
        case Op::lookup:
            return lookup(frame, step, code.tables[step.table]);
        case Op::lookup_nonuniform:
            return lookup_nonuniform(frame, step, code.positioned[step.table]);
        case Op::curve:
            return curve(frame, step, code.curves[step.table]);
        case Op::lattice:
            return lattice(frame, step, code.lattices[step.table]);
    }
}

// ---------------------------------------------------------------------------------------------
// Pixels in and out

/// NaN -> 0, then limited to +-65504.
HWY_INLINE Vec<DF> sanitized(DF d, Vec<DF> x) {
    const auto limit = hn::Set(d, kLargestInput);
    const auto number = hn::IfThenElseZero(hn::Eq(x, x), x);
    return hn::Min(hn::Max(number, hn::Neg(limit)), limit);
}

/// The planes are the interleaved channels of pixels `stride` floats long, in order.
template <class T>
HWY_INLINE bool are_interleaved(const std::array<T*, 3>& plane, std::ptrdiff_t stride) {
    return (stride == 3 || stride == 4) && plane[1] == plane[0] + 1 && plane[2] == plane[0] + 2;
}

HWY_NOINLINE void load_tile(const TilePorts& ports, unsigned char* registers,
                            const std::array<const float*, 3>& in, std::ptrdiff_t stride,
                            std::size_t count, std::size_t padded) {
    const DF d;
    const std::size_t lanes = hn::Lanes(d);
    // Channels that are not read get a place to be written to.
    alignas(kVectorBytes) float unused[kMaxTile];
    std::array<float*, 3> out;
    for (std::size_t c = 0; c < 3; ++c) {
        out[c] = ports.reads_input[c] ? reinterpret_cast<float*>(registers + ports.input_offset[c])
                                      : unused;
    }
    std::size_t done = 0;
    const auto store = [&](Vec<DF> r, Vec<DF> g, Vec<DF> b) HWY_ATTR {
        hn::Store(sanitized(d, r), d, out[0] + done);
        hn::Store(sanitized(d, g), d, out[1] + done);
        hn::Store(sanitized(d, b), d, out[2] + done);
    };
    if (stride == 1) {
        for (; done + lanes <= count; done += lanes) {
            store(hn::LoadU(d, in[0] + done), hn::LoadU(d, in[1] + done),
                  hn::LoadU(d, in[2] + done));
        }
    }
#if HWY_TARGET != HWY_SCALAR
    if (are_interleaved(in, stride)) {
        auto r = hn::Undefined(d);
        auto g = hn::Undefined(d);
        auto b = hn::Undefined(d);
        auto a = hn::Undefined(d);
        if (stride == 3) {
            for (; done + lanes <= count; done += lanes) {
                hn::LoadInterleaved3(d, in[0] + done * 3, r, g, b);
                store(r, g, b);
            }
        } else {
            // What follows the last pixel's three channels is not ours to read.
            for (; done + lanes < count; done += lanes) {
                hn::LoadInterleaved4(d, in[0] + done * 4, r, g, b, a);
                store(r, g, b);
            }
        }
    }
#endif
    for (std::size_t c = 0; c < 3; ++c) {
        const float* plane = in[c];
        for (std::size_t i = done; i < count; ++i) {
            out[c][i] = plane[static_cast<std::ptrdiff_t>(i) * stride];
        }
        for (std::size_t i = count; i < padded; ++i)
            out[c][i] = 0.0F;
        for (std::size_t i = done; i < padded; i += lanes) {
            hn::Store(sanitized(d, hn::Load(d, out[c] + i)), d, out[c] + i);
        }
    }
}

HWY_NOINLINE void store_tile(const TilePorts& ports, const Frame& frame,
                             const std::array<float*, 3>& out, std::ptrdiff_t stride,
                             std::size_t count) {
    const DF d;
    const std::size_t lanes = hn::Lanes(d);
    const std::array<Source, 3> value = {Source(frame, ports.output[0]),
                                         Source(frame, ports.output[1]),
                                         Source(frame, ports.output[2])};
    std::size_t done = 0;
    if (stride == 1) {
        for (; done + lanes <= count; done += lanes) {
            for (std::size_t c = 0; c < 3; ++c)
                hn::StoreU(value[c].load(d, done), d, out[c] + done);
        }
    }
#if HWY_TARGET != HWY_SCALAR
    if (are_interleaved(out, stride)) {
        if (stride == 3) {
            for (; done + lanes <= count; done += lanes) {
                hn::StoreInterleaved3(value[0].load(d, done), value[1].load(d, done),
                                      value[2].load(d, done), d, out[0] + done * 3);
            }
        }
#if HWY_TARGET <= HWY_AVX3
        // Masked stores leave the fourth channel alone.
        if (stride == 4) {
            alignas(kVectorBytes) float pixels[4 * kLaneMultiple];
            const hn::Rebind<std::int32_t, DF> di;
            const auto third = hn::And(hn::Iota(di, 0), hn::Set(di, 3));
            const auto ours = hn::RebindMask(d, hn::Lt(third, hn::Set(di, 3)));
            for (; done + lanes < count; done += lanes) {
                hn::StoreInterleaved4(value[0].load(d, done), value[1].load(d, done),
                                      value[2].load(d, done), hn::Zero(d), d, pixels);
                for (std::size_t k = 0; k < 4; ++k) {
                    hn::BlendedStore(hn::Load(d, pixels + k * lanes), ours, d,
                                     out[0] + done * 4 + k * lanes);
                }
            }
        }
#elif HWY_TARGET <= HWY_AVX2
        // The fourth channel is written as it was read: masked stores are slow here.
        if (stride == 4) {
            for (; done + lanes < count; done += lanes) {
                float* pixels = out[0] + done * 4;
                const __m256 r = value[0].load(d, done).raw;
                const __m256 g = value[1].load(d, done).raw;
                const __m256 b = value[2].load(d, done).raw;
                // By pixel: the first two channels of 0 1 | 4 5 and of 2 3 | 6 7; the third one
                // beside itself.
                const __m256 rg01 = _mm256_unpacklo_ps(r, g);
                const __m256 rg23 = _mm256_unpackhi_ps(r, g);
                const __m256 bb01 = _mm256_unpacklo_ps(b, b);
                const __m256 bb23 = _mm256_unpackhi_ps(b, b);
                const __m256 pixel[4] = {
                    _mm256_shuffle_ps(rg01, bb01, 0x44), _mm256_shuffle_ps(rg01, bb01, 0xEE),
                    _mm256_shuffle_ps(rg23, bb23, 0x44), _mm256_shuffle_ps(rg23, bb23, 0xEE)};
                for (std::size_t k = 0; k < 4; ++k) {
                    float* lower = pixels + 4 * k;
                    float* upper = lower + 16;
                    _mm_storeu_ps(lower, _mm_blend_ps(_mm256_castps256_ps128(pixel[k]),
                                                      _mm_loadu_ps(lower), 8));
                    _mm_storeu_ps(upper, _mm_blend_ps(_mm256_extractf128_ps(pixel[k], 1),
                                                      _mm_loadu_ps(upper), 8));
                }
            }
        }
#endif
    }
#endif
    for (std::size_t c = 0; c < 3; ++c) {
        const auto* values = reinterpret_cast<const float*>(value[c].data);
        for (std::size_t i = done; i < count; ++i) {
            out[c][static_cast<std::ptrdiff_t>(i) * stride] = values[i * value[c].step];
        }
    }
}

#if HWY_TARGET <= HWY_AVX2

/// One part after the other over each tile, with what runs over the whole tile between them.
void run_parts(const Code& code, const Numbers& numbers, PixelLayout layout, unsigned char* tile,
               const float* in, float* out, std::size_t count) {
    const VectorProgram& program = code.machine->program();
    const Frame frame{tile, reinterpret_cast<const unsigned char*>(numbers.constants.data()),
                      count};
    for (std::size_t part = 0; part <= program.tile_steps.size(); ++part) {
        code.machine->run(part, layout, numbers, tile, in, out, count / hn::Lanes(DF()));
        if (part == program.tile_steps.size()) return;
        for (const Instruction& step : program.tile_steps[part])
            run_instruction(frame, code, step);
    }
}

void run_machine(const Code& code, const Numbers& numbers, unsigned char* tile,
                 const std::array<const float*, 3>& in, std::ptrdiff_t in_stride,
                 const std::array<float*, 3>& out, std::ptrdiff_t out_stride, std::size_t count) {
    const VectorProgram& program = code.machine->program();
    if (in_stride == out_stride && are_interleaved(in, in_stride) &&
        are_interleaved(out, out_stride)) {
        const PixelLayout layout = in_stride == 3 ? PixelLayout::rgb : PixelLayout::rgba;
        const auto stride = static_cast<std::size_t>(in_stride);
        // What follows the last pixel's three channels is not ours to read: the last pixels are
        // copied, and so are those that fill no block.
        const std::size_t whole =
            (stride == 4 && count > 0 ? count - 1 : count) / kLaneMultiple * kLaneMultiple;
        // Without a step over a tile nothing is kept in it.
        const std::size_t step = program.tile_steps.empty() ? HWY_MAX(whole, 1) : program.tile;
        for (std::size_t begin = 0; begin < whole; begin += step) {
            run_parts(code, numbers, layout, tile, in[0] + begin * stride, out[0] + begin * stride,
                      HWY_MIN(step, whole - begin));
        }
        if (whole == count) return;
        alignas(kVectorBytes) float pixels[4 * kLaneMultiple] = {};
        const std::size_t rest = (count - whole) * stride - (stride - 3);
        std::memcpy(pixels, in[0] + whole * stride, rest * sizeof(float));
        run_parts(code, numbers, layout, tile, pixels, pixels, kLaneMultiple);
        for (std::size_t i = 0; i < (count - whole) * stride; i += stride)
            std::memcpy(out[0] + whole * stride + i, pixels + i, 3 * sizeof(float));
        return;
    }
    for (std::size_t begin = 0; begin < count; begin += program.tile) {
        const std::size_t n = HWY_MIN(program.tile, count - begin);
        const std::size_t padded = (n + kLaneMultiple - 1) / kLaneMultiple * kLaneMultiple;
        const auto at = static_cast<std::ptrdiff_t>(begin);
        load_tile(program, tile,
                  {in[0] + at * in_stride, in[1] + at * in_stride, in[2] + at * in_stride},
                  in_stride, n, padded);
        run_parts(code, numbers, PixelLayout::planes, tile, nullptr, nullptr, padded);
        const Frame frame{tile, reinterpret_cast<const unsigned char*>(numbers.constants.data()),
                          padded};
        store_tile(program, frame,
                   {out[0] + at * out_stride, out[1] + at * out_stride, out[2] + at * out_stride},
                   out_stride, n);
    }
}

#endif
#if HWY_TARGET > HWY_AVX3 && HWY_TARGET <= HWY_SSE4

/// What is one curve of every channel needs no planes: whether it is, and the pixels lie so.
bool run_without_tiles(const Code& code, const std::array<const float*, 3>& in,
                       std::ptrdiff_t in_stride, const std::array<float*, 3>& out,
                       std::ptrdiff_t out_stride, std::size_t count) {
    if (!code.only_curve || in_stride != out_stride || count == 0) return false;
    const CompiledCurve& curve = code.curves[*code.only_curve];
    if (in_stride == 1) {
        // One after the other: planes that change places have to go through a tile.
        for (std::size_t c = 0; c < 3; ++c) {
            if (out[c] == in[(c + 1) % 3] || out[c] == in[(c + 2) % 3]) return false;
        }
        for (std::size_t c = 0; c < 3; ++c)
            run_flat(curve, in[c], out[c], count, false);
        return true;
    }
    if (!are_interleaved(in, in_stride) || !are_interleaved(out, out_stride)) return false;
    // What follows the last pixel's three channels is not ours.
    const bool is_rgba = in_stride == 4;
    run_flat(curve, in[0], out[0], is_rgba ? 4 * count - 1 : 3 * count, is_rgba);
    return true;
}

#endif

void run(const Code& code, const Numbers& numbers, const std::array<const float*, 3>& in,
         std::ptrdiff_t in_stride, const std::array<float*, 3>& out, std::ptrdiff_t out_stride,
         std::size_t count) noexcept {
#if HWY_TARGET > HWY_AVX3 && HWY_TARGET <= HWY_SSE4
    // Machine code has a tile for planes, but none for pixels.
    if ((!code.machine || in_stride == 1) &&
        run_without_tiles(code, in, in_stride, out, out_stride, count)) {
        return;
    }
#endif
    alignas(kVectorBytes) unsigned char registers[kRegisterFileBytes];
#if HWY_TARGET <= HWY_AVX2
    if (code.machine)
        return run_machine(code, numbers, registers, in, in_stride, out, out_stride, count);
#endif
    const auto* constants = reinterpret_cast<const unsigned char*>(numbers.constants.data());
    for (std::size_t begin = 0; begin < count; begin += code.tile) {
        const std::size_t n = HWY_MIN(code.tile, count - begin);
        const std::size_t padded = (n + kLaneMultiple - 1) / kLaneMultiple * kLaneMultiple;
        const auto at = static_cast<std::ptrdiff_t>(begin);
        const Frame frame{registers, constants, padded};
        load_tile(code, registers,
                  {in[0] + at * in_stride, in[1] + at * in_stride, in[2] + at * in_stride},
                  in_stride, n, padded);
        for (const Instruction& step : code.instructions)
            run_instruction(frame, code, step);
        store_tile(code, frame,
                   {out[0] + at * out_stride, out[1] + at * out_stride, out[2] + at * out_stride},
                   out_stride, n);
    }
}

#if HWY_TARGET <= HWY_AVX3
constexpr std::optional<VectorMachine> kMachine = VectorMachine{16, 32, true, 115};
#elif HWY_TARGET <= HWY_AVX2
constexpr std::optional<VectorMachine> kMachine = VectorMachine{8, 16, false, 80};
#else
constexpr std::optional<VectorMachine> kMachine;
#endif

constexpr Target kTarget = {.curve_form = kCurveForm, .machine = kMachine, .run = run};

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace HWY_NAMESPACE

template <>
constexpr const Target* Compiled::kernels<HWY_TARGET> = &HWY_NAMESPACE::kTarget;

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

const std::vector<Target>& targets() {
    static const std::vector<Target> all = kernels_of_this_machine<Compiled>();
    return all;
}

const Target& find_target(std::string_view name) {
    if (name.empty()) return targets().front();
    std::vector<std::string> names;
    for (const Target& target : targets())
        names.emplace_back(target.target);
    return targets()[find_choice("simd engine: target", name, names)];
}

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
#endif  // HWY_ONCE
