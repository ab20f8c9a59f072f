// SPDX-License-Identifier: Apache-2.0
//
// Writes the instructions of vector_ir.h: Writer one by one, and `recorded` by the names of
// Highway's functions, for simd_math-inl.h.
#pragma once

#include <concepts>
#include <cstring>
#include <limits>
#include <map>
#include <span>
#include <string>

#include "engine/vector_ir.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

/// A pool of constants. It holds each of them once.
class Pool {
  public:
    /// @param copies  bytes that a number fills with copies of itself; 0 for one copy
    explicit Pool(std::size_t copies) : copies_(copies) {}
    /// @param value  a number of 32 or 64 bits
    template <class T>
    VectorOperand bits(T value) {
        const std::vector<T> copies(std::max<std::size_t>(copies_ / sizeof value, 1), value);
        const std::size_t size = copies.size() * sizeof value;
        const auto [it, is_new] =
            offset_.try_emplace(std::string(reinterpret_cast<const char*>(copies.data()), size), 0);
        if (is_new) {
            it->second = static_cast<std::int32_t>(take_room(size));
            std::memcpy(bytes_.data() + it->second, copies.data(), size);
        }
        return {VectorOperand::kNone, it->second};
    }
    /// A pool constant that with_uniforms() can replace.
    /// @param is_rounded  the value is rounded to float before it is stored as double
    VectorOperand uniform(std::uint32_t source, double value, bool wide, bool is_rounded) {
        for (const UniformPlace& place : uniforms_) {
            if (place.source == source && place.wide == wide && place.is_rounded == is_rounded)
                return {VectorOperand::kNone, static_cast<std::int32_t>(place.offset)};
        }
        const std::size_t size = std::max(copies_, wide ? sizeof(double) : sizeof(float));
        const auto offset = static_cast<std::uint32_t>(take_room(size));
        fill(bytes_.data() + offset, size, value, wide);
        uniforms_.push_back({source, offset, static_cast<std::uint32_t>(size), wide, is_rounded});
        return {VectorOperand::kNone, static_cast<std::int32_t>(offset)};
    }
    std::vector<unsigned char> take() { return std::move(bytes_); }
    std::vector<UniformPlace> take_uniforms() { return std::move(uniforms_); }

  private:
    std::size_t take_room(std::size_t size) {
        const std::size_t offset = (bytes_.size() + size - 1) / size * size;
        bytes_.resize(offset + size);
        return offset;
    }

    std::size_t copies_;
    std::vector<unsigned char> bytes_;
    std::vector<UniformPlace> uniforms_;
    std::map<std::string, std::int32_t> offset_;  // by the bytes of the number and its copies
};

/// Writes the vector instructions of a program.
class Writer {
  public:
    using Number = VectorOperand;  // a vector: a value or a constant

    explicit Writer(Pool& pool) : pool_(pool) {}

    VectorCode take() { return std::move(code_); }
    [[nodiscard]] Pool& pool() { return pool_; }

    Number emit(VectorInstruction step) {
        step.result = code_.value_count++;
        code_.instructions.push_back(step);
        return {step.result};
    }
    void emit_store(const VectorInstruction& step) { code_.instructions.push_back(step); }

    // --- rows of tables ----------------------------------------------------------------------

    /// Stores the integers `place` in an index slot, for rows().
    void spill_index(int number, Number place) {
        emit_store({.op = VectorOp::spill_index,
                    .immediate = static_cast<std::uint8_t>(number),
                    .in = {place}});
    }
    /// An index slot for spill_index(). There are four, which are used in turn.
    int next_index() {
        spilled_ = (spilled_ + 1) % 4;
        return spilled_;
    }
    Number rows(int index, int quarter, const float* first) {
        return emit({.op = VectorOp::rows,
                     .immediate = static_cast<std::uint8_t>(index + 4 * quarter),
                     .address = first});
    }

    // --- pixels --------------------------------------------------------------------------------

    Number load(VectorOp o, int number) {
        return emit({.op = o, .immediate = static_cast<std::uint8_t>(number)});
    }
    Number load_pixels(int number) { return load(VectorOp::load_pixels, number); }
    /// RGB in the order of memory, for a program that computes the same function of each channel.
    std::array<Number, 3> load_floats() { return {load_pixels(0), load_pixels(1), load_pixels(2)}; }
    void store_floats(const std::array<Number, 3>& floats) {
        for (std::size_t i = 0; i < 3; ++i)
            store(VectorOp::store_pixels, static_cast<int>(i), floats[i]);
    }
    std::array<Number, 3> load_rgb() {
        // The k-th four floats of each of these vectors belong to the same four pixels.
        const std::array<Number, 3> v = {load(VectorOp::load_thirds, 0),
                                         load(VectorOp::load_thirds, 1),
                                         load(VectorOp::load_thirds, 2)};
        const Number red_green = shuffle_4(v[1], v[2], shuffle_code(2, 3, 1, 2));
        const Number green_blue = shuffle_4(v[0], v[1], shuffle_code(1, 2, 0, 1));
        return {shuffle_4(v[0], red_green, shuffle_code(0, 3, 0, 2)),
                shuffle_4(green_blue, red_green, shuffle_code(0, 2, 1, 3)),
                shuffle_4(green_blue, v[2], shuffle_code(1, 3, 0, 3))};
    }
    Number shuffle_4(Number a, Number b, int which) {
        return emit({.op = VectorOp::shuffle_4,
                     .immediate = static_cast<std::uint8_t>(which),
                     .in = {a, b}});
    }
    /// For shuffle_4: floats i, j of a, then k, l of b.
    static constexpr int shuffle_code(int i, int j, int k, int l) {
        return i + 4 * j + 16 * k + 64 * l;
    }
    /// Transposes groups of four floats: the k-th result has float k of each group of each vector.
    std::array<Number, 4> columns(const std::array<Number, 4>& v) {
        const Number first01 = shuffle_4(v[0], v[1], 0x44);
        const Number first23 = shuffle_4(v[2], v[3], 0x44);
        const Number last01 = shuffle_4(v[0], v[1], 0xEE);
        const Number last23 = shuffle_4(v[2], v[3], 0xEE);
        return {shuffle_4(first01, first23, 0x88), shuffle_4(first01, first23, 0xDD),
                shuffle_4(last01, last23, 0x88), shuffle_4(last01, last23, 0xDD)};
    }
    /// Loads pixels in another order, which store_rgba() undoes.
    std::array<Number, 4> load_rgba() {
        return columns({load_pixels(0), load_pixels(1), load_pixels(2), load_pixels(3)});
    }
    void store(VectorOp o, int number, Number value) {
        emit_store({.op = o, .immediate = static_cast<std::uint8_t>(number), .in = {value}});
    }
    void store_rgb(const std::array<Number, 3>& c) {
        const Number red_green = shuffle_4(c[0], c[1], 0x88);
        const Number green_blue = shuffle_4(c[1], c[2], 0xDD);
        const Number blue_red = shuffle_4(c[2], c[0], shuffle_code(0, 2, 1, 3));
        store(VectorOp::store_thirds, 0, shuffle_4(red_green, blue_red, 0x88));
        store(VectorOp::store_thirds, 1,
              shuffle_4(green_blue, red_green, shuffle_code(0, 2, 1, 3)));
        store(VectorOp::store_thirds, 2, shuffle_4(blue_red, green_blue, 0xDD));
    }
    void store_rgba(const std::array<Number, 3>& c) {
        for (int v = 0; v < 4; v += 2) {
            const Number red_green = shuffle_4(c[0], c[1], v == 0 ? 0x44 : 0xEE);
            for (int i = 0; i < 2; ++i)
                store(VectorOp::store_colors, v + i,
                      shuffle_4(red_green, c[2], shuffle_code(i, i + 2, v + i, v + i)));
        }
    }

  private:
    Pool& pool_;
    VectorCode code_;
    int spilled_ = 0;  // the index slot used last
};

/// The functions of Highway that simd_math-inl.h calls. Their vectors are values of instructions:
/// instead of computing a result, each function writes the instruction that does. Highway documents
/// them.
namespace recorded {
// NOLINTBEGIN(readability-identifier-naming): the names are Highway's.

/// A tag for floats, doubles, or integers of as many bits.
template <class T>
struct Tag {
    using Type = T;
    Writer* writer = nullptr;
};
template <class T>
struct Vector {
    Writer* writer = nullptr;
    VectorOperand operand;
};
template <class T>
struct Mask {
    Writer* writer = nullptr;
    std::int32_t value = VectorOperand::kNone;
};
template <class D>
using TFromD = typename D::Type;
template <class D>
using Vec = Vector<TFromD<D>>;
template <class T>
inline constexpr bool kIsWide = sizeof(T) == sizeof(double);

template <class T>
Vector<T> Set(Tag<T> d, std::type_identity_t<T> value) {
    return {d.writer, d.writer->pool().bits(value)};
}
template <class T>
Vector<T> Zero(Tag<T> d) {
    return Set(d, 0);
}

/// A function that writes an instruction: integer_op for integers, op for other numbers.
template <VectorOp op, VectorOp integer_op = op>
struct Operation {
    template <class T, std::same_as<Vector<T>>... V>
    Vector<T> operator()(Vector<T> a, V... others) const {
        // NOLINTNEXTLINE(bugprone-branch-clone): many have one instruction for both.
        constexpr VectorOp kOp = std::integral<T> ? integer_op : op;
        return {
            a.writer,
            a.writer->emit({.op = kOp, .wide = kIsWide<T>, .in = {a.operand, others.operand...}})};
    }
};
inline constexpr Operation<VectorOp::add, VectorOp::integer_add> Add;
inline constexpr Operation<VectorOp::subtract, VectorOp::integer_subtract> Sub;
inline constexpr Operation<VectorOp::multiply> Mul;
inline constexpr Operation<VectorOp::divide> Div;
inline constexpr Operation<VectorOp::multiply_add> MulAdd;
inline constexpr Operation<VectorOp::multiply_subtract> MulSub;
inline constexpr Operation<VectorOp::subtract_product> NegMulAdd;
inline constexpr Operation<VectorOp::minimum> Min;
inline constexpr Operation<VectorOp::maximum> Max;
inline constexpr Operation<VectorOp::square_root> Sqrt;
inline constexpr Operation<VectorOp::round> Round;
inline constexpr Operation<VectorOp::floor> Floor;
inline constexpr Operation<VectorOp::bit_and> And;
inline constexpr Operation<VectorOp::bit_or> Or;
inline constexpr Operation<VectorOp::bit_xor> Xor;
inline constexpr Operation<VectorOp::bit_and_not> AndNot;

template <class T>
Vector<T> sign_bit(Vector<T> x) {
    return Set(Tag<T>{x.writer}, T{-0.0});
}
template <class T>
Vector<T> Neg(Vector<T> x) {
    return Xor(x, sign_bit(x));
}
template <class T>
Vector<T> Abs(Vector<T> x) {
    using Bits = std::conditional_t<kIsWide<T>, std::int64_t, std::int32_t>;
    const VectorOperand mask = x.writer->pool().bits(std::numeric_limits<Bits>::max());
    return And(x, Vector<T>{x.writer, mask});
}
template <class T>
Vector<T> CopySign(Vector<T> magnitude, Vector<T> from) {
    return Or(Abs(magnitude), And(from, sign_bit(from)));
}

template <class T>
Vector<T> shift(VectorOp op, Vector<T> x, int bits) {
    return {x.writer, x.writer->emit({.op = op,
                                      .wide = kIsWide<T>,
                                      .immediate = static_cast<std::uint8_t>(bits),
                                      .in = {x.operand}})};
}
template <class T>
Vector<T> ShiftLeftSame(Vector<T> x, int bits) {
    return shift(VectorOp::shift_left, x, bits);
}
template <class T>
Vector<T> ShiftRightSame(Vector<T> x, int bits) {
    return shift(VectorOp::shift_right, x, bits);
}
template <int kBits, class T>
Vector<T> ShiftLeft(Vector<T> x) {
    return ShiftLeftSame(x, kBits);
}
template <int kBits, class T>
Vector<T> ShiftRight(Vector<T> x) {
    return ShiftRightSame(x, kBits);
}

template <class T, class U>
Vector<T> BitCast(Tag<T> /*d*/, Vector<U> x) {
    static_assert(sizeof(T) == sizeof(U));
    return {x.writer, x.operand};
}
inline Vector<float> ConvertTo(Tag<float> /*d*/, Vector<std::int32_t> x) {
    return {x.writer, x.writer->emit({.op = VectorOp::to_float, .in = {x.operand}})};
}
inline Vector<std::int32_t> ConvertTo(Tag<std::int32_t> /*d*/, Vector<float> x) {
    return {x.writer, x.writer->emit({.op = VectorOp::to_index, .in = {x.operand}})};
}

template <VectorOp op>
struct Comparison {
    template <class T>
    Mask<T> operator()(Vector<T> a, Vector<T> b) const {
        return {a.writer, Operation<op>()(a, b).operand.value};
    }
};
inline constexpr Comparison<VectorOp::equal> Eq;
inline constexpr Comparison<VectorOp::less> Lt;
inline constexpr Comparison<VectorOp::less_equal> Le;
inline constexpr Comparison<VectorOp::greater> Gt;
inline constexpr Comparison<VectorOp::greater_equal> Ge;

template <class T, class U>
Mask<T> RebindMask(Tag<T> /*d*/, Mask<U> mask) {
    static_assert(sizeof(T) == sizeof(U));
    return {mask.writer, mask.value};
}
template <class T>
Vector<T> IfThenElseZero(Mask<T> mask, Vector<T> yes) {
    return {yes.writer, yes.writer->emit({.op = VectorOp::zero_unless,
                                          .wide = kIsWide<T>,
                                          .mask = mask.value,
                                          .in = {yes.operand}})};
}
template <class T>
Vector<T> IfThenElse(Mask<T> mask, Vector<T> yes, Vector<T> no) {
    // A blend costs three times as much (Intel).
    if (no.operand.pool == Zero(Tag<T>{no.writer}).operand.pool) return IfThenElseZero(mask, yes);
    return {yes.writer, yes.writer->emit({.op = VectorOp::blend,
                                          .wide = kIsWide<T>,
                                          .mask = mask.value,
                                          .in = {yes.operand, no.operand}})};
}
// NOLINTEND(readability-identifier-naming)
}  // namespace recorded

// ---------------------------------------------------------------------------------------------
// Other names that simd_math-inl.h needs

namespace hn = recorded;

#define HWY_INLINE inline
#define HWY_ATTR

constexpr bool kHasFma = true;

using VF = hn::Vector<float>;
using VD = hn::Vector<double>;
using VI = hn::Vector<std::int32_t>;

constexpr int kHalves = 2;
struct Doubles {
    VD half[kHalves];
};
inline VD promote(VF x, int half) {
    const VectorOp op = half == 0 ? VectorOp::promote_low : VectorOp::promote_high;
    return {x.writer, x.writer->emit({.op = op, .wide = true, .in = {x.operand}})};
}
inline VF demote(const Doubles& x) {
    Writer* const writer = x.half[0].writer;
    return {writer, writer->emit({.op = VectorOp::demote,
                                  .wide = true,
                                  .in = {x.half[0].operand, x.half[1].operand}})};
}

inline hn::Tag<double> double_tag(hn::Tag<float> d) { return {d.writer}; }
inline hn::Tag<std::int32_t> bits_tag(hn::Tag<float> d) { return {d.writer}; }
inline hn::Tag<std::uint64_t> bits_tag(hn::Tag<double> d) { return {d.writer}; }

template <class T>
hn::Mask<T> has_minus(hn::Tag<T> /*d*/, hn::Vector<T> x) {
    return {x.writer, hn::Operation<VectorOp::is_minus>()(x).operand.value};
}

template <class T>
VI places(hn::Vector<T> x) {
    return {x.writer,
            x.writer->emit({.op = VectorOp::to_index, .wide = hn::kIsWide<T>, .in = {x.operand}})};
}
template <class T>
hn::Vector<T> gather(hn::Tag<T> d, std::span<const T> samples, std::size_t first, VI place) {
    return {d.writer, d.writer->emit({.op = VectorOp::gather,
                                      .wide = hn::kIsWide<T>,
                                      .address = samples.data() + first,
                                      .in = {place.operand}})};
}

/// A table of up to 64 numbers, read by permutes of AVX-512.
struct PermutedTable {
    const float* numbers;
    int size;

    [[nodiscard]] VF at(VI index) const {
        Writer* const w = index.writer;
        const VectorOp op = size == 16 ? VectorOp::permute_16 : VectorOp::permute_32;
        const VF low = {w, w->emit({.op = op, .address = numbers, .in = {index.operand}})};
        if (size <= 32) return low;
        const VF high = {w, w->emit({.op = op, .address = numbers + 32, .in = {index.operand}})};
        const hn::Tag<float> d = {w};
        const auto is_high = has_minus(d, hn::BitCast(d, hn::ShiftLeft<26>(index)));
        return hn::IfThenElse(is_high, high, low);
    }
};
inline PermutedTable table(hn::Tag<float> /*d*/, const float* numbers, int size) {
    return {numbers, size};
}

/// GatheredRows with loads of whole rows.
class Rows {
  public:
    Rows(std::span<const float> numbers, VI place, int length)
        : writer_(*place.writer),
          numbers_(numbers.data()),
          index_(writer_.next_index()),
          groups_(static_cast<std::size_t>(length / 4)) {
        writer_.spill_index(index_, place.operand);
    }
    void columns(std::size_t group, VF* result) {
        // Loads both groups at once, so that each index is read once.
        if (!is_loaded_) load();
        const std::array<VectorOperand, 4> columns = writer_.columns(rows_[group]);
        for (std::size_t i = 0; i < 4; ++i)
            result[i] = {&writer_, columns[i]};
    }

  private:
    void load() {
        for (std::size_t quarter = 0; quarter < 4; ++quarter) {
            for (std::size_t group = 0; group < groups_; ++group)
                rows_[group][quarter] =
                    writer_.rows(index_, static_cast<int>(quarter), numbers_ + 4 * group);
        }
        is_loaded_ = true;
    }

    Writer& writer_;
    const float* numbers_;
    int index_;
    std::size_t groups_;
    bool is_loaded_ = false;
    std::array<std::array<VectorOperand, 4>, 2> rows_{};
};
inline Rows rows_at(hn::Tag<float> /*d*/, std::span<const float> numbers, VI place, int length) {
    return {numbers, place, length};
}

#include "engine/simd_math-inl.h"

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
