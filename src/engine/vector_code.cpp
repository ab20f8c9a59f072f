// SPDX-License-Identifier: Apache-2.0
#include "engine/vector_code.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string>

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace {

using Number = VectorOperand;  // of a vector: a value or a constant

constexpr std::int32_t kNone = VectorOperand::kNone;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Bytes of a tile: stays in a first-level cache of 32 KiB.
constexpr std::size_t kTileBytes = std::size_t{24} * 1024;

/// Constants and tables, each once.
class Pool {
  public:
    /// @param copies  bytes that a number fills with copies of itself; 0 for one copy
    explicit Pool(std::size_t copies) : copies_(copies) {}
    Number number(double value, bool wide) {
        return wide ? bits(value) : bits(static_cast<float>(value));
    }
    /// @param value  of 32 or 64 bits
    template <class T>
    Number bits(T value) {
        const std::vector<T> copies(std::max<std::size_t>(copies_ / sizeof value, 1), value);
        const std::size_t size = copies.size() * sizeof value;
        return {kNone, place(copies.data(), size, size)};
    }
    /// A number that may become another.
    /// @param is_rounded  to float before it is taken as double
    Number uniform(std::uint32_t source, double value, bool wide, bool is_rounded) {
        for (const UniformPlace& place : uniforms_) {
            if (place.source == source && place.wide == wide && place.is_rounded == is_rounded)
                return {kNone, static_cast<std::int32_t>(place.offset)};
        }
        const std::size_t size = std::max(copies_, wide ? sizeof(double) : sizeof(float));
        bytes_.resize((bytes_.size() + size - 1) / size * size);
        const auto offset = static_cast<std::uint32_t>(bytes_.size());
        bytes_.resize(bytes_.size() + size);
        fill(bytes_.data() + offset, size, value, wide);
        uniforms_.push_back({source, offset, static_cast<std::uint32_t>(size), wide, is_rounded});
        return {kNone, static_cast<std::int32_t>(offset)};
    }
    template <class T>
    std::uint32_t table(const T* numbers, std::size_t count) {
        return static_cast<std::uint32_t>(place(numbers, count * sizeof(T), kVectorBytes));
    }
    std::vector<unsigned char> take() { return std::move(bytes_); }
    std::vector<UniformPlace> take_uniforms() { return std::move(uniforms_); }

  private:
    std::int32_t place(const void* data, std::size_t size, std::size_t alignment) {
        const auto [it, is_new] =
            offset_.try_emplace(std::string(static_cast<const char*>(data), size), 0);
        if (is_new) {
            bytes_.resize((bytes_.size() + alignment - 1) / alignment * alignment);
            it->second = static_cast<std::int32_t>(bytes_.size());
            bytes_.insert(bytes_.end(), it->first.begin(), it->first.end());
        }
        return it->second;
    }

    std::size_t copies_;
    std::vector<unsigned char> bytes_;
    std::vector<UniformPlace> uniforms_;
    std::map<std::string, std::int32_t> offset_;  // by the bytes themselves
};

/// One value of all pixels of a block: a vector of floats, or two of doubles, or both.
struct Lanes {
    Number narrow;
    std::array<Number, 2> wide;
};

/// Writes vector instructions. What they compute is what simd_math-inl.h and simd_kernels.cpp
/// compute, operation by operation, so that both give the same bits.
class Writer {
  public:
    Writer(Pool& pool, const VectorMachine& machine) : pool_(pool), machine_(machine) {}

    VectorCode take() { return std::move(code_); }

    // --- single instructions ---------------------------------------------------------------------

    Number emit(VectorInstruction step) {
        step.result = code_.value_count++;
        code_.instructions.push_back(step);
        return {step.result, kNone};
    }
    void emit_store(const VectorInstruction& step) { code_.instructions.push_back(step); }

    Number op(VectorOp o, bool wide, Number a, Number b = {}, Number c = {}) {
        VectorInstruction step;
        step.op = o;
        step.wide = wide;
        step.in = {a, b, c};
        return emit(step);
    }
    Number add(bool w, Number a, Number b) { return op(VectorOp::add, w, a, b); }
    Number sub(bool w, Number a, Number b) { return op(VectorOp::subtract, w, a, b); }
    Number mul(bool w, Number a, Number b) { return op(VectorOp::multiply, w, a, b); }
    Number fma(bool w, Number a, Number b, Number c) {
        return op(VectorOp::multiply_add, w, a, b, c);
    }
    /// c - a*b
    Number fnma(bool w, Number a, Number b, Number c) {
        return op(VectorOp::subtract_product, w, a, b, c);
    }
    Number min(bool w, Number a, Number b) { return op(VectorOp::minimum, w, a, b); }
    Number max(bool w, Number a, Number b) { return op(VectorOp::maximum, w, a, b); }
    Number abs(bool w, Number a) {
        return op(VectorOp::bit_and, w, a,
                  w ? pool_.bits(std::uint64_t{0x7FFFFFFFFFFFFFFF})
                    : pool_.bits(std::uint32_t{0x7FFFFFFF}));
    }
    Number sign(bool w) {
        return w ? pool_.bits(std::uint64_t{1} << 63U) : pool_.bits(std::uint32_t{1} << 31U);
    }
    Number neg(bool w, Number a) { return op(VectorOp::bit_xor, w, a, sign(w)); }
    Number k(bool w, double value) { return pool_.number(value, w); }

    std::int32_t compare(VectorOp o, bool w, Number a, Number b) { return op(o, w, a, b).value; }
    Number blend(bool w, std::int32_t mask, Number yes, Number no) {
        VectorInstruction step;
        step.op = VectorOp::blend;
        step.wide = w;
        step.mask = mask;
        step.in = {yes, no, {}};
        return emit(step);
    }
    Number zero_unless(bool w, std::int32_t mask, Number x) {
        VectorInstruction step;
        step.op = VectorOp::zero_unless;
        step.wide = w;
        step.mask = mask;
        step.in[0] = x;
        return emit(step);
    }
    Number promote(Number x, int half) {
        return op(half == 0 ? VectorOp::promote_low : VectorOp::promote_high, true, x);
    }
    Number demote(const std::array<Number, 2>& x) { return op(VectorOp::demote, true, x[0], x[1]); }

    // --- operands --------------------------------------------------------------------------------

    Number narrow(Lanes& x) {
        if (!x.narrow.is_value() && !x.narrow.is_constant()) x.narrow = demote(x.wide);
        return x.narrow;
    }
    Number wide(Lanes& x, int half) {
        Number& result = x.wide[static_cast<std::size_t>(half)];
        if (!result.is_value() && !result.is_constant()) result = promote(x.narrow, half);
        return result;
    }

    // --- elementary functions ----------------------------------------------------------------

    template <class... C>
    Number horner(bool w, Number x, C... c) {
        const std::array<double, sizeof...(C)> coefficients = {c...};
        Number sum = k(w, coefficients.back());
        for (std::size_t i = coefficients.size() - 1; i-- > 0;)
            sum = fma(w, sum, x, k(w, coefficients[i]));
        return sum;
    }

    struct Split {
        Number e, f;
    };
    /// As in simd_math-inl.h.
    Split split(bool w, Number x) {
        if (!machine_.has_avx512) return split_bits(w, x);
        const Number up =
            w ? k(true, 0x1.5555555555555p+0) : k(false, static_cast<double>(1.33333337F));
        const Number e = op(VectorOp::exponent, w, mul(w, x, up));
        return {e, sub(w, op(VectorOp::mantissa, w, x), k(w, 1))};
    }

    Split split_bits(bool w, Number x) {
        const std::int32_t denormal =
            compare(VectorOp::less, w, x,
                    k(w, w ? std::numeric_limits<double>::min()
                           : static_cast<double>(std::numeric_limits<float>::min())));
        const Number scaled = blend(w, denormal, mul(w, x, k(w, w ? 0x1p53 : 0x1p24)), x);
        const Number lost = zero_unless(w, denormal, k(w, w ? 53 : 24));
        if (!w) {
            const Number three_quarters = pool_.bits(std::uint32_t{0x3F400000});
            const Number bits = op(VectorOp::integer_subtract, w, scaled, three_quarters);
            const Number fraction =
                op(VectorOp::bit_and, w, bits, pool_.bits(std::uint32_t{0x007FFFFF}));
            const Number whole =
                op(VectorOp::to_float, w, shifted(VectorOp::shift_right, w, bits, 23));
            return {sub(w, whole, lost),
                    sub(w, op(VectorOp::integer_add, w, fraction, three_quarters), k(w, 1))};
        }
        constexpr std::uint64_t kThreeQuarters = 0x3FE8000000000000;
        constexpr std::uint64_t kBias = 0x3FF0000000000000;
        const Number bits =
            op(VectorOp::integer_add, w, scaled, pool_.bits(kBias - kThreeQuarters));
        const Number fraction =
            op(VectorOp::bit_and, w, bits, pool_.bits(std::uint64_t{0x000FFFFFFFFFFFFF}));
        const Number whole = op(VectorOp::bit_or, w, shifted(VectorOp::shift_right, w, bits, 52),
                                pool_.bits(std::uint64_t{0x4330000000000000}));
        return {
            sub(w, sub(w, whole, k(w, 0x1p52 + 1023)), lost),
            sub(w, op(VectorOp::integer_add, w, fraction, pool_.bits(kThreeQuarters)), k(w, 1))};
    }
    Number shifted(VectorOp o, bool w, Number x, int bits) {
        VectorInstruction step;
        step.op = o;
        step.wide = w;
        step.immediate = static_cast<std::uint8_t>(bits);
        step.in[0] = x;
        return emit(step);
    }
    /// x * 2^n.
    /// @param is_limited  n is, to what exp2() limits it to
    Number scale(bool w, Number x, Number n, bool is_limited) {
        if (machine_.has_avx512) return op(VectorOp::scale, w, x, n);
        if (!is_limited) n = limited(w, n, w ? 2000 : 250);
        if (w) {
            const Number half = op(VectorOp::floor, w, mul(w, n, k(w, 0.5)));
            const auto power_of_two = [&](Number e) {
                return shifted(VectorOp::shift_left, w, add(w, e, k(w, 0x1p52 + 1023)), 52);
            };
            return mul(w, mul(w, x, power_of_two(half)), power_of_two(sub(w, n, half)));
        }
        const Number whole = op(VectorOp::to_index, w, n);
        const Number half = shifted(VectorOp::shift_right, w, whole, 1);
        const auto power_of_two = [&](Number e) {
            return shifted(VectorOp::shift_left, w,
                           op(VectorOp::integer_add, w, e, pool_.bits(std::uint32_t{127})), 23);
        };
        return mul(w, mul(w, x, power_of_two(half)),
                   power_of_two(op(VectorOp::integer_subtract, w, whole, half)));
    }

    Number exp2_fraction(Number r) {
        const Number p =
            horner(false, r, 0.6931471824645996, 0.24022647738456726, 0.055503327399492264,
                   0.00961843691766262, 0.001339884358458221, 0.00015353347407653928);
        return fma(false, p, r, k(false, 1));
    }
    Number limited(bool w, Number x, double limit) {
        return min(w, max(w, x, k(w, -limit)), k(w, limit));
    }
    Number exp2(bool w, Number x) {
        x = limited(w, x, w ? 2000 : 250);
        const Number n = op(VectorOp::round, w, x);
        const Number r = sub(w, x, n);
        if (!w) return scale(false, exp2_fraction(r), n, true);
        const Number p =
            horner(true, r, 0.6931471805599453, 0.2402265069591013, 0.05550410866482009,
                   0.009618129107594187, 0.0013333558146773998, 0.00015403530457037794,
                   1.5252733493437096e-05, 1.3215435315483844e-06, 1.0178199518826279e-07,
                   7.073778059560721e-09, 4.4347715552879237e-10);
        return scale(true, fma(true, p, r, k(true, 1)), n, true);
    }

    Number log2_curvature(Number f) {
        const Number z = mul(false, f, f);
        const Number even = horner(false, z, 1.327158027919495e-08, 0.48090076446533203,
                                   0.2883840501308441, 0.2091008722782135, 0.15066714584827423);
        const Number odd = horner(false, z, -0.7213475108146667, -0.3606748580932617,
                                  -0.24014823138713837, -0.19027815759181976, -0.06434474885463715);
        return mul(false, f, fma(false, odd, f, even));
    }
    Number log2_fraction(Number f) {
        const Number s = op(VectorOp::divide, true, f, add(true, f, k(true, 2)));
        const Number z = mul(true, s, s);
        const Number p = horner(true, z, 0.9617966939259746, 0.5770780163563926, 0.4121985828886401,
                                0.32059892760850184, 0.26230600942494436, 0.222046238639155,
                                0.19006442778763416, 0.19964825707152564);
        return fma(true, mul(true, s, z), p, mul(true, s, k(true, 2.8853900817779268)));
    }
    Number log2(bool w, Number x) {
        const auto [e, f] = split(w, x);
        const Number result =
            w ? add(true, e, log2_fraction(f))
              : add(false, fma(false, f, k(false, static_cast<double>(kLog2e)), e),
                    log2_curvature(f));
        const std::int32_t is_positive = compare(VectorOp::greater, w, x, k(w, 0));
        return blend(w, is_positive, result, k(w, -kInfinity));
    }

    Number power_near(Number x, double y) {
        const float y_hi = static_cast<float>(static_cast<std::int32_t>(y * 512)) / 512.0F;
        const double y_lo = y - static_cast<double>(y_hi);
        const double slope = y * static_cast<double>(kLog2e);
        const auto slope_hi = static_cast<float>(slope);
        const double slope_lo = slope - static_cast<double>(slope_hi);
        const Number vy = k(false, y);
        const auto [e, f] = split(false, x);
        const Number curvature = log2_curvature(f);
        const Number log2_x =
            add(false, e, fma(false, f, k(false, static_cast<double>(kLog2e)), curvature));
        const Number n = op(VectorOp::round, false, mul(false, log2_x, vy));
        Number r =
            op(VectorOp::multiply_subtract, false, k(false, static_cast<double>(y_hi)), e, n);
        r = fma(false, k(false, static_cast<double>(slope_hi)), f, r);
        r = fma(false, vy, curvature, r);
        r = add(false, r, fma(false, k(false, slope_lo), f, mul(false, k(false, y_lo), e)));
        return scale(false, exp2_fraction(r), n, false);
    }
    Number power_double(Number a, Number b) {
        const auto [e, f] = split(true, a);
        return exp2(true, mul(true, b, add(true, e, log2_fraction(f))));
    }
    /// @param y  of each half
    Number power_float(Number a, const std::array<Number, 2>& y) {
        const auto [e, f] = split(false, a);
        std::array<Number, 2> whole, rest;
        for (int half = 0; half < 2; ++half) {
            const auto h = static_cast<std::size_t>(half);
            const Number wide = promote(f, half);
            const Number q =
                horner(true, wide, 1.4426950409945543, -0.7213475168566406, 0.48089828222624775,
                       -0.360674359271077, 0.28854602343192026, -0.24042822178704773,
                       0.20582040034720844, -0.18031455716572908, 0.1646569515665286,
                       -0.15287069733099928, 0.1155046890543786, -0.044955420614352516);
            const Number p =
                limited(true, mul(true, fma(true, q, wide, promote(e, half)), y[h]), 250);
            whole[h] = op(VectorOp::round, true, p);
            rest[h] = sub(true, p, whole[h]);
        }
        return scale(false, exp2_fraction(demote(rest)), demote(whole), true);
    }
    Number power_of_any(bool w, Number a, Number b, Number magnitude) {
        const Number zero = k(w, 0);
        const Number half = mul(w, b, k(w, 0.5));
        const Number inf = k(w, kInfinity);
        const Number nan = k(w, std::numeric_limits<double>::quiet_NaN());
        Number of_negative =
            blend(w, compare(VectorOp::equal, w, op(VectorOp::floor, w, half), half), magnitude,
                  neg(w, magnitude));
        of_negative =
            blend(w, compare(VectorOp::equal, w, op(VectorOp::floor, w, b), b), of_negative, nan);
        const Number of_zero =
            blend(w, compare(VectorOp::greater, w, b, zero), value_of(w, zero), inf);
        const Number not_positive =
            blend(w, compare(VectorOp::equal, w, a, zero), of_zero, of_negative);
        const Number result =
            blend(w, compare(VectorOp::greater, w, a, zero), magnitude, not_positive);
        return blend(w, compare(VectorOp::equal, w, b, zero), k(w, 1), result);
    }
    Number power_of_any(bool w, Number a, double b, Number magnitude) {
        const std::int32_t is_positive = compare(VectorOp::greater, w, a, k(w, 0));
        if (b > 0) return zero_unless(w, is_positive, magnitude);
        return blend(w, is_positive, magnitude, k(w, kInfinity));
    }

    Number copy_sign(Number magnitude, Number from) {
        return op(VectorOp::bit_or, true, abs(true, magnitude),
                  op(VectorOp::bit_and, true, from, sign(true)));
    }
    Number atan2(Number y, Number x) {
        const Number zero = k(true, 0);
        const Number ax = abs(true, x);
        const Number ay = abs(true, y);
        const Number small = min(true, ax, ay);
        const Number large = max(true, ax, ay);
        const std::int32_t far =
            compare(VectorOp::greater, true, small, mul(true, large, k(true, 0.41421356237309503)));
        const Number top = blend(true, far, sub(true, small, large), small);
        const Number bottom = blend(true, far, add(true, small, large), large);
        const Number t = zero_unless(true, compare(VectorOp::greater, true, large, zero),
                                     op(VectorOp::divide, true, top, bottom));
        const Number z = mul(true, t, t);
        const Number p =
            horner(true, z, -0.33333333333333326, 0.19999999999997692, -0.14285714285390944,
                   0.11111111088362774, -0.09090908151259271, 0.07692282911857598,
                   -0.06666229031771803, 0.058770441703819475, -0.05218548969052191,
                   0.045041393781768635, -0.033488235462723365, 0.015209188612267548);
        Number angle = fma(true, mul(true, t, z), p, t);
        angle = add(true, angle, zero_unless(true, far, k(true, 0.78539816339744831)));
        angle = blend(true, compare(VectorOp::greater, true, ay, ax),
                      sub(true, k(true, 1.5707963267948966), angle), angle);
        angle = blend(true, op(VectorOp::is_minus, true, x).value,
                      sub(true, k(true, 3.1415926535897931), angle), angle);
        return copy_sign(angle, y);
    }

    // --- tables --------------------------------------------------------------------------------

    /// samples[x] at equal distances, in double.
    Number lookup(Number x, const SampledTable& table) {
        const std::size_t n = table.wide.size();
        const bool linear = table.interpolation == Table::Interpolation::linear;
        const Number t =
            min(true, zero_unless(true, compare(VectorOp::greater, true, x, k(true, 0)), x),
                k(true, 1));
        const auto samples = pool_.table(table.wide.data(), n);
        const auto gather = [&](Number index, std::size_t first) {
            VectorInstruction step;
            step.op = VectorOp::gather;
            step.wide = true;
            step.offset = samples + static_cast<std::uint32_t>(first * sizeof(double));
            step.in[0] = index;
            return emit(step);
        };
        const auto to_index = [&](Number cell) { return op(VectorOp::to_index, true, cell); };
        if (!linear) {
            const Number cell =
                min(true, op(VectorOp::floor, true, mul(true, t, k(true, static_cast<double>(n)))),
                    k(true, static_cast<double>(n - 1)));
            return gather(to_index(cell), 0);
        }
        const Number position = mul(true, t, k(true, static_cast<double>(n - 1)));
        const Number cell = min(true, op(VectorOp::floor, true, position),
                                k(true, static_cast<double>(n > 1 ? n - 2 : 0)));
        const Number index = to_index(cell);
        const Number a = gather(index, 0);
        const Number b = gather(index, n > 1 ? 1 : 0);
        return fma(true, sub(true, position, cell), sub(true, b, a), a);
    }

    Number pick(Number index, std::uint32_t table, int size) {
        VectorInstruction step;
        step.op = size == 16 ? VectorOp::permute_16 : VectorOp::permute_32;
        step.offset = table;
        step.in[0] = index;
        if (size <= 32) return emit(step);
        const Number low = emit(step);
        step.offset = table + 32 * sizeof(float);
        const Number high = emit(step);
        const std::int32_t is_high =
            compare(VectorOp::has_bit, false, index, pool_.bits(std::uint32_t{32}));
        return blend(false, is_high, high, low);
    }

    /// As interpolate() and find_places() in simd_kernels.cpp.
    std::array<Number, 3> lattice(const std::array<Number, 3>& at, const SampledLattice& lattice) {
        const auto number = [&](double value) { return k(false, value); };
        const double edge = lattice.edge;
        const Number n1 = number(edge);
        const Number n2 = number(edge * edge);
        const Number one = number(1);
        std::array<Number, 3> cell, f;
        for (std::size_t c = 0; c < 3; ++c) {
            const Number t = min(false, max(false, at[c], number(0)), one);
            const Number place = mul(false, t, number(edge - 1));
            cell[c] = min(false, op(VectorOp::floor, false, place), number(edge - 2));
            f[c] = sub(false, place, cell[c]);
        }
        const Number corner = fma(false, cell[0], n2, fma(false, cell[1], n1, cell[2]));
        const std::int32_t red_below_green = compare(VectorOp::less, false, f[0], f[1]);
        const Number upper = max(false, f[0], f[1]);
        const Number lower = min(false, f[0], f[1]);
        const Number step_upper = blend(false, red_below_green, n1, n2);
        const Number step_lower = blend(false, red_below_green, n2, n1);
        const Number step_highest =
            blend(false, compare(VectorOp::less, false, upper, f[2]), one, step_upper);
        const Number step_lowest =
            blend(false, compare(VectorOp::less, false, lower, f[2]), step_lower, one);
        const Number highest = max(false, upper, f[2]);
        const Number lowest = min(false, lower, f[2]);
        const Number middle = max(false, lower, min(false, upper, f[2]));
        const Number far = add(false, corner, number(edge * edge + edge + 1));
        const std::array<Number, 4> node = {corner, add(false, corner, step_highest),
                                            sub(false, far, step_lowest), far};
        const std::array<Number, 4> weight = {sub(false, one, highest), sub(false, highest, middle),
                                              sub(false, middle, lowest), lowest};
        for (std::uint8_t i = 0; i < 4; ++i) {
            spill_index(i, shifted(VectorOp::shift_left, false,
                                   op(VectorOp::to_index, false, node[i]), kNodeShift));
        }
        std::array<Number, 4> rgba;  // of a quarter of the pixels each
        for (std::uint8_t quarter = 0; quarter < 4; ++quarter) {
            Number sum;
            for (std::uint8_t i = 0; i < 4; ++i) {
                const Number nodes = rows(i, quarter, lattice.narrow.data(), 0);
                const Number weights = expand(weight[i], quarter);
                sum = i == 0 ? mul(false, weights, nodes) : fma(false, weights, nodes, sum);
            }
            rgba[quarter] = sum;
        }
        return channels(rgba);
    }
    void spill_index(std::uint8_t number, Number bytes) {
        VectorInstruction step;
        step.op = VectorOp::spill_index;
        step.immediate = number;
        step.in[0] = bytes;
        emit_store(step);
    }
    Number rows(std::uint8_t index, std::uint8_t quarter, const void* address,
                std::uint32_t offset) {
        VectorInstruction step;
        step.op = VectorOp::rows;
        step.immediate = static_cast<std::uint8_t>(index + 4 * quarter);
        step.address = address;
        step.offset = offset;
        return emit(step);
    }
    /// The floats of a quarter of the pixels, four times each.
    Number expand(Number x, std::uint8_t quarter) {
        if (!machine_.has_avx512) return shuffle_4(x, x, quarter * 0x55);
        std::array<std::int32_t, 16> of_pixel{};
        for (std::int32_t i = 0; i < 16; ++i)
            of_pixel[static_cast<std::size_t>(i)] = 4 * quarter + i / 4;
        VectorInstruction step;
        step.op = VectorOp::expand;
        step.offset = pool_.table(of_pixel.data(), of_pixel.size());
        step.in[0] = x;
        return emit(step);
    }

    Number segment_of(const CompiledCurve& curve, Number x) {
        // The interpreter's kinds: 32 or 64 cells, 16, 32 or 64 segments.
        const auto threshold = pool_.table(curve.threshold.data(), curve.threshold.size());
        if (curve.cells == 0) {
            const int size = size_of(curve.segments);
            Number index = k(false, 0);
            for (int bit = size / 2; bit > 0; bit /= 2) {
                const Number next = op(VectorOp::bit_or, false, value_of(false, index),
                                       pool_.bits(static_cast<std::uint32_t>(bit)));
                const std::int32_t is_there =
                    compare(VectorOp::greater_equal, false, x, pick(next, threshold, size));
                index = blend(false, is_there, next, value_of(false, index));
            }
            return index;
        }
        const int size = curve.cells <= 32 ? 32 : 64;
        const auto segment = pool_.table(curve.segment.data(), curve.segment.size());
        const Number limited = max(false, x, k(false, static_cast<double>(curve.cell_floor)));
        const Number cell = op(VectorOp::integer_subtract, false,
                               shifted(VectorOp::shift_right, false, limited, curve.shift),
                               pool_.bits(curve.first_cell));
        const std::int32_t is_behind =
            compare(VectorOp::greater_equal, false, x, pick(cell, threshold, size));
        VectorInstruction next;
        next.op = VectorOp::integer_add_where;
        next.mask = is_behind;
        next.in = {pick(cell, segment, size), pool_.bits(std::uint32_t{1}), {}};
        return emit(next);
    }

    static int size_of(int segments) { return segments <= 16 ? 16 : segments <= 32 ? 32 : 64; }

    /// What float leaves out of a double that is x, and 0 where x is limited.
    Number rest_of(Lanes& source, Number x) {
        std::array<Number, 2> rest;
        for (int half = 0; half < 2; ++half)
            rest[static_cast<std::size_t>(half)] =
                sub(true, wide(source, half), promote(source.narrow, half));
        const std::int32_t is_inside = compare(VectorOp::equal, false, source.narrow, x);
        return zero_unless(false, is_inside, demote(rest));
    }

    /// y t + first; of a precise curve y + first, and the sum in double.
    struct Polynomial {
        Number y, t, first;
    };
    Polynomial segment_polynomial(Lanes& source, bool has_rest, Number x,
                                  const CompiledCurve& curve) {
        const int size = size_of(curve.segments);
        const auto table = [&](const std::array<float, CompiledCurve::kMaxSegments>& numbers) {
            return pool_.table(numbers.data(), numbers.size());
        };
        const Number index = segment_of(curve, x);
        const Number scale = pick(index, table(curve.scale), size);
        Number t = fma(false, x, scale, pick(index, table(curve.offset), size));
        if (has_rest) t = fma(false, rest_of(source, x), scale, t);
        const auto coefficient = [&](int i) {
            return pick(index, table(curve.coefficient[static_cast<std::size_t>(i)]), size);
        };
        // The interpreter runs the kinds of degree 3 to 9.
        Number y = coefficient(curve.degree);
        for (int i = curve.degree - 1; i >= 1; --i)
            y = fma(false, y, t, coefficient(i));
        if (curve.is_precise) y = fma(false, y, t, pick(index, table(curve.rest), size));
        return {y, t, coefficient(0)};
    }
    /// As RowPolynomial in simd_kernels.cpp.
    /// @param x  not below 0
    Polynomial row_polynomial(Lanes& source, bool has_rest, Number x, const CurveRows& table) {
        const bool is_long = table.length == 8;
        Number base = pool_.bits(table.base);
        const Number bits = max(false, x, base);
        for (const CurveRows::Restart& restart : table.restarts) {
            // In the order of their bits, too.
            const std::int32_t is_behind =
                compare(VectorOp::greater_equal, false, bits, pool_.bits(restart.from));
            base = blend(false, is_behind, pool_.bits(restart.base), value_of(false, base));
        }
        const Number cell = shifted(VectorOp::shift_right, false,
                                    op(VectorOp::integer_subtract, false, bits, base), table.shift);
        spilled_ = static_cast<std::uint8_t>((spilled_ + 1) % 4);
        spill_index(spilled_, shifted(VectorOp::shift_left, false, cell, is_long ? 5 : kNodeShift));
        const std::uint32_t in_cell = (std::uint32_t{1} << table.shift) - 1;
        const Number x0 = table.restarts.empty() && (table.base & in_cell) == 0
                              ? op(VectorOp::bit_and, false, bits, pool_.bits(~in_cell))
                              : op(VectorOp::integer_add, false,
                                   shifted(VectorOp::shift_left, false, cell, table.shift), base);
        const Number scale =  // 0x7F000000 less the exponent
            op(VectorOp::integer_add, false,
               op(VectorOp::bit_and_not, false, x0, pool_.bits(std::uint32_t{0x7F800000})),
               pool_.bits(std::uint32_t{0xFF800000}));
        Number distance = sub(false, x, x0);
        if (has_rest) distance = add(false, distance, rest_of(source, x));
        const Number t = mul(false, distance, scale);
        const std::uint32_t offset = pool_.table(table.numbers.data(), table.numbers.size());
        std::array<Number, 4> low, high;
        for (std::uint8_t quarter = 0; quarter < 4; ++quarter) {
            low[quarter] = rows(spilled_, quarter, nullptr, offset);
            if (is_long)
                high[quarter] = rows(spilled_, quarter, nullptr, offset + 4 * sizeof(float));
        }
        Number y;
        if (is_long) {
            high = columns(high);
            y = high[3];
            for (std::size_t i = 3; i-- > 0;)
                y = fma(false, y, t, high[i]);
        }
        low = columns(low);
        y = is_long ? fma(false, y, t, low[3]) : low[3];
        y = fma(false, fma(false, y, t, low[2]), t, low[1]);
        return {y, t, low[0]};
    }

    Lanes curve(Lanes& source, bool is_wide, const CompiledCurve& curve) {
        const Number given = narrow(source);
        const Number lo = k(false, static_cast<double>(curve.lo));
        const Number x = min(false, max(false, given, lo), k(false, static_cast<double>(curve.hi)));
        const bool has_rest = curve.is_precise && is_wide;
        const Polynomial p = curve.rows ? row_polynomial(source, has_rest, x, *curve.rows)
                                        : segment_polynomial(source, has_rest, x, curve);
        const auto finished = [&](bool w, Number sum, std::int32_t is_above) {
            sum = min(w, max(w, sum, k(w, static_cast<double>(curve.least))),
                      k(w, static_cast<double>(curve.most)));
            return blend(w, is_above, sum, k(w, curve.at_lo));
        };
        Lanes result;
        if (!curve.is_precise) {
            const Number sum = fma(false, p.y, p.t, p.first);
            result.narrow = finished(false, sum, compare(VectorOp::greater, false, x, lo));
            return result;
        }
        for (int half = 0; half < 2; ++half) {
            const Number sum = add(true, promote(p.first, half), promote(p.y, half));
            const std::int32_t is_above = compare(VectorOp::greater, true, promote(x, half),
                                                  k(true, static_cast<double>(curve.lo)));
            result.wide[static_cast<std::size_t>(half)] = finished(true, sum, is_above);
        }
        return result;
    }

    /// In a register also where it is a constant: for operands that cannot be memory.
    Number value_of(bool w, Number x) { return x.is_value() ? x : op(VectorOp::constant, w, x); }

    // --- pixels --------------------------------------------------------------------------------

    Number sanitized(Number x) {
        const Number number = zero_unless(false, compare(VectorOp::equal, false, x, x), x);
        return limited(false, number, static_cast<double>(kLargestInput));
    }

    Number shuffle(Number a, Number b, const std::array<std::int32_t, 16>& from) {
        VectorInstruction step;
        step.op = VectorOp::shuffle;
        step.offset = pool_.table(from.data(), from.size());
        step.in = {a, b, {}};
        return emit(step);
    }
    Number load_pixels(int number) {
        VectorInstruction step;
        step.op = VectorOp::load_pixels;
        step.immediate = static_cast<std::uint8_t>(number);
        return emit(step);
    }
    /// RGB as it lies in memory, for what computes the same of each channel.
    std::array<Number, 3> load_floats() { return {load_pixels(0), load_pixels(1), load_pixels(2)}; }
    void store_floats(const std::array<Number, 3>& floats) {
        for (std::size_t i = 0; i < 3; ++i)
            store(VectorOp::store_pixels, static_cast<int>(i), floats[i]);
    }
    Number load_halves(int number) {
        VectorInstruction step;
        step.op = VectorOp::load_halves;
        step.immediate = static_cast<std::uint8_t>(number);
        return emit(step);
    }
    std::array<Number, 3> load_rgb() {
        if (!machine_.has_avx512) {
            // The first four pixels in the low half of each vector, the others in the high half.
            const std::array<Number, 3> v = {load_halves(0), load_halves(1), load_halves(2)};
            const Number red_green = shuffle_4(v[1], v[2], shuffle_code(2, 3, 1, 2));
            const Number green_blue = shuffle_4(v[0], v[1], shuffle_code(1, 2, 0, 1));
            return {shuffle_4(v[0], red_green, shuffle_code(0, 3, 0, 2)),
                    shuffle_4(green_blue, red_green, shuffle_code(0, 2, 1, 3)),
                    shuffle_4(green_blue, v[2], shuffle_code(1, 3, 0, 3))};
        }
        const std::array<Number, 3> v = {load_pixels(0), load_pixels(1), load_pixels(2)};
        std::array<Number, 3> result;
        for (std::int32_t c = 0; c < 3; ++c) {
            // From the first two vectors what is there, then the rest from the third.
            std::array<std::int32_t, 16> first{}, second{};
            for (std::int32_t i = 0; i < 16; ++i) {
                const std::int32_t at = 3 * i + c;
                first[static_cast<std::size_t>(i)] = at < 32 ? at : 0;
                second[static_cast<std::size_t>(i)] = at < 32 ? i : at - 32 + 16;
            }
            result[static_cast<std::size_t>(c)] = shuffle(shuffle(v[0], v[1], first), v[2], second);
        }
        return result;
    }
    Number shuffle_128(Number a, Number b, std::uint8_t which) {
        return shuffle_by(VectorOp::shuffle_128, a, b, which);
    }
    Number shuffle_4(Number a, Number b, int which) {
        return shuffle_by(VectorOp::shuffle_4, a, b, which);
    }
    Number shuffle_by(VectorOp o, Number a, Number b, int which) {
        VectorInstruction step;
        step.op = o;
        step.immediate = static_cast<std::uint8_t>(which);
        step.in = {a, b, {}};
        return emit(step);
    }
    /// For shuffle_4: floats i, j of a, then k, l of b.
    static constexpr int shuffle_code(int i, int j, int k, int l) {
        return i + 4 * j + 16 * k + 64 * l;
    }
    /// Of four vectors, the first floats of each four, the second and so on.
    std::array<Number, 4> columns(const std::array<Number, 4>& v) {
        const Number first01 = shuffle_4(v[0], v[1], 0x44);
        const Number first23 = shuffle_4(v[2], v[3], 0x44);
        const Number last01 = shuffle_4(v[0], v[1], 0xEE);
        const Number last23 = shuffle_4(v[2], v[3], 0xEE);
        return {shuffle_4(first01, first23, 0x88), shuffle_4(first01, first23, 0xDD),
                shuffle_4(last01, last23, 0x88), shuffle_4(last01, last23, 0xDD)};
    }
    std::array<Number, 3> load_rgba() {
        return channels({load_pixels(0), load_pixels(1), load_pixels(2), load_pixels(3)});
    }
    /// Of a block's pixels of four floats.
    std::array<Number, 3> channels(const std::array<Number, 4>& v) {
        if (!machine_.has_avx512) {
            const std::array<Number, 4> rgba = columns(v);
            return {rgba[0], rgba[1], rgba[2]};
        }
        std::array<std::int32_t, 16> red_green{}, blue{};
        for (std::int32_t i = 0; i < 8; ++i) {
            red_green[static_cast<std::size_t>(i)] = 4 * i;
            red_green[static_cast<std::size_t>(i) + 8] = 4 * i + 1;
            blue[static_cast<std::size_t>(i)] = 4 * i + 2;
        }
        const Number low = shuffle(v[0], v[1], red_green);
        const Number high = shuffle(v[2], v[3], red_green);
        const Number blue_low = shuffle(v[0], v[1], blue);
        const Number blue_high = shuffle(v[2], v[3], blue);
        return {shuffle_128(low, high, 0x44), shuffle_128(low, high, 0xEE),
                shuffle_128(blue_low, blue_high, 0x44)};
    }
    void store(VectorOp o, int number, Number value) {
        VectorInstruction step;
        step.op = o;
        step.immediate = static_cast<std::uint8_t>(number);
        step.in[0] = value;
        emit_store(step);
    }
    void store_rgb(const std::array<Number, 3>& c) {
        if (!machine_.has_avx512) {
            const Number red_green = shuffle_4(c[0], c[1], 0x88);
            const Number green_blue = shuffle_4(c[1], c[2], 0xDD);
            const Number blue_red = shuffle_4(c[2], c[0], shuffle_code(0, 2, 1, 3));
            store(VectorOp::store_halves, 0, shuffle_4(red_green, blue_red, 0x88));
            store(VectorOp::store_halves, 1,
                  shuffle_4(green_blue, red_green, shuffle_code(0, 2, 1, 3)));
            return store(VectorOp::store_halves, 2, shuffle_4(blue_red, green_blue, 0xDD));
        }
        for (std::int32_t v = 0; v < 3; ++v) {
            std::array<std::int32_t, 16> first{}, second{};
            for (std::int32_t i = 0; i < 16; ++i) {
                const std::int32_t at = 16 * v + i;
                const std::int32_t pixel = at / 3;
                const std::int32_t channel = at % 3;
                first[static_cast<std::size_t>(i)] = channel == 0   ? pixel
                                                     : channel == 1 ? 16 + pixel
                                                                    : 0;
                second[static_cast<std::size_t>(i)] = channel == 2 ? 16 + pixel : i;
            }
            store(VectorOp::store_pixels, v, shuffle(shuffle(c[0], c[1], first), c[2], second));
        }
    }
    void store_rgba(const std::array<Number, 3>& c) {
        if (!machine_.has_avx512) {
            for (int v = 0; v < 4; v += 2) {
                const Number red_green = shuffle_4(c[0], c[1], v == 0 ? 0x44 : 0xEE);
                for (int i = 0; i < 2; ++i)
                    store(VectorOp::store_colors, v + i,
                          shuffle_4(red_green, c[2], shuffle_code(i, i + 2, v + i, v + i)));
            }
            return;
        }
        for (std::int32_t v = 0; v < 4; ++v) {
            std::array<std::int32_t, 16> first{}, second{};
            for (std::int32_t i = 0; i < 16; ++i) {
                const std::int32_t pixel = 4 * v + i / 4;
                const std::int32_t channel = i % 4;
                first[static_cast<std::size_t>(i)] = channel == 1 ? 16 + pixel : pixel;
                second[static_cast<std::size_t>(i)] = channel == 2 ? 16 + pixel : i;
            }
            store(VectorOp::store_colors, v, shuffle(shuffle(c[0], c[1], first), c[2], second));
        }
    }

  private:
    static constexpr float kLog2e = 1.4426950216293335F;  // as in simd_math-inl.h
    static constexpr int kNodeShift = 4;                  // of 16 bytes

    Pool& pool_;
    VectorMachine machine_;
    VectorCode code_;
    std::uint8_t spilled_ = 0;  // of spill_index, the last one
};

/// What runs over a whole tile: what is rare, and what goes pixel by pixel.
bool is_tile_step(const Instruction& step) {
    switch (step.op) {
        case Op::lookup_nonuniform:
        case Op::sine:
        case Op::cosine:
            return true;
        case Op::lattice:
            return step.wide;
        case Op::lookup:
            return !step.wide;
        default:
            return false;
    }
}

}  // namespace

bool has_channels(Op op) {
    return op == Op::dot3 || op == Op::lookup_nonuniform || op == Op::lattice;
}

int operand_count(Op op) {
    switch (op) {
        case Op::copy:
        case Op::negate:
        case Op::absolute:
        case Op::square_root:
        case Op::floor:
        case Op::exp2:
        case Op::log2:
        case Op::power_constant:
        case Op::sine:
        case Op::cosine:
        case Op::lookup:
        case Op::lookup_nonuniform:
        case Op::curve:
            return 1;
        case Op::multiply_add:
        case Op::multiply_subtract:
        case Op::subtract_product:
        case Op::dot3:
        case Op::clamp:
        case Op::select:
        case Op::lattice:
            return 3;
        case Op::select_less:
        case Op::select_less_equal:
        case Op::select_equal:
            return 4;
        default:
            return 2;
    }
}

namespace {

/// The program with every value defined once, divided into parts.
class Translator {
  public:
    explicit Translator(const Code& code)
        : code_(code),
          machine_(*code.target->machine),
          pool_(machine_.has_avx512 ? 0 : static_cast<std::size_t>(machine_.bytes())) {
        for (std::size_t c = 0; c < 3; ++c) {
            if (code.reads_input[c]) {
                input_[c] = define(false);
                at_[code.input_offset[c]] = input_[c];
            }
        }
        // A step over the tile waits for the parts before it: by how many there are on the way.
        std::vector<std::size_t> level(values_.size(), 0);
        for (const Instruction& step : code.instructions) {
            Step s{&step, {kNone, kNone, kNone, kNone}, {kNone, kNone, kNone}, 0, 0};
            for (std::size_t i = 0; i < static_cast<std::size_t>(operand_count(step.op)); ++i) {
                if (step.in[i].constant) continue;
                s.in[i] = at_.at(step.in[i].offset);
                s.level = std::max(s.level, level[static_cast<std::size_t>(s.in[i])]);
            }
            for (std::size_t i = 0; i < 3; ++i) {
                if (has_channels(step.op) ? step.channel[i].constant : i > 0) continue;
                const Operand& out = has_channels(step.op) ? step.channel[i] : step.out;
                s.out[i] = define(out.wide);
                level.push_back(s.level + (is_tile_step(step) ? 1 : 0));
                at_[out.offset] = s.out[i];
            }
            steps_.push_back(s);
        }
        for (std::size_t c = 0; c < 3; ++c) {
            if (!code.output[c].constant) output_[c] = at_.at(code.output[c].offset);
        }
        std::stable_sort(steps_.begin(), steps_.end(), [](const Step& a, const Step& b) {
            return std::pair(a.level, is_tile_step(*a.step)) <
                   std::pair(b.level, is_tile_step(*b.step));
        });
        divide();
        find_crossings();
    }

    std::optional<VectorProgram> translate() {
        VectorProgram program;
        if (!place_in_tile(program)) return std::nullopt;
        program.tile_steps.resize(part_count_ - 1);
        for (const Step& s : steps_) {
            if (is_tile_step(*s.step)) program.tile_steps[s.part].push_back(moved(s));
        }
        for (const PixelLayout layout :
             {PixelLayout::planes, PixelLayout::rgb, PixelLayout::rgba}) {
            auto& parts = program.parts[static_cast<std::size_t>(layout)];
            for (std::size_t part = 0; part < part_count_; ++part)
                parts.push_back(write(part, layout));
        }
        program.pool = pool_.take();
        program.uniforms = pool_.take_uniforms();
        return program;
    }

  private:
    struct Value {
        std::size_t part = 0;  // that defines it, or behind which a step over the tile does
        bool wide = false;
        bool crosses = false;       // into another part, or to or from a tile step
        bool is_sanitized = false;  // by the curves that are all that reads it
        std::uint32_t offset = 0;
    };
    struct Step {
        const Instruction* step;
        std::array<std::int32_t, 4> in;
        std::array<std::int32_t, 3> out;
        std::size_t level;
        std::size_t part;  // that it belongs to, or runs behind
    };

    std::int32_t define(bool wide) {
        values_.push_back({0, wide, false, false, 0});
        return static_cast<std::int32_t>(values_.size() - 1);
    }
    Value& value(std::int32_t i) { return values_[static_cast<std::size_t>(i)]; }

    /// How many bytes of a pixel are defined before step `at` and read from there on.
    [[nodiscard]] std::vector<std::size_t> bytes_across() {
        std::vector<std::size_t> first(values_.size(), 0), last(values_.size(), 0);
        for (std::size_t i = 0; i < steps_.size(); ++i) {
            for (const std::int32_t v : steps_[i].out) {
                if (v != kNone) first[static_cast<std::size_t>(v)] = i + 1;
            }
            for (const std::int32_t v : steps_[i].in) {
                if (v != kNone) last[static_cast<std::size_t>(v)] = i;
            }
        }
        for (const std::int32_t v : output_) {
            if (v != kNone) last[static_cast<std::size_t>(v)] = steps_.size();
        }
        std::vector<std::size_t> result(steps_.size() + 1, 0);
        for (std::size_t v = 0; v < values_.size(); ++v) {
            for (std::size_t at = first[v]; at <= last[v]; ++at)
                result[at] += values_[v].wide ? sizeof(double) : sizeof(float);
        }
        return result;
    }

    /// Parts end where a step over the tile begins, and where they get so long that a processor
    /// could not begin with the next pixels while it waits for the results of these: there at the
    /// place with the fewest values to hand on.
    void divide() {
        const std::vector<std::size_t> across = bytes_across();
        std::size_t part = 0;
        std::size_t begin = 0;
        const auto end_part = [&](std::size_t end) {
            for (; begin < end; ++begin)
                steps_[begin].part = part;
        };
        while (begin < steps_.size()) {
            if (is_tile_step(*steps_[begin].step)) {
                steps_[begin].part = part;
                ++begin;
                if (begin == steps_.size() || !is_tile_step(*steps_[begin].step) ||
                    steps_[begin].level != steps_[begin - 1].level) {
                    ++part;
                }
                continue;
            }
            std::size_t end = begin;
            std::size_t best = begin;
            int length = 0;
            for (; end < steps_.size() && !is_tile_step(*steps_[end].step); ++end) {
                length += vectors_of(*steps_[end].step);
                if (length > machine_.longest_part) break;
                if (length >= machine_.longest_part / 2 &&
                    (best == begin || across[end + 1] <= across[best]))
                    best = end + 1;
            }
            const bool is_whole = end == steps_.size() || is_tile_step(*steps_[end].step);
            end_part(is_whole ? end : std::max(best, begin + 1));
            if (!is_whole) ++part;
        }
        part_count_ = part + 1;
        for (const Step& s : steps_) {
            for (const std::int32_t v : s.out) {
                if (v != kNone) value(v).part = s.part;
            }
        }
    }

    /// About how many vector instructions it is.
    [[nodiscard]] int vectors_of(const Instruction& step) const {
        const int halves = step.wide ? 2 : 1;
        switch (step.op) {
            case Op::curve: {
                const CompiledCurve& curve = code_.curves[step.table];
                if (curve.rows) return 16 + 2 * curve.rows->length;
                return 20 + (curve.segments > 32 ? 5 : 2) * curve.degree;
            }
            case Op::dot3:
                return halves * 9;
            case Op::exp2:
            case Op::log2:
                return halves * 16;
            case Op::power_constant:
                return halves * 30;
            case Op::power:
            case Op::atan2:
                return halves * 40;
            case Op::lookup:
                return halves * 15;
            case Op::lattice:
                return 80;
            default:
                return halves;
        }
    }

    void find_crossings() {
        for (const std::int32_t i : input_) {
            if (i != kNone) value(i).is_sanitized = true;
        }
        for (const Step& s : steps_) {
            for (const std::int32_t i : s.in) {
                if (i == kNone) continue;
                if (is_tile_step(*s.step) || s.part != value(i).part) value(i).crosses = true;
                if (!limits_input(*s.step)) value(i).is_sanitized = false;
            }
            if (!is_tile_step(*s.step)) continue;
            for (const std::int32_t i : s.out) {
                if (i != kNone) value(i).crosses = true;
            }
        }
        for (const std::int32_t i : output_) {
            if (i == kNone) continue;
            if (value(i).part != part_count_ - 1) value(i).crosses = true;
            value(i).is_sanitized = false;
        }
    }

    /// A curve over the light that there is takes every number, and NaN as black, by itself.
    bool limits_input(const Instruction& step) const {
        if (step.op != Op::curve) return false;
        const CompiledCurve& curve = code_.curves[step.table];
        return curve.lo >= 0 && curve.hi <= kLargestInput;
    }

    /// False where the tile is too small.
    bool place_in_tile(VectorProgram& program) {
        // Where the pixels lie in planes, they come and go through the tile.
        std::size_t bytes = 6 * sizeof(float);
        for (const Value& v : values_)
            bytes += v.crosses ? v.wide ? sizeof(double) : sizeof(float) : 0;
        program.tile =
            std::clamp(kTileBytes / bytes / kLaneMultiple * kLaneMultiple, kLaneMultiple, kMaxTile);
        if (program.tile * bytes > kRegisterFileBytes) return false;
        std::uint32_t end = 0;
        const auto place = [&](bool wide) {
            const std::uint32_t at = end;
            end +=
                static_cast<std::uint32_t>(program.tile * (wide ? sizeof(double) : sizeof(float)));
            return at;
        };
        program.reads_input = code_.reads_input;
        for (std::size_t c = 0; c < 3; ++c) {
            program.input_offset[c] = input_offset_[c] = place(false);
            output_offset_[c] = place(false);
            program.output[c] = code_.output[c];
            if (!code_.output[c].constant) program.output[c].offset = output_offset_[c];
        }
        for (Value& v : values_) {
            if (v.crosses) v.offset = place(v.wide);
        }
        return true;
    }

    Instruction moved(const Step& s) {
        Instruction step = *s.step;
        const auto move = [&](Operand& operand, std::int32_t i) {
            if (i != kNone) operand.offset = value(i).offset;
        };
        for (std::size_t i = 0; i < 4; ++i)
            move(step.in[i], s.in[i]);
        for (std::size_t i = 0; i < 3; ++i) {
            if (has_channels(step.op)) move(step.channel[i], s.out[i]);
        }
        if (!has_channels(step.op)) move(step.out, s.out[0]);
        return step;
    }

    // --- one part --------------------------------------------------------------------------------

    VectorCode write(std::size_t part, PixelLayout layout) {
        Writer writer(pool_, machine_);
        writer_ = &writer;
        lanes_.assign(values_.size(), {});
        if (part == 0) read_inputs(layout);
        for (const Step& s : steps_) {
            if (s.part == part && !is_tile_step(*s.step)) write(s);
        }
        if (part == part_count_ - 1) write_outputs(layout);
        return writer.take();
    }

    void read_inputs(PixelLayout layout) {
        std::array<Number, 3> given;
        if (layout == PixelLayout::rgb)
            given = code_.is_one_function ? writer_->load_floats() : writer_->load_rgb();
        if (layout == PixelLayout::rgba) given = writer_->load_rgba();
        for (std::size_t c = 0; c < 3; ++c) {
            if (input_[c] == kNone) continue;
            Value& v = value(input_[c]);
            if (layout == PixelLayout::planes) given[c] = load(input_offset_[c], false, 0);
            // In the tile they are sanitized already.
            lanes(input_[c]).narrow = v.is_sanitized || layout == PixelLayout::planes
                                          ? given[c]
                                          : writer_->sanitized(given[c]);
            keep(input_[c]);
        }
    }

    void write_outputs(PixelLayout layout) {
        std::array<Number, 3> result;
        for (std::size_t c = 0; c < 3; ++c) {
            if (output_[c] == kNone) {
                result[c] = writer_->value_of(false, number(code_.output[c]).narrow);
            } else {
                result[c] = writer_->narrow(given(output_[c]));
            }
        }
        if (layout == PixelLayout::rgb)
            return code_.is_one_function ? writer_->store_floats(result)
                                         : writer_->store_rgb(result);
        if (layout == PixelLayout::rgba) return writer_->store_rgba(result);
        for (std::size_t c = 0; c < 3; ++c) {
            if (output_[c] != kNone) store(output_offset_[c], false, 0, result[c]);
        }
    }

    Lanes& lanes(std::int32_t i) { return lanes_[static_cast<std::size_t>(i)]; }

    /// A value of this part, or one that has come through the tile.
    Lanes& given(std::int32_t i) {
        Lanes& result = lanes(i);
        const Value& v = value(i);
        const auto is_here = [](Number n) { return n.is_value() || n.is_constant(); };
        if (is_here(result.narrow) || is_here(result.wide[0])) return result;
        if (v.wide) {
            result.wide = {load(v.offset, true, 0), load(v.offset, true, 1)};
        } else {
            result.narrow = load(v.offset, false, 0);
        }
        return result;
    }
    void keep(std::int32_t i) {
        const Value& v = value(i);
        if (!v.crosses) return;
        if (!v.wide) return store(v.offset, false, 0, lanes(i).narrow);
        for (int half = 0; half < 2; ++half)
            store(v.offset, true, half, lanes(i).wide[static_cast<std::size_t>(half)]);
    }
    Number load(std::uint32_t offset, bool wide, int half) {
        VectorInstruction step;
        step.op = VectorOp::load_plane;
        step.wide = wide;
        step.immediate = static_cast<std::uint8_t>(half);
        step.offset = offset;
        return writer_->emit(step);
    }
    void store(std::uint32_t offset, bool wide, int half, Number x) {
        VectorInstruction step;
        step.op = VectorOp::store_plane;
        step.wide = wide;
        step.immediate = static_cast<std::uint8_t>(half);
        step.offset = offset;
        step.in[0] = x;
        writer_->emit_store(step);
    }

    Lanes operand(const Step& s, std::size_t i) {
        return s.in[i] != kNone ? given(s.in[i]) : number(s.step->in[i]);
    }

    /// A constant or a uniform.
    Lanes number(const Operand& source) {
        const unsigned char* const bytes =
            code_.numbers.constants[source.offset / kVectorBytes].bytes.data();
        double value = 0;
        if (source.wide) {
            std::memcpy(&value, bytes, sizeof value);
        } else {
            float narrow = 0;
            std::memcpy(&narrow, bytes, sizeof narrow);
            value = static_cast<double>(narrow);  // promoted here, not there
        }
        const auto place = [&](bool wide) {
            for (const UniformPlace& uniform : code_.uniforms) {
                if (uniform.offset == source.offset)
                    return pool_.uniform(uniform.source, value, wide, wide && !source.wide);
            }
            return pool_.number(value, wide);
        };
        Lanes result;
        if (!source.wide) result.narrow = place(false);
        result.wide[0] = result.wide[1] = place(true);
        return result;
    }

    /// The operand as vectors of floats, or of doubles of one half.
    Number in(const Step& s, std::size_t i, bool wide, int half) {
        if (s.in[i] == kNone) {
            const Lanes constant = operand(s, i);
            return wide ? constant.wide[0] : constant.narrow;
        }
        Lanes& source = given(s.in[i]);
        return wide ? writer_->wide(source, half) : writer_->narrow(source);
    }

    /// The results of a step that computes wide: kept as they are, or as floats.
    void finish(std::int32_t i, const std::array<Number, 2>& result) {
        if (value(i).wide) {
            lanes(i).wide = result;
        } else {
            lanes(i).narrow = writer_->demote(result);
        }
        keep(i);
    }

    void write(const Step& s) {
        const Instruction& step = *s.step;
        Writer& w = *writer_;
        if (step.op == Op::curve) {
            Lanes source = operand(s, 0);
            Lanes result = w.curve(source, step.in[0].wide, code_.curves[step.table]);
            const Number narrow = result.narrow;
            if (value(s.out[0]).wide) {
                lanes(s.out[0]).wide = {w.wide(result, 0), w.wide(result, 1)};
            } else {
                lanes(s.out[0]).narrow = narrow.is_value() ? narrow : w.narrow(result);
            }
            return keep(s.out[0]);
        }
        if (step.op == Op::lattice) {
            const std::array<Number, 3> rgb =
                w.lattice({in(s, 0, false, 0), in(s, 1, false, 0), in(s, 2, false, 0)},
                          code_.lattices[step.table]);
            for (std::size_t c = 0; c < 3; ++c) {
                if (s.out[c] == kNone) continue;
                lanes(s.out[c]).narrow = rgb[c];
                keep(s.out[c]);
            }
            return;
        }
        if (!step.wide && (step.op == Op::power || step.op == Op::power_constant)) {
            lanes(s.out[0]).narrow = narrow_power(s);
            return keep(s.out[0]);
        }
        for (std::size_t row = 0; row < 3; ++row) {
            if (s.out[row] == kNone) continue;
            if (step.wide) {
                const std::array<Number, 2> result = {compute(s, row, true, 0),
                                                      compute(s, row, true, 1)};
                finish(s.out[row], result);
            } else {
                lanes(s.out[row]).narrow = compute(s, row, false, 0);
                keep(s.out[row]);
            }
        }
    }

    Number narrow_power(const Step& s) {
        Writer& w = *writer_;
        const Number x = in(s, 0, false, 0);
        if (s.step->op == Op::power) {
            const Number y = in(s, 1, false, 0);
            const std::array<Number, 2> wide = {in(s, 1, true, 0), in(s, 1, true, 1)};
            return w.power_of_any(false, x, y, w.power_float(w.abs(false, x), wide));
        }
        const double y = s.step->k[0];
        constexpr double kNearPower = 4;  // as in simd_math-inl.h with fused multiply-add
        if (std::fabs(y) <= kNearPower) return w.power_of_any(false, x, y, w.power_near(x, y));
        const Number wide_y = pool_.number(y, true);
        return w.power_of_any(false, x, y, w.power_float(x, {wide_y, wide_y}));
    }

    Number compute(const Step& s, std::size_t row, bool wide, int half) {
        const Instruction& step = *s.step;
        Writer& w = *writer_;
        const auto x = [&](std::size_t i) { return in(s, i, wide, half); };
        const auto op = [&](VectorOp o, Number a, Number b = {}, Number c = {}) {
            return w.op(o, wide, a, b, c);
        };
        const auto chosen = [&](VectorOp comparison) {
            const Number yes = x(2);
            const Number no = x(3);
            return w.blend(wide, w.compare(comparison, wide, x(0), x(1)), yes,
                           w.value_of(wide, no));
        };
        const auto truth = [&](VectorOp comparison) {
            const std::int32_t mask = w.compare(comparison, wide, w.value_of(wide, x(0)), x(1));
            return w.zero_unless(wide, mask, pool_.number(1, wide));
        };
        switch (step.op) {
            case Op::copy:
                return w.value_of(wide, x(0));
            case Op::add:
                return op(VectorOp::add, x(0), x(1));
            case Op::subtract:
                return op(VectorOp::subtract, x(0), x(1));
            case Op::multiply:
                return op(VectorOp::multiply, x(0), x(1));
            case Op::divide:
                return op(VectorOp::divide, x(0), x(1));
            case Op::multiply_add:
                return op(VectorOp::multiply_add, x(0), x(1), x(2));
            case Op::multiply_subtract:
                return op(VectorOp::multiply_subtract, x(0), x(1), x(2));
            case Op::subtract_product:
                return op(VectorOp::subtract_product, x(0), x(1), x(2));
            case Op::dot3: {
                const auto k = [&](std::size_t i) {
                    return pool_.number(step.k[3 * row + i], wide);
                };
                return w.fma(wide, x(2), k(2), w.fma(wide, x(1), k(1), w.mul(wide, x(0), k(0))));
            }
            case Op::minimum:  // the operands' order: see simd_kernels.cpp
                return w.min(wide, x(1), x(0));
            case Op::maximum:
                return w.max(wide, x(1), x(0));
            case Op::clamp:
                return w.min(wide, x(2), w.max(wide, x(1), x(0)));
            case Op::negate:
                return w.neg(wide, x(0));
            case Op::absolute:
                return w.abs(wide, x(0));
            case Op::square_root:
                return op(VectorOp::square_root, x(0));
            case Op::floor:
                return op(VectorOp::floor, x(0));
            case Op::exp2:
                return w.exp2(wide, x(0));
            case Op::log2:
                return w.log2(wide, x(0));
            case Op::power:
                return w.power_of_any(true, x(0), x(1), w.power_double(w.abs(true, x(0)), x(1)));
            case Op::power_constant:
                return w.power_of_any(true, x(0), step.k[0],
                                      w.power_double(x(0), pool_.number(step.k[0], true)));
            case Op::atan2:
                return w.atan2(x(0), x(1));
            case Op::less:
                return truth(VectorOp::less);
            case Op::less_equal:
                return truth(VectorOp::less_equal);
            case Op::equal:
                return truth(VectorOp::equal);
            case Op::select: {
                const Number yes = x(1);
                const Number no = x(2);
                const std::int32_t is_false =
                    w.compare(VectorOp::equal, wide, x(0), pool_.number(0, wide));
                return w.blend(wide, is_false, no, w.value_of(wide, yes));
            }
            case Op::select_less:
                return chosen(VectorOp::less);
            case Op::select_less_equal:
                return chosen(VectorOp::less_equal);
            case Op::select_equal:
                return chosen(VectorOp::equal);
            case Op::lookup:
                return w.lookup(x(0), code_.tables[step.table]);
            case Op::lookup_nonuniform:
            case Op::lattice:
            case Op::sine:
            case Op::cosine:
            case Op::curve:
                break;  // not of a part, or written already
        }
        return {};
    }

    const Code& code_;
    VectorMachine machine_;
    std::vector<Value> values_;
    std::map<std::uint32_t, std::int32_t> at_;  // by offset in the interpreter's tile
    std::vector<Step> steps_;
    std::array<std::int32_t, 3> input_ = {kNone, kNone, kNone};
    std::array<std::int32_t, 3> output_ = {kNone, kNone, kNone};
    std::array<std::uint32_t, 3> input_offset_{};
    std::array<std::uint32_t, 3> output_offset_{};
    std::size_t part_count_ = 1;
    Pool pool_;
    std::vector<Lanes> lanes_;
    Writer* writer_ = nullptr;
};

}  // namespace

VectorCode interleaved(const VectorCode& code, int blocks) {
    VectorCode result;
    result.value_count = code.value_count * blocks;
    for (const VectorInstruction& one : code.instructions) {
        for (int block = 0; block < blocks; ++block) {
            VectorInstruction step = one;
            step.block = static_cast<std::uint8_t>(block);
            const auto move = [&](std::int32_t& value) {
                if (value != kNone) value += code.value_count * block;
            };
            move(step.result);
            move(step.mask);
            for (VectorOperand& operand : step.in)
                move(operand.value);
            result.instructions.push_back(step);
        }
    }
    return result;
}

std::optional<VectorProgram> translate(const Code& code) { return Translator(code).translate(); }

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
