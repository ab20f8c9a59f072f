// SPDX-License-Identifier: Apache-2.0
//
// Elementary functions over Highway vectors, compiled once for each instruction set. Coefficients
// are minimax polynomials (Remez exchange, 50 digits); the error beside each is that of the
// polynomial alone. tests/unit/engine/simd_test.cpp holds the functions to the bounds stated.

#if defined(TONEWRIGHT_ENGINE_SIMD_MATH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TONEWRIGHT_ENGINE_SIMD_MATH_INL_H
#undef TONEWRIGHT_ENGINE_SIMD_MATH_INL_H
#else
#define TONEWRIGHT_ENGINE_SIMD_MATH_INL_H
#endif

#include <cstdint>
#include <limits>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using hn::TFromD;  // for Highway's macros

template <class D>
using Vec = hn::Vec<D>;

/// c0 + x (c1 + x (c2 + ...)).
template <class D>
HWY_INLINE Vec<D> horner(D d, Vec<D> /*x*/, double c0) {
    return hn::Set(d, static_cast<hn::TFromD<D>>(c0));
}
template <class D, class... C>
HWY_INLINE Vec<D> horner(D d, Vec<D> x, double c0, C... c) {
    return hn::MulAdd(horner(d, x, c...), x, hn::Set(d, static_cast<hn::TFromD<D>>(c0)));
}

// ---------------------------------------------------------------------------------------------
// Exponents: x = 2^e (1 + f) with 1 + f in [3/4, 3/2) for finite x > 0, and x * 2^n for whole n;
// with denormals.

#if HWY_TARGET <= HWY_AVX3  // AVX-512 has instructions for both

// As many floats as doubles. Highway's tag for them is another type from one version to the next.
using HalfOfFloats = hn::Rebind<float, hn::Full512<double>>;

// 4/3 x has the next exponent exactly where the fraction of x is 3/2 or more, also when rounded:
// with 4/3 rounded up to float (by 1/3 of a last place) and down to double (by 1/3), 3/2 gives 2
// and the number before it gives less. Rounded up to double (by 2/3), that one would give 2 as
// well.
HWY_INLINE void split(hn::Full512<float> d, Vec<hn::Full512<float>> x, Vec<hn::Full512<float>>& e,
                      Vec<hn::Full512<float>>& f) {
    e.raw = _mm512_getexp_ps(hn::Mul(x, hn::Set(d, 1.33333337F)).raw);
    f.raw = _mm512_getmant_ps(x.raw, _MM_MANT_NORM_p75_1p5, _MM_MANT_SIGN_zero);
    f = hn::Sub(f, hn::Set(d, 1.0F));
}
HWY_INLINE void split(HalfOfFloats d, Vec<HalfOfFloats> x, Vec<HalfOfFloats>& e,
                      Vec<HalfOfFloats>& f) {
    e.raw = _mm256_getexp_ps(hn::Mul(x, hn::Set(d, 1.33333337F)).raw);
    f.raw = _mm256_getmant_ps(x.raw, _MM_MANT_NORM_p75_1p5, _MM_MANT_SIGN_zero);
    f = hn::Sub(f, hn::Set(d, 1.0F));
}
HWY_INLINE void split(hn::Full512<double> d, Vec<hn::Full512<double>> x,
                      Vec<hn::Full512<double>>& e, Vec<hn::Full512<double>>& f) {
    e.raw = _mm512_getexp_pd(hn::Mul(x, hn::Set(d, 0x1.5555555555555p+0)).raw);
    f.raw = _mm512_getmant_pd(x.raw, _MM_MANT_NORM_p75_1p5, _MM_MANT_SIGN_zero);
    f = hn::Sub(f, hn::Set(d, 1.0));
}
HWY_INLINE Vec<hn::Full512<float>> scale(hn::Full512<float> /*d*/, Vec<hn::Full512<float>> x,
                                         Vec<hn::Full512<float>> n) {
    return Vec<hn::Full512<float>>{_mm512_scalef_ps(x.raw, n.raw)};
}
HWY_INLINE Vec<HalfOfFloats> scale(HalfOfFloats /*d*/, Vec<HalfOfFloats> x, Vec<HalfOfFloats> n) {
    return Vec<HalfOfFloats>{_mm256_scalef_ps(x.raw, n.raw)};
}
HWY_INLINE Vec<hn::Full512<double>> scale(hn::Full512<double> /*d*/, Vec<hn::Full512<double>> x,
                                          Vec<hn::Full512<double>> n) {
    return Vec<hn::Full512<double>>{_mm512_scalef_pd(x.raw, n.raw)};
}

#else

template <class D, HWY_IF_LANE_SIZE_D(D, 4)>
HWY_INLINE void split(D d, Vec<D> x, Vec<D>& e, Vec<D>& f) {
    const hn::Rebind<std::int32_t, D> di;
    const auto denormal = hn::Lt(x, hn::Set(d, std::numeric_limits<float>::min()));
    const auto scaled = hn::IfThenElse(denormal, hn::Mul(x, hn::Set(d, 0x1p24F)), x);
    const auto three_quarters = hn::Set(di, 0x3F400000);
    const auto bits = hn::Sub(hn::BitCast(di, scaled), three_quarters);
    const auto fraction = hn::Add(hn::And(bits, hn::Set(di, 0x007FFFFF)), three_quarters);
    f = hn::Sub(hn::BitCast(d, fraction), hn::Set(d, 1.0F));
    e = hn::ConvertTo(d, hn::ShiftRight<23>(bits));
    e = hn::Sub(e, hn::IfThenElseZero(denormal, hn::Set(d, 24.0F)));
}

// 64-bit integers are converted by way of the low bits of 2^52 + n: below AVX-512 there is no
// instruction.
template <class D, HWY_IF_LANE_SIZE_D(D, 8)>
HWY_INLINE void split(D d, Vec<D> x, Vec<D>& e, Vec<D>& f) {
    const hn::Rebind<std::uint64_t, D> du;
    const auto denormal = hn::Lt(x, hn::Set(d, std::numeric_limits<double>::min()));
    const auto scaled = hn::IfThenElse(denormal, hn::Mul(x, hn::Set(d, 0x1p53)), x);
    const auto three_quarters = hn::Set(du, 0x3FE8000000000000);
    const auto bias = hn::Set(du, 0x3FF0000000000000);  // keeps the difference positive
    const auto bits = hn::Add(hn::Sub(hn::BitCast(du, scaled), three_quarters), bias);
    const auto fraction = hn::Add(hn::And(bits, hn::Set(du, 0x000FFFFFFFFFFFFF)), three_quarters);
    f = hn::Sub(hn::BitCast(d, fraction), hn::Set(d, 1.0));
    const auto whole = hn::Or(hn::ShiftRight<52>(bits), hn::Set(du, 0x4330000000000000));
    e = hn::Sub(hn::BitCast(d, whole), hn::Set(d, 0x1p52 + 1023));
    e = hn::Sub(e, hn::IfThenElseZero(denormal, hn::Set(d, 53.0)));
}

// In two factors, so that results outside the normal numbers are rounded once, or reach 0 or
// infinity.
template <class D, HWY_IF_LANE_SIZE_D(D, 4)>
HWY_INLINE Vec<D> scale(D d, Vec<D> x, Vec<D> n) {
    const hn::Rebind<std::int32_t, D> di;
    const auto limit = hn::Set(d, 250.0F);
    const auto whole = hn::ConvertTo(di, hn::Min(hn::Max(n, hn::Neg(limit)), limit));
    const auto half = hn::ShiftRight<1>(whole);
    const auto power_of_two = [d, di](auto k) HWY_ATTR {
        return hn::BitCast(d, hn::ShiftLeft<23>(hn::Add(k, hn::Set(di, 127))));
    };
    return hn::Mul(hn::Mul(x, power_of_two(half)), power_of_two(hn::Sub(whole, half)));
}

template <class D, HWY_IF_LANE_SIZE_D(D, 8)>
HWY_INLINE Vec<D> scale(D d, Vec<D> x, Vec<D> n) {
    const hn::Rebind<std::uint64_t, D> du;
    const auto limit = hn::Set(d, 2000.0);
    const auto whole = hn::Min(hn::Max(n, hn::Neg(limit)), limit);
    const auto half = hn::Floor(hn::Mul(whole, hn::Set(d, 0.5)));
    const auto power_of_two = [d, du](auto k) HWY_ATTR {
        return hn::BitCast(
            d, hn::ShiftLeft<52>(hn::BitCast(du, hn::Add(k, hn::Set(d, 0x1p52 + 1023)))));
    };
    return hn::Mul(hn::Mul(x, power_of_two(half)), power_of_two(hn::Sub(whole, half)));
}

#endif

// ---------------------------------------------------------------------------------------------
// Float

/// 2^r for r in [-1/2, 1/2]; 2^-28.9.
template <class D>
HWY_INLINE Vec<D> exp2_fraction(D d, Vec<D> r) {
    const auto p = horner(d, r, 0.6931471824645996, 0.24022647738456726, 0.055503327399492264,
                          0.00961843691766262, 0.001339884358458221, 0.00015353347407653928);
    return hn::MulAdd(p, r, hn::Set(d, 1.0F));
}

/// 2^x.
template <class D>
HWY_INLINE Vec<D> exp2_float(D d, Vec<D> x) {
    const auto limit = hn::Set(d, 250.0F);
    x = hn::Min(hn::Max(x, hn::Neg(limit)), limit);
    const auto n = hn::Round(x);
    return scale(d, exp2_fraction(d, hn::Sub(x, n)), n);
}

/// 1/ln 2, rounded to float.
inline constexpr float kLog2e = 1.4426950216293335F;

/// log2(1 + f) - kLog2e f for 1 + f in [3/4, 3/2); 2^-27.8 of the logarithm.
template <class D>
HWY_INLINE Vec<D> log2_curvature(D d, Vec<D> f) {
    // Even and odd powers apart: a shorter chain. The first coefficient is the rest of 1/ln 2.
    const auto z = hn::Mul(f, f);
    const auto even = horner(d, z, 1.327158027919495e-08, 0.48090076446533203, 0.2883840501308441,
                             0.2091008722782135, 0.15066714584827423);
    const auto odd = horner(d, z, -0.7213475108146667, -0.3606748580932617, -0.24014823138713837,
                            -0.19027815759181976, -0.06434474885463715);
    return hn::Mul(f, hn::MulAdd(odd, f, even));
}

/// log2(x); -inf for x <= 0.
template <class D>
HWY_INLINE Vec<D> log2_float(D d, Vec<D> x) {
    auto e = hn::Undefined(d);
    auto f = hn::Undefined(d);
    split(d, x, e, f);
    // The exponent first: below 3/4 it is -1, and most of it cancels.
    const auto result = hn::Add(hn::MulAdd(f, hn::Set(d, kLog2e), e), log2_curvature(d, f));
    return hn::IfThenElse(hn::Gt(x, hn::Zero(d)), result,
                          hn::Set(d, -std::numeric_limits<float>::infinity()));
}

/// Largest exponent of power_near that keeps to 2 ulp; the rounding of its products tells.
inline constexpr double kNearPower = HWY_NATIVE_FMA ? 4 : 1;

/// x^y for one y with |y| <= kNearPower and x > 0. The product of y and the exponent of x is exact
/// (y in two parts, the first of 11 bits); what is left is small, and so is its float error.
template <class D>
HWY_INLINE Vec<D> power_near(D d, Vec<D> x, double y) {
    const float y_hi = static_cast<float>(static_cast<std::int32_t>(y * 512)) / 512.0F;
    const auto y_lo = hn::Set(d, static_cast<float>(y - static_cast<double>(y_hi)));
    const auto vy = hn::Set(d, static_cast<float>(y));
    const double slope = y * static_cast<double>(kLog2e);
    const auto slope_hi = static_cast<float>(slope);
    const auto slope_lo = hn::Set(d, static_cast<float>(slope - static_cast<double>(slope_hi)));
    auto e = hn::Undefined(d);
    auto f = hn::Undefined(d);
    split(d, x, e, f);
    const auto curvature = log2_curvature(d, f);
    const auto log2_x = hn::Add(e, hn::MulAdd(f, hn::Set(d, kLog2e), curvature));
    const auto n = hn::Round(hn::Mul(log2_x, vy));
    auto r = hn::MulSub(hn::Set(d, y_hi), e, n);
    r = hn::MulAdd(hn::Set(d, slope_hi), f, r);
    r = hn::MulAdd(vy, curvature, r);
    r = hn::Add(r, hn::MulAdd(slope_lo, f, hn::Mul(y_lo, e)));
    return scale(d, exp2_fraction(d, r), n);
}

// ---------------------------------------------------------------------------------------------
// Double

/// 2^x; 2^-58.
template <class D>
HWY_INLINE Vec<D> exp2_double(D d, Vec<D> x) {
    const auto limit = hn::Set(d, 2000.0);
    x = hn::Min(hn::Max(x, hn::Neg(limit)), limit);
    const auto n = hn::Round(x);
    const auto r = hn::Sub(x, n);
    const auto p = horner(d, r, 0.6931471805599453, 0.2402265069591013, 0.05550410866482009,
                          0.009618129107594187, 0.0013333558146773998, 0.00015403530457037794,
                          1.5252733493437096e-05, 1.3215435315483844e-06, 1.0178199518826279e-07,
                          7.073778059560721e-09, 4.4347715552879237e-10);
    return scale(d, hn::MulAdd(p, r, hn::Set(d, 1.0)), n);
}

/// log2(1 + f) by s = f/(2+f): log2((1+s)/(1-s)); 2^-62.
template <class D>
HWY_INLINE Vec<D> log2_fraction_double(D d, Vec<D> f) {
    const auto s = hn::Div(f, hn::Add(f, hn::Set(d, 2.0)));
    const auto z = hn::Mul(s, s);
    const auto p = horner(d, z, 0.9617966939259746, 0.5770780163563926, 0.4121985828886401,
                          0.32059892760850184, 0.26230600942494436, 0.222046238639155,
                          0.19006442778763416, 0.19964825707152564);
    return hn::MulAdd(hn::Mul(s, z), p, hn::Mul(s, hn::Set(d, 2.8853900817779268)));
}

/// log2(x); -inf for x <= 0.
template <class D>
HWY_INLINE Vec<D> log2_double(D d, Vec<D> x) {
    auto e = hn::Undefined(d);
    auto f = hn::Undefined(d);
    split(d, x, e, f);
    const auto result = hn::Add(e, log2_fraction_double(d, f));
    return hn::IfThenElse(hn::Gt(x, hn::Zero(d)), result,
                          hn::Set(d, -std::numeric_limits<double>::infinity()));
}

/// a^b for a > 0.
template <class D>
HWY_INLINE Vec<D> power_double(D d, Vec<D> a, Vec<D> b) {
    auto e = hn::Undefined(d);
    auto f = hn::Undefined(d);
    split(d, a, e, f);
    return exp2_double(d, hn::Mul(b, hn::Add(e, log2_fraction_double(d, f))));
}

/// Float a^b for a > 0, with the logarithm in double: for exponents of any size. DF has as many
/// lanes as D.
template <class D, class DF = hn::Rebind<float, D>>
HWY_INLINE Vec<DF> power_float(D d, Vec<DF> a, Vec<D> b) {
    const DF df;
    auto e = hn::Undefined(df);
    auto f = hn::Undefined(df);
    split(df, a, e, f);
    const auto wide = hn::PromoteTo(d, f);
    // log2(1+f)/f; 2^-33.
    const auto q = horner(d, wide, 1.4426950409945543, -0.7213475168566406, 0.48089828222624775,
                          -0.360674359271077, 0.28854602343192026, -0.24042822178704773,
                          0.20582040034720844, -0.18031455716572908, 0.1646569515665286,
                          -0.15287069733099928, 0.1155046890543786, -0.044955420614352516);
    auto p = hn::Mul(hn::MulAdd(q, wide, hn::PromoteTo(d, e)), b);
    const auto limit = hn::Set(d, 250.0);
    p = hn::Min(hn::Max(p, hn::Neg(limit)), limit);
    const auto n = hn::Round(p);
    const auto r = hn::DemoteTo(df, hn::Sub(p, n));
    return scale(df, exp2_fraction(df, r), hn::DemoteTo(df, n));
}

/// What a^b is where a is not positive, given |a|^b.
template <class D>
HWY_INLINE Vec<D> power_of_any(D d, Vec<D> a, Vec<D> b, Vec<D> magnitude) {
    using T = hn::TFromD<D>;
    const auto zero = hn::Zero(d);
    const auto inf = hn::Set(d, std::numeric_limits<T>::infinity());
    const auto nan = hn::Set(d, std::numeric_limits<T>::quiet_NaN());
    const auto half = hn::Mul(b, hn::Set(d, static_cast<T>(0.5)));
    const auto is_whole = hn::Eq(hn::Floor(b), b);
    const auto is_even = hn::Eq(hn::Floor(half), half);
    const auto of_zero = hn::IfThenElse(hn::Gt(b, zero), zero, inf);
    const auto of_negative =
        hn::IfThenElse(is_whole, hn::IfThenElse(is_even, magnitude, hn::Neg(magnitude)), nan);
    const auto not_positive = hn::IfThenElse(hn::Eq(a, zero), of_zero, of_negative);
    const auto result = hn::IfThenElse(hn::Gt(a, zero), magnitude, not_positive);
    return hn::IfThenElse(hn::Eq(b, zero), hn::Set(d, static_cast<T>(1)), result);
}

/// The same for one b that is not whole. Below 0 there is no value: 0 for b > 0, infinity for b <
/// 0.
template <class D>
HWY_INLINE Vec<D> power_of_any(D d, Vec<D> a, hn::TFromD<D> b, Vec<D> magnitude) {
    const auto is_positive = hn::Gt(a, hn::Zero(d));
    if (b > 0) return hn::IfThenElseZero(is_positive, magnitude);
    const auto inf = hn::Set(d, std::numeric_limits<hn::TFromD<D>>::infinity());
    return hn::IfThenElse(is_positive, magnitude, inf);
}

/// x - q pi/2 in [-pi/4, pi/4]. The products with the first two parts of pi/2 (33 bits each) are
/// exact without fused multiply-add, too, for |x| up to 1e6.
template <class D>
HWY_INLINE Vec<D> reduce_quarter_turns(D d, Vec<D> x, Vec<D>& q) {
    q = hn::Round(hn::Mul(x, hn::Set(d, 0.63661977236758134)));
    auto r = hn::NegMulAdd(q, hn::Set(d, 0x1.921fb54400000p+0), x);
    r = hn::NegMulAdd(q, hn::Set(d, 0x1.0b4611a600000p-34), r);
    return hn::NegMulAdd(q, hn::Set(d, 0x1.3198a2e037073p-69), r);
}

/// sin(r + q pi/2); sine 2^-58, cosine 2^-64.
template <class D>
HWY_INLINE Vec<D> sine_of_quarters(D d, Vec<D> r, Vec<D> q) {
    const auto z = hn::Mul(r, r);
    const auto one = hn::Set(d, 1.0);
    const auto s = horner(d, z, -0.16666666666666632, 0.008333333333322424, -0.000198412698298164,
                          2.755731369505473e-06, -2.5050758628425347e-08, 1.5896826572922353e-10);
    const auto c = horner(d, z, 0.041666666666666595, -0.0013888888888873056, 2.480158728885139e-05,
                          -2.7557314179215933e-07, 2.0875700831894906e-09, -1.1358536030488525e-11);
    const auto sine = hn::MulAdd(hn::Mul(r, z), s, r);
    const auto cosine = hn::MulAdd(hn::Mul(z, z), c, hn::NegMulAdd(z, hn::Set(d, 0.5), one));
    const auto half = hn::Mul(q, hn::Set(d, 0.5));
    const auto even = hn::Eq(hn::Floor(half), half);
    const auto value = hn::IfThenElse(even, sine, cosine);
    // Quarters 2 and 3 (of 0..3) are upside down.
    const auto quarter = hn::NegMulAdd(hn::Floor(hn::Mul(q, hn::Set(d, 0.25))), hn::Set(d, 4.0), q);
    return hn::IfThenElse(hn::Lt(quarter, hn::Set(d, 2.0)), value, hn::Neg(value));
}

template <class D>
HWY_INLINE Vec<D> sine_double(D d, Vec<D> x) {
    auto q = hn::Undefined(d);
    const auto r = reduce_quarter_turns(d, x, q);
    return sine_of_quarters(d, r, q);
}

template <class D>
HWY_INLINE Vec<D> cosine_double(D d, Vec<D> x) {
    auto q = hn::Undefined(d);
    const auto r = reduce_quarter_turns(d, x, q);
    return sine_of_quarters(d, r, hn::Add(q, hn::Set(d, 1.0)));
}

template <class D>
HWY_INLINE Vec<D> atan2_double(D d, Vec<D> y, Vec<D> x) {
    const auto zero = hn::Zero(d);
    const auto one = hn::Set(d, 1.0);
    const auto ax = hn::Abs(x);
    const auto ay = hn::Abs(y);
    const auto small = hn::Min(ax, ay);
    const auto large = hn::Max(ax, ay);
    // atan of small/large in [0, 1]; above tan(pi/8) by atan(t) = pi/4 + atan((t-1)/(t+1)).
    const auto far = hn::Gt(small, hn::Mul(large, hn::Set(d, 0.41421356237309503)));
    const auto top = hn::IfThenElse(far, hn::Sub(small, large), small);
    const auto bottom = hn::IfThenElse(far, hn::Add(small, large), large);
    const auto t = hn::IfThenElseZero(hn::Gt(large, zero), hn::Div(top, bottom));
    const auto z = hn::Mul(t, t);
    // 2^-64
    const auto p = horner(d, z, -0.33333333333333326, 0.19999999999997692, -0.14285714285390944,
                          0.11111111088362774, -0.09090908151259271, 0.07692282911857598,
                          -0.06666229031771803, 0.058770441703819475, -0.05218548969052191,
                          0.045041393781768635, -0.033488235462723365, 0.015209188612267548);
    auto angle = hn::MulAdd(hn::Mul(t, z), p, t);
    angle = hn::Add(angle, hn::IfThenElseZero(far, hn::Set(d, 0.78539816339744831)));
    angle = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(hn::Set(d, 1.5707963267948966), angle), angle);
    const auto left = hn::Lt(hn::CopySign(one, x), zero);  // -0 is left, too
    angle = hn::IfThenElse(left, hn::Sub(hn::Set(d, 3.1415926535897931), angle), angle);
    return hn::CopySign(angle, y);
}

// ---------------------------------------------------------------------------------------------
// Tables

/// Samples of a table at x; what Table::operator() does.
template <class D>
HWY_INLINE Vec<D> lookup_linear(D d, Vec<D> x, const hn::TFromD<D>* samples, std::size_t count) {
    using T = hn::TFromD<D>;
    const hn::RebindToSigned<D> di;
    const auto zero = hn::Zero(d);
    // NaN -> 0: the comparison fails.
    const auto t = hn::Min(hn::IfThenElseZero(hn::Gt(x, zero), x), hn::Set(d, static_cast<T>(1)));
    const auto last = static_cast<T>(count > 1 ? count - 2 : 0);
    const auto position = hn::Mul(t, hn::Set(d, static_cast<T>(count - 1)));
    const auto cell = hn::Min(hn::Floor(position), hn::Set(d, last));
    const auto index = hn::ConvertTo(di, cell);
    const auto a = hn::GatherIndex(d, samples, index);
    const auto b = hn::GatherIndex(d, samples + (count > 1 ? 1 : 0), index);
    return hn::MulAdd(hn::Sub(position, cell), hn::Sub(b, a), a);
}

template <class D>
HWY_INLINE Vec<D> lookup_step(D d, Vec<D> x, const hn::TFromD<D>* samples, std::size_t count) {
    using T = hn::TFromD<D>;
    const hn::RebindToSigned<D> di;
    const auto zero = hn::Zero(d);
    const auto t = hn::Min(hn::IfThenElseZero(hn::Gt(x, zero), x), hn::Set(d, static_cast<T>(1)));
    const auto cell = hn::Min(hn::Floor(hn::Mul(t, hn::Set(d, static_cast<T>(count)))),
                              hn::Set(d, static_cast<T>(count - 1)));
    return hn::GatherIndex(d, samples, hn::ConvertTo(di, cell));
}

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace HWY_NAMESPACE
}  // namespace simd
TONEWRIGHT_NAMESPACE_END
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
