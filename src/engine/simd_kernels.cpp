// SPDX-License-Identifier: Apache-2.0
//
// The interpreter. Highway compiles this file once for each instruction set, and the best one is
// chosen when it runs. Each operation has a function that runs over a tile, so the interpreter
// chooses an operation only once in up to 256 pixels, and the values of a tile never leave the
// first-level cache.
#include "engine/simd_kernels.h"

#include <algorithm>
#include <cmath>
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

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace HWY_NAMESPACE {

// ---------------------------------------------------------------------------------------------
// Names that simd_math-inl.h needs

namespace hn = hwy::HWY_NAMESPACE;
using hn::TFromD;  // for Highway's macros

using DF = hn::ScalableTag<float>;
using DD = hn::ScalableTag<double>;
/// Tag for a vector of as many floats as a vector has doubles.
using DFOfDD = hn::Rebind<float, DD>;
using DI = hn::RebindToSigned<DF>;

constexpr bool kHasFma = HWY_NATIVE_FMA;

constexpr int kHalves = HWY_TARGET == HWY_SCALAR ? 1 : 2;
struct Doubles {
    // GCC 12 does not inline vectors of NEON into an implicit constructor, which has no target.
    HWY_INLINE Doubles() {}  // NOLINT(modernize-use-equals-default)
    hn::Vec<DD> half[kHalves];
};
HWY_INLINE hn::Vec<DD> promote(hn::Vec<DF> x, int half) {
#if HWY_TARGET == HWY_SCALAR
    (void)half;
    return hn::PromoteTo(DD(), x);
#else
    const hn::Half<DF> d;
    return hn::PromoteTo(DD(), half > 0 ? hn::UpperHalf(d, x) : hn::LowerHalf(d, x));
#endif
}
HWY_INLINE hn::Vec<DF> demote(const Doubles& x) {
#if HWY_TARGET == HWY_SCALAR
    return hn::DemoteTo(DF(), x.half[0]);
#else
    const hn::Half<DF> d;
    return hn::Combine(DF(), hn::DemoteTo(d, x.half[1]), hn::DemoteTo(d, x.half[0]));
#endif
}

HWY_INLINE DD double_tag(DF /*d*/) { return {}; }
HWY_INLINE DI bits_tag(DF /*d*/) { return {}; }
HWY_INLINE hn::RebindToUnsigned<DD> bits_tag(DD /*d*/) { return {}; }

template <class D>
HWY_INLINE hn::Mask<D> has_minus(D d, hn::Vec<D> x) {
    return hn::Lt(hn::CopySign(hn::Set(d, 1), x), hn::Zero(d));
}

HWY_INLINE hn::Vec<DI> places(hn::Vec<DF> x) { return hn::ConvertTo(DI(), x); }
HWY_INLINE hn::Vec<hn::RebindToSigned<DD>> places(hn::Vec<DD> x) {
    const auto whole = hn::DemoteTo(hn::Rebind<std::int32_t, DD>(), x);
    return hn::PromoteTo(hn::RebindToSigned<DD>(), whole);
}
template <class D, class I>
HWY_INLINE hn::Vec<D> gather(D d, std::span<const TFromD<D>> samples, std::size_t first, I place) {
    return hn::GatherIndex(d, samples.data() + first, place);
}

/// A table of up to 64 numbers, read by a vector of indices.
struct IndexedTable {
    const float* numbers;
    int size;
    [[nodiscard]] HWY_INLINE hn::Vec<DF> at(hn::Vec<DI> index) const {
#if HWY_TARGET <= HWY_AVX3
        const auto of_32 = [&](const float* first) HWY_ATTR {
            return hn::Vec<DF>{_mm512_permutex2var_ps(_mm512_load_ps(first), index.raw,
                                                      _mm512_load_ps(first + 16))};
        };
        const auto low = of_32(numbers);
        if (size <= 32) return low;
        const auto is_high = hn::TestBit(index, hn::Set(DI(), 32));
        return hn::IfThenElse(hn::RebindMask(DF(), is_high), of_32(numbers + 32), low);
#else
        return hn::GatherIndex(DF(), numbers, index);
#endif
    }
};
HWY_INLINE IndexedTable table(DF /*d*/, const float* numbers, int size) { return {numbers, size}; }

#if HWY_MAX_BYTES == 16 || (HWY_TARGET > HWY_AVX3 && HWY_TARGET <= HWY_AVX2)

/// GatheredRows with loads of whole rows, which is twice as fast.
class Rows {
  public:
    HWY_INLINE Rows(std::span<const float> numbers, hn::Vec<DI> place) : numbers_(numbers.data()) {
        // The indices go through memory, because loading each one costs less than extracting it
        // from a vector.
        const hn::RebindToUnsigned<DF> d;
        hn::Store(hn::BitCast(d, place), d, at_);
        __asm__("" : "+m"(at_));
    }
    HWY_INLINE void columns(std::size_t group, hn::Vec<DF>* result) const {
        const hn::CappedTag<float, 4> quarter;
        for (int p = 0; p < 4; ++p) {
            const auto row = hn::LoadU(quarter, numbers_ + at_[p] + 4 * group);
#if HWY_TARGET <= HWY_AVX2
            const auto upper = hn::LoadU(quarter, numbers_ + at_[p + 4] + 4 * group);
            result[p] = hn::Combine(DF(), upper, row);
#else
            result[p] = row;
#endif
        }
        const DF d;
        const hn::Repartition<double, DF> pairs;
        const auto in_pairs = [&](hn::Vec<DF> x) HWY_ATTR { return hn::BitCast(pairs, x); };
        const auto low01 = in_pairs(hn::InterleaveLower(d, result[0], result[1]));
        const auto high01 = in_pairs(hn::InterleaveUpper(d, result[0], result[1]));
        const auto low23 = in_pairs(hn::InterleaveLower(d, result[2], result[3]));
        const auto high23 = in_pairs(hn::InterleaveUpper(d, result[2], result[3]));
        result[0] = hn::BitCast(d, hn::InterleaveLower(pairs, low01, low23));
        result[1] = hn::BitCast(d, hn::InterleaveUpper(pairs, low01, low23));
        result[2] = hn::BitCast(d, hn::InterleaveLower(pairs, high01, high23));
        result[3] = hn::BitCast(d, hn::InterleaveUpper(pairs, high01, high23));
    }

  private:
    const float* numbers_;
    alignas(kVectorBytes) std::uint32_t at_[kLaneMultiple];
};
HWY_INLINE Rows rows_at(DF /*d*/, std::span<const float> numbers, hn::Vec<DI> place,
                        int /*length*/) {
    return {numbers, place};
}

#endif

#include "engine/simd_math-inl.h"

// ---------------------------------------------------------------------------------------------
// Kernels: an operation over a tile

/// Memory with the values of a tile.
struct Frame {
    unsigned char* registers;
    const unsigned char* constants;
    std::size_t count;  // padded to whole vectors of the widest kind
};

/// An operand to read. A constant is one vector, which is read for all pixels.
struct Source {
    const unsigned char* data;
    std::size_t step;  // 1, or 0 for a constant
    bool wide;

    Source(const Frame& frame, const Operand& operand)
        : data((operand.constant ? frame.constants : frame.registers) + operand.offset),
          step(operand.constant ? 0 : 1),
          wide(operand.wide) {}

    HWY_INLINE Vec<DF> load(DF d, std::size_t i) const {
        if (wide) return demote(load_doubles(i));
        return hn::Load(d, reinterpret_cast<const float*>(data) + i * step);
    }
    HWY_INLINE Vec<DD> load(DD d, std::size_t i) const {
        if (wide) return hn::Load(d, reinterpret_cast<const double*>(data) + i * step);
        const auto narrow = hn::Load(DFOfDD(), reinterpret_cast<const float*>(data) + i * step);
        return hn::PromoteTo(d, narrow);
    }
    HWY_INLINE Doubles load_doubles(std::size_t i) const {
        const DD d;
        Doubles result;
        for (int h = 0; h < kHalves; ++h)
            result.half[h] = load(d, i + static_cast<std::size_t>(h) * hn::Lanes(d));
        return result;
    }
};

/// Stores a result in the precision of its register.
HWY_INLINE void store_result(const Frame& frame, const Operand& out, std::size_t i, Vec<DD> value) {
    if (out.wide) {
        hn::Store(value, DD(), reinterpret_cast<double*>(frame.registers + out.offset) + i);
    } else {
        const DFOfDD d;
        hn::Store(hn::DemoteTo(d, value), d,
                  reinterpret_cast<float*>(frame.registers + out.offset) + i);
    }
}

HWY_INLINE void store_result(const Frame& frame, const Operand& out, std::size_t i, Vec<DF> value) {
    hn::Store(value, DF(), reinterpret_cast<float*>(frame.registers + out.offset) + i);
}
HWY_INLINE void store_result(const Frame& frame, const Operand& out, std::size_t i,
                             const Doubles& value) {
    for (int h = 0; h < kHalves; ++h)
        store_result(frame, out, i + static_cast<std::size_t>(h) * hn::Lanes(DD()), value.half[h]);
}

template <ProgramOp op, class D>
HWY_INLINE void over_tile(D d, const Frame& frame, const Program& program, const Instruction& step,
                          const Source* source) {
    for (std::size_t i = 0; i < frame.count; i += hn::Lanes(d)) {
        const auto x = [&](int k) HWY_ATTR { return source[k].load(d, i); };
        const auto give = [&](std::size_t c, Vec<D> result)
                              HWY_ATTR { store_result(frame, step.out[c], i, result); };
        compute<op>(d, program, step, x, give);
    }
}

/// Runs an operation over a tile.
template <ProgramOp op>
HWY_NOINLINE void run_op(const Frame& given, const Program& program,
                         const Instruction& instruction) {
    // Copies, because the compiler assumes that stores may change the originals.
    const Frame frame = given;
    const Instruction step = instruction;
    const Source source[4] = {Source(frame, step.in[0]), Source(frame, step.in[1]),
                              Source(frame, step.in[2]), Source(frame, step.in[3])};
    if constexpr (!is_always_wide(op)) {
        if (!step.wide) return over_tile<op>(DF(), frame, program, step, source);
    }
    over_tile<op>(DD(), frame, program, step, source);
}

/// Runs a curve over a tile.
template <class P>
HWY_INLINE void over_curve(const Frame& given, const Instruction& step, const CompiledCurve& curve,
                           const P& polynomial) {
    const DF d;
    const Frame frame = given;
    const Operand out = step.out[0];
    const CurveEnds<DF> ends(d, curve);
    const Source source(frame, step.in[0]);
    if (!curve.is_precise) {
        for (std::size_t i = 0; i < frame.count; i += hn::Lanes(d)) {
            const auto y = curve_value(d, ends, polynomial, source.load(d, i));
            store_result(frame, out, i, y);
        }
        return;
    }
    const CurveEnds<DD> wide_ends(DD(), curve);
    for (std::size_t i = 0; i < frame.count; i += hn::Lanes(d)) {
        const Doubles exact = source.load_doubles(i);
        store_result(frame, out, i,
                     precise_curve_value(d, ends, wide_ends, polynomial, source.load(d, i),
                                         source.wide ? &exact : nullptr));
    }
}

template <>
HWY_NOINLINE void run_op<ProgramOp::curve>(const Frame& frame, const Program& program,
                                           const Instruction& step) {
    const CompiledCurve& curve = program.curves[step.table];
    if (curve.rows) {
        over_curve(frame, step, curve, RowPolynomial<DF>(DF(), *curve.rows));
    } else {
        over_curve(frame, step, curve, SegmentPolynomial<DF>(DF(), curve));
    }
}

using Kernel = void (*)(const Frame&, const Program&, const Instruction&);
template <std::size_t... kOp>
constexpr std::array<Kernel, sizeof...(kOp)> kernels_of(std::index_sequence<kOp...> /*all*/) {
    return {run_op<static_cast<ProgramOp>(kOp)>...};
}
constexpr auto kKernels = kernels_of(std::make_index_sequence<std::size(kOperations)>());

// ---------------------------------------------------------------------------------------------
// Pixels in and out

/// Calls use(r, g, b, i) with the vectors of pixels from the i-th on. Pads with 0 to `padded`
/// pixels.
template <class F>
HWY_INLINE void read_pixels(const std::array<const float*, 3>& in, std::ptrdiff_t stride,
                            std::size_t count, std::size_t padded, const F& use) {
    const DF d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    for (; stride == 1 && i + lanes <= count; i += lanes)
        use(hn::LoadU(d, in[0] + i), hn::LoadU(d, in[1] + i), hn::LoadU(d, in[2] + i), i);
#if HWY_TARGET != HWY_SCALAR
    if (are_interleaved(in, stride)) {
        Vec<DF> r, g, b, unused;
        for (; stride == 3 && i + lanes <= count; i += lanes) {
            hn::LoadInterleaved3(d, in[0] + i * 3, r, g, b);
            use(r, g, b, i);
        }
        // The memory behind the last pixel's three channels belongs to the caller and may not be
        // read.
        for (; stride == 4 && i + lanes < count; i += lanes) {
            hn::LoadInterleaved4(d, in[0] + i * 4, r, g, b, unused);
            use(r, g, b, i);
        }
    }
#endif
    for (; i < padded; i += lanes) {
        alignas(kVectorBytes) float rest[3][kLaneMultiple] = {};
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t k = i; k < HWY_MIN(i + lanes, count); ++k)
                rest[c][k - i] = in[c][static_cast<std::ptrdiff_t>(k) * stride];
        }
        use(hn::Load(d, rest[0]), hn::Load(d, rest[1]), hn::Load(d, rest[2]), i);
    }
}

struct Colors {
    Vec<DF> channel[3];
};
/// @param get  get(i): the pixels from the i-th on
template <class F>
HWY_INLINE void write_pixels(const std::array<float*, 3>& out, std::ptrdiff_t stride,
                             std::size_t count, const F& get) {
    const DF d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    for (; stride == 1 && i + lanes <= count; i += lanes) {
        const Colors x = get(i);
        for (std::size_t c = 0; c < 3; ++c)
            hn::StoreU(x.channel[c], d, out[c] + i);
    }
#if HWY_TARGET != HWY_SCALAR
    if (are_interleaved(out, stride)) {
        for (; stride == 3 && i + lanes <= count; i += lanes) {
            const Colors x = get(i);
            hn::StoreInterleaved3(x.channel[0], x.channel[1], x.channel[2], d, out[0] + i * 3);
        }
        // The fourth channel is written as it was read. The memory behind the last pixel's three
        // channels belongs to the caller.
        Vec<DF> unused, alpha;
        for (; stride == 4 && i + lanes < count; i += lanes) {
            float* const pixels = out[0] + i * 4;
            const Colors x = get(i);
            hn::LoadInterleaved4(d, pixels, unused, unused, unused, alpha);
            hn::StoreInterleaved4(x.channel[0], x.channel[1], x.channel[2], alpha, d, pixels);
        }
    }
#endif
    for (; i < count; i += lanes) {
        alignas(kVectorBytes) float rest[kLaneMultiple];
        const Colors x = get(i);
        for (std::size_t c = 0; c < 3; ++c) {
            hn::Store(x.channel[c], d, rest);
            for (std::size_t k = i; k < HWY_MIN(i + lanes, count); ++k)
                out[c][static_cast<std::ptrdiff_t>(k) * stride] = rest[k - i];
        }
    }
}

#if HWY_TARGET <= HWY_AVX2

void pack(const std::array<const float*, 3>& in, std::ptrdiff_t stride, std::size_t count,
          std::size_t padded, float* rgb) noexcept {
    const auto store = [&](Vec<DF> r, Vec<DF> g, Vec<DF> b, std::size_t i)
                           HWY_ATTR { hn::StoreInterleaved3(r, g, b, DF(), rgb + 3 * i); };
    read_pixels(in, stride, count, padded, store);
}

void unpack(const float* rgb, const std::array<float*, 3>& out, std::ptrdiff_t stride,
            std::size_t count) noexcept {
    const auto load = [&](std::size_t i) HWY_ATTR {
        Colors x;
        hn::LoadInterleaved3(DF(), rgb + 3 * i, x.channel[0], x.channel[1], x.channel[2]);
        return x;
    };
    write_pixels(out, stride, count, load);
}

#endif

void interpret(const Program& program, const Numbers& numbers,
               const std::array<const float*, 3>& in, std::ptrdiff_t in_stride,
               const std::array<float*, 3>& out, std::ptrdiff_t out_stride,
               std::size_t count) noexcept {
    alignas(kVectorBytes) unsigned char registers[kRegisterFileBytes];
    const auto* constants = reinterpret_cast<const unsigned char*>(numbers.constants.data());
    const DF d;
    for (std::size_t begin = 0; begin < count; begin += program.tile) {
        const std::size_t n = HWY_MIN(program.tile, count - begin);
        const std::size_t padded = (n + kLaneMultiple - 1) / kLaneMultiple * kLaneMultiple;
        const Frame frame{registers, constants, padded};
        const auto keep = [&](Vec<DF> r, Vec<DF> g, Vec<DF> b, std::size_t i) HWY_ATTR {
            const Vec<DF> rgb[3] = {r, g, b};
            for (std::size_t c = 0; c < 3; ++c) {
                if (!program.reads_input[c]) continue;
                const Vec<DF> x =
                    program.limits_input ? sanitized(d, rgb[c]) : without_nan(d, rgb[c]);
                store_result(frame, {program.input_offset[c]}, i, x);
            }
        };
        read_pixels(from(in, in_stride, begin), in_stride, n, padded, keep);
        for (const Instruction& step : program.instructions)
            kKernels[static_cast<std::size_t>(computed_by(step))](frame, program, step);
        const Source value[3] = {Source(frame, program.output[0]), Source(frame, program.output[1]),
                                 Source(frame, program.output[2])};
        write_pixels(from(out, out_stride, begin), out_stride, n, [&](std::size_t i) HWY_ATTR {
            return Colors{{value[0].load(d, i), value[1].load(d, i), value[2].load(d, i)}};
        });
    }
}

// AVX-512 has permutes of whole tables. Other instruction sets load rows.
constexpr CurveForm kCurveForm = HWY_TARGET <= HWY_AVX3 ? CurveForm::segments
                                 : HWY_NATIVE_FMA       ? CurveForm::rows
                                                        : CurveForm::rows_unfused;

constexpr Target kTarget = {
    .curve_form = kCurveForm,
#if HWY_TARGET <= HWY_AVX3
    .machine = VectorMachine{16, 32, true},
#elif HWY_TARGET <= HWY_AVX2
    .machine = VectorMachine{8, 16, false},
#endif
    .interpret = interpret,
#if HWY_TARGET <= HWY_AVX2
    .pack = pack,
    .unpack = unpack,
#endif
};

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
        names.emplace_back(target.name);
    return targets()[find_choice("target", name, names, "simd engine")];
}

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
#endif  // HWY_ONCE
