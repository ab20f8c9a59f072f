// SPDX-License-Identifier: Apache-2.0
//
// The mathematics of the SIMD engine, written once. Two files include it into a namespace of their
// own: simd_kernels.cpp, where it runs on Highway's vectors, once for each instruction set, and
// vector_code.cpp, where the same functions write machine code. Therefore both compute the same
// bits. The file that includes it provides
//   - `hn`: the functions of Highway that the text calls;
//   - HWY_INLINE and HWY_ATTR, and kHasFma: products and sums can be rounded once;
//   - Doubles: as many doubles as a vector has floats, in kHalves vectors; promote(), demote();
//   - double_tag(), bits_tag(): Highway's tags for doubles and for the bits of a number;
//   - has_minus(): numbers with a sign, -0 too;
//   - functions that read tables and 3D LUTs, because they depend most on the processor.
//
// Coefficients are minimax polynomials (Remez exchange, 50 digits); the error beside each is that
// of the polynomial alone. tests/unit/engine/simd_program_test.cpp holds the functions to the
// bounds stated.

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class D>
using Vec = hn::Vec<D>;
template <class D>
using Number = hn::TFromD<D>;
template <class D>
inline constexpr bool kIsDouble = sizeof(Number<D>) == sizeof(double);

/// A vector filled with a number, which is rounded to its type.
template <class D>
HWY_INLINE Vec<D> set(D d, double value) {
    return hn::Set(d, static_cast<Number<D>>(value));
}

/// c0 + x (c1 + x (c2 + ...)).
template <class D>
HWY_INLINE Vec<D> horner(D d, Vec<D> /*x*/, double c0) {
    return set(d, c0);
}
template <class D, class... C>
HWY_INLINE Vec<D> horner(D d, Vec<D> x, double c0, C... c) {
    return hn::MulAdd(horner(d, x, c...), x, set(d, c0));
}

/// horner() with even and odd powers apart: a shorter chain of dependent operations.
template <class D, class... C>
HWY_INLINE Vec<D> even_odd(D d, Vec<D> x, C... c) {
    constexpr int n = sizeof...(C);
    const double coefficient[n] = {c...};
    const auto z = hn::Mul(x, x);
    Vec<D> sum[2];
    for (int k = n - 1; k >= 0; --k) {
        const auto here = set(d, coefficient[k]);
        sum[k % 2] = k < n - 2 ? hn::MulAdd(sum[k % 2], z, here) : here;
    }
    return hn::MulAdd(sum[1], x, sum[0]);
}

/// Limits x to +-limit. NaN becomes -limit.
template <class D>
HWY_INLINE Vec<D> limited(D d, Vec<D> x, double limit) {
    return hn::Min(hn::Max(x, set(d, -limit)), set(d, limit));
}

/// Replaces NaN by 0.
template <class D>
HWY_INLINE Vec<D> without_nan(D /*d*/, Vec<D> x) {
    return hn::IfThenElseZero(hn::Eq(x, x), x);
}

/// Replaces NaN by 0, then limits x to +-65504.
template <class D>
HWY_INLINE Vec<D> sanitized(D d, Vec<D> x) {
    return limited(d, without_nan(d, x), static_cast<double>(kLargestInput));
}

// Min and Max of the processor return their second operand if the operands are equal or not
// ordered. With the operands in this order, they compute b < a ? b : a, as expressions do.
template <class V>
HWY_INLINE V minimum(V a, V b) {
    return hn::Min(b, a);
}
template <class V>
HWY_INLINE V maximum(V a, V b) {
    return hn::Max(b, a);
}

/// 1 for true and 0 for false: the result of comparisons in expressions.
template <class D, class M>
HWY_INLINE Vec<D> one_where(D d, M mask) {
    return hn::IfThenElseZero(mask, set(d, 1));
}

/// k0 a + k1 b + k2 c.
template <class D>
HWY_INLINE Vec<D> dot3(D d, const double* k, Vec<D> a, Vec<D> b, Vec<D> c) {
    return hn::MulAdd(set(d, k[2]), c, hn::MulAdd(set(d, k[1]), b, hn::Mul(set(d, k[0]), a)));
}

// ---------------------------------------------------------------------------------------------
// Exponents: x = 2^e (1 + f) with 1 + f in [3/4, 3/2) for finite x > 0, and x * 2^n for whole n;
// with denormal floats, but without denormal doubles, which no float becomes.

/// @param is_normal  true: x is no denormal
template <class D>
HWY_INLINE void split(D d, Vec<D> x, Vec<D>& e, Vec<D>& f, bool is_normal) {
    const auto tag = bits_tag(d);
    if constexpr (kIsDouble<D>) {
        constexpr std::uint64_t kThreeQuarters = 0x3FE8000000000000;
        constexpr std::uint64_t kBias = 0x3FF0000000000000;  // keeps the difference positive
        const auto bits = hn::Add(hn::BitCast(tag, x), hn::Set(tag, kBias - kThreeQuarters));
        const auto fraction = hn::And(bits, hn::Set(tag, std::uint64_t{0x000FFFFFFFFFFFFF}));
        // 64-bit integers are converted by way of the low bits of 2^52 + n: below AVX-512 there is
        // no instruction.
        const auto whole =
            hn::Or(hn::ShiftRight<52>(bits), hn::Set(tag, std::uint64_t{0x4330000000000000}));
        e = hn::Sub(hn::BitCast(d, whole), set(d, 0x1p52 + 1023));
        f = hn::Sub(hn::BitCast(d, hn::Add(fraction, hn::Set(tag, kThreeQuarters))), set(d, 1));
    } else {
        auto normal = x;
        auto lost = hn::Zero(d);
        if (!is_normal) {
            const auto denormal = hn::Lt(x, hn::Set(d, std::numeric_limits<float>::min()));
            normal = hn::IfThenElse(denormal, hn::Mul(x, set(d, 0x1p24)), x);
            lost = hn::IfThenElseZero(denormal, set(d, 24));
        }
        constexpr std::int32_t kThreeQuarters = 0x3F400000;
        const auto bits = hn::Sub(hn::BitCast(tag, normal), hn::Set(tag, kThreeQuarters));
        const auto fraction = hn::And(bits, hn::Set(tag, std::int32_t{0x007FFFFF}));
        e = hn::ConvertTo(d, hn::ShiftRight<23>(bits));
        if (!is_normal) e = hn::Sub(e, lost);
        f = hn::Sub(hn::BitCast(d, hn::Add(fraction, hn::Set(tag, kThreeQuarters))), set(d, 1));
    }
}

/// Beyond these powers of two every float is 0 or infinity.
template <class D>
inline constexpr double kLargestExponent = kIsDouble<D> ? 1022 : 250;
/// Bound of the logarithm of a positive number.
template <class D>
inline constexpr double kLargestLog2 = kIsDouble<D> ? 1024 : 150;

/// x * 2^n.
/// @param largest  bound of |n|; if it is above kLargestExponent, n is limited to that
template <class D>
HWY_INLINE Vec<D> scale(D d, Vec<D> x, Vec<D> n, double largest) {
    if (largest > kLargestExponent<D>) n = limited(d, n, kLargestExponent<D>);
    const auto tag = bits_tag(d);
    if constexpr (kIsDouble<D>) {
        const auto whole = hn::BitCast(tag, hn::Add(n, set(d, 0x1p52 + 1023)));
        return hn::Mul(x, hn::BitCast(d, hn::ShiftLeft<52>(whole)));
    } else {
        const auto power_of_two = [d, tag](auto k) HWY_ATTR {
            const auto biased = hn::Add(k, hn::Set(tag, std::int32_t{127}));
            return hn::BitCast(d, hn::ShiftLeft<23>(biased));
        };
        const auto whole = hn::ConvertTo(tag, n);
        constexpr double kLargestNormal = 126;
        if (largest <= kLargestNormal) return hn::Mul(x, power_of_two(whole));
        // Two factors, so that results outside the normal numbers are rounded once, or reach 0 or
        // infinity.
        const auto half = hn::ShiftRight<1>(whole);
        return hn::Mul(hn::Mul(x, power_of_two(half)), power_of_two(hn::Sub(whole, half)));
    }
}

// ---------------------------------------------------------------------------------------------
// Exponential, logarithm

// Polynomials in double are as exact as a result that becomes a float needs, not as doubles are.

/// 2^r for r in [-1/2, 1/2]; 2^-28.9 in float, 2^-45.9 in double.
template <class D>
HWY_INLINE Vec<D> exp2_fraction(D d, Vec<D> r) {
    if constexpr (kIsDouble<D>) {
        const auto p =
            even_odd(d, r, 0.6931471805598851, 0.24022650695722841, 0.05550410866841757,
                     0.009618129181160442, 0.0013333557625206589, 0.00015403440885993974,
                     1.525299014348045e-05, 1.325833521451359e-06, 1.0148320507441935e-07);
        return hn::MulAdd(p, r, set(d, 1));
    } else {
        const auto p = horner(d, r, 0.6931471824645996, 0.24022647738456726, 0.055503327399492264,
                              0.00961843691766262, 0.001339884358458221, 0.00015353347407653928);
        return hn::MulAdd(p, r, set(d, 1));
    }
}

/// 2^x.
/// @param largest  bound of |x|
template <class D>
HWY_INLINE Vec<D> exp2(D d, Vec<D> x, double largest = kInfinity) {
    if (largest > kLargestExponent<D>) {
        largest = kLargestExponent<D>;
        x = limited(d, x, largest);
    }
    const auto n = hn::Round(x);
    return scale(d, exp2_fraction(d, hn::Sub(x, n)), n, largest);
}

/// 1/ln 2, rounded to float.
inline constexpr double kLog2e = 1.4426950216293335;

/// log2(1 + f) - kLog2e f for 1 + f in [3/4, 3/2), in float; 2^-27.8 of the logarithm.
template <class D>
HWY_INLINE Vec<D> log2_curvature(D d, Vec<D> f) {
    // The first coefficient adds the part of 1/ln 2 that kLog2e lacks.
    const auto q =
        even_odd(d, f, 1.327158027919495e-08, -0.7213475108146667, 0.48090076446533203,
                 -0.3606748580932617, 0.2883840501308441, -0.24014823138713837, 0.2091008722782135,
                 -0.19027815759181976, 0.15066714584827423, -0.06434474885463715);
    return hn::Mul(f, q);
}

/// log2(x) for x > 0 in double by s = f/(2+f): log2((1+s)/(1-s)); 2^-49.
template <class D>
HWY_INLINE Vec<D> log2_double(D d, Vec<D> x) {
    Vec<D> e, f;
    split(d, x, e, f, true);
    const auto s = hn::Div(f, hn::Add(f, set(d, 2)));
    const auto p =
        even_odd(d, hn::Mul(s, s), 2.8853900817779268, 0.961796693918524, 0.5770780199671594,
                 0.41219800183780014, 0.32064179500391204, 0.2607156537296817, 0.25067507324819643);
    return hn::MulAdd(s, p, e);
}

/// log2(x); -inf for x <= 0. It runs in float only if sums and products can be rounded once: below
/// 3/4 the exponent is -1, and most of it cancels.
/// @param is_positive  see Instruction
template <class D>
HWY_INLINE Vec<D> log2(D d, Vec<D> x, bool is_positive) {
    Vec<D> result;
    if constexpr (kIsDouble<D>) {
        result = log2_double(d, x);
    } else {
        Vec<D> e, f;
        split(d, x, e, f, is_positive);
        result = hn::Add(hn::MulAdd(f, set(d, kLog2e), e), log2_curvature(d, f));
    }
    if (is_positive) return result;
    return hn::IfThenElse(hn::Gt(x, hn::Zero(d)), result, set(d, -kInfinity));
}

// ---------------------------------------------------------------------------------------------
// Powers

/// a^b in double for a > 0.
/// @param largest  bound of |b|
template <class D>
HWY_INLINE Vec<D> power_double(D d, Vec<D> a, Vec<D> b, double largest = kInfinity) {
    return exp2(d, hn::Mul(b, log2_double(d, a)), largest * kLargestLog2<D>);
}

/// a^b in float for a > 0, with the logarithm in double: for exponents of any size.
template <class D>
HWY_INLINE Vec<D> power_float(D d, Vec<D> a, const Doubles& b, bool is_normal) {
    const auto dd = double_tag(d);
    Vec<D> e, f;
    split(d, a, e, f, is_normal);
    Doubles whole, rest;
    for (int h = 0; h < kHalves; ++h) {
        const auto wide = promote(f, h);
        // log2(1+f)/f; 2^-33.
        const auto q =
            horner(dd, wide, 1.4426950409945543, -0.7213475168566406, 0.48089828222624775,
                   -0.360674359271077, 0.28854602343192026, -0.24042822178704773,
                   0.20582040034720844, -0.18031455716572908, 0.1646569515665286,
                   -0.15287069733099928, 0.1155046890543786, -0.044955420614352516);
        const auto p = limited(dd, hn::Mul(hn::MulAdd(q, wide, promote(e, h)), b.half[h]),
                               kLargestExponent<D>);
        whole.half[h] = hn::Round(p);
        rest.half[h] = hn::Sub(p, whole.half[h]);
    }
    return scale(d, exp2_fraction(d, demote(rest)), demote(whole), kLargestExponent<D>);
}

/// a^b for any a, given |a|^b.
template <class D>
HWY_INLINE Vec<D> power_of_any(D d, Vec<D> a, Vec<D> b, Vec<D> magnitude) {
    const auto zero = hn::Zero(d);
    const auto half = hn::Mul(b, set(d, 0.5));
    const auto is_even = hn::Eq(hn::Floor(half), half);
    const auto of_whole = hn::IfThenElse(is_even, magnitude, hn::Neg(magnitude));
    const auto nan = set(d, std::numeric_limits<double>::quiet_NaN());
    const auto of_negative = hn::IfThenElse(hn::Eq(hn::Floor(b), b), of_whole, nan);
    const auto of_zero = hn::IfThenElse(hn::Gt(b, zero), zero, set(d, kInfinity));
    const auto not_positive = hn::IfThenElse(hn::Eq(a, zero), of_zero, of_negative);
    const auto result = hn::IfThenElse(hn::Gt(a, zero), magnitude, not_positive);
    return hn::IfThenElse(hn::Eq(b, zero), set(d, 1), result);
}

/// a^b for any a and one b that is no integer, given |a|^b. For a < 0 there is no value: the result
/// is 0 for b > 0 and infinity for b < 0.
/// @param is_positive  see Instruction
template <class D>
HWY_INLINE Vec<D> power_of_any(D d, Vec<D> a, double b, Vec<D> magnitude, bool is_positive) {
    if (is_positive) return magnitude;
    const auto is_above = hn::Gt(a, hn::Zero(d));
    if (b > 0) return hn::IfThenElseZero(is_above, magnitude);
    return hn::IfThenElse(is_above, magnitude, set(d, kInfinity));
}

/// Largest exponent for which power_near() keeps to 2 ulp. It depends on the rounding of products.
inline constexpr double kNearPower = kHasFma ? 4 : 1;

/// x^y in float for one y that is no integer, |y| <= kNearPower. The product of y and the exponent
/// of x is exact (y in two parts, the first of 11 bits). The rest is small, and so is its float
/// error.
template <class D>
HWY_INLINE Vec<D> power_near(D d, Vec<D> x, double y, bool is_positive) {
    const double y_hi = static_cast<double>(static_cast<std::int32_t>(y * 512)) / 512;
    const double slope = y * kLog2e;
    const auto slope_hi = static_cast<double>(static_cast<float>(slope));
    const auto vy = set(d, y);
    Vec<D> e, f;
    split(d, x, e, f, is_positive);
    const auto curvature = log2_curvature(d, f);
    const auto log2_x = hn::Add(e, hn::MulAdd(f, set(d, kLog2e), curvature));
    const auto n = hn::Round(hn::Mul(log2_x, vy));
    auto r = hn::MulSub(set(d, y_hi), e, n);
    r = hn::MulAdd(set(d, slope_hi), f, r);
    r = hn::MulAdd(vy, curvature, r);
    r = hn::Add(r, hn::MulAdd(set(d, slope - slope_hi), f, hn::Mul(set(d, y - y_hi), e)));
    const double largest = std::fabs(y) * kLargestLog2<D>;
    return power_of_any(d, x, y, scale(d, exp2_fraction(d, r), n, largest), is_positive);
}

/// a^b.
template <class D>
HWY_INLINE Vec<D> power(D d, Vec<D> a, Vec<D> b) {
    if constexpr (kIsDouble<D>) {
        return power_of_any(d, a, b, power_double(d, hn::Abs(a), b));
    } else {
        Doubles wide;
        for (int h = 0; h < kHalves; ++h)
            wide.half[h] = promote(b, h);
        return power_of_any(d, a, b, power_float(d, hn::Abs(a), wide, false));
    }
}

/// a^b for one b that is no integer. In float for |b| > kNearPower, see computed_by().
template <class D>
HWY_INLINE Vec<D> power(D d, Vec<D> a, double b, bool is_positive) {
    if constexpr (kIsDouble<D>) {
        const auto magnitude = power_double(d, a, set(d, b), std::fabs(b));
        return power_of_any(d, a, b, magnitude, is_positive);
    } else {
        Doubles wide;
        for (int h = 0; h < kHalves; ++h)
            wide.half[h] = set(double_tag(d), b);
        return power_of_any(d, a, b, power_float(d, a, wide, is_positive), is_positive);
    }
}

// ---------------------------------------------------------------------------------------------
// Angles, in double

/// x - q pi/2 in [-pi/4, pi/4]. The products with the first two parts of pi/2 (33 bits each) are
/// exact without fused multiply-add, too, for |x| up to 1e6.
template <class D>
HWY_INLINE Vec<D> reduce_quarter_turns(D d, Vec<D> x, Vec<D>& q) {
    q = hn::Round(hn::Mul(x, set(d, 0.63661977236758134)));
    auto r = hn::NegMulAdd(q, set(d, 0x1.921fb54400000p+0), x);
    r = hn::NegMulAdd(q, set(d, 0x1.0b4611a600000p-34), r);
    return hn::NegMulAdd(q, set(d, 0x1.3198a2e037073p-69), r);
}

/// sin(r + q pi/2); sine 2^-58, cosine 2^-64.
template <class D>
HWY_INLINE Vec<D> sine_of_quarters(D d, Vec<D> r, Vec<D> q) {
    const auto z = hn::Mul(r, r);
    const auto s = horner(d, z, -0.16666666666666632, 0.008333333333322424, -0.000198412698298164,
                          2.755731369505473e-06, -2.5050758628425347e-08, 1.5896826572922353e-10);
    const auto c = horner(d, z, 0.041666666666666595, -0.0013888888888873056, 2.480158728885139e-05,
                          -2.7557314179215933e-07, 2.0875700831894906e-09, -1.1358536030488525e-11);
    const auto sine = hn::MulAdd(hn::Mul(r, z), s, r);
    const auto cosine = hn::MulAdd(hn::Mul(z, z), c, hn::NegMulAdd(z, set(d, 0.5), set(d, 1)));
    const auto half = hn::Mul(q, set(d, 0.5));
    const auto even = hn::Eq(hn::Floor(half), half);
    const auto value = hn::IfThenElse(even, sine, cosine);
    // Sine and cosine are negated in quarters 2 and 3 (of 0..3).
    const auto quarter = hn::NegMulAdd(hn::Floor(hn::Mul(q, set(d, 0.25))), set(d, 4), q);
    return hn::IfThenElse(hn::Lt(quarter, set(d, 2)), value, hn::Neg(value));
}

/// sin(x + q pi/2) for whole q.
template <class D>
HWY_INLINE Vec<D> sine(D d, Vec<D> x, double quarters) {
    Vec<D> q;
    const auto r = reduce_quarter_turns(d, x, q);
    return sine_of_quarters(d, r, hn::Add(q, set(d, quarters)));
}

template <class D>
HWY_INLINE Vec<D> atan2(D d, Vec<D> y, Vec<D> x) {
    const auto ax = hn::Abs(x);
    const auto ay = hn::Abs(y);
    const auto small = hn::Min(ax, ay);
    const auto large = hn::Max(ax, ay);
    // atan of small/large in [0, 1]; above tan(pi/8) by atan(t) = pi/4 + atan((t-1)/(t+1)).
    const auto far = hn::Gt(small, hn::Mul(large, set(d, 0.41421356237309503)));
    const auto top = hn::IfThenElse(far, hn::Sub(small, large), small);
    const auto bottom = hn::IfThenElse(far, hn::Add(small, large), large);
    const auto t = hn::IfThenElseZero(hn::Gt(large, hn::Zero(d)), hn::Div(top, bottom));
    const auto z = hn::Mul(t, t);
    // 2^-45
    const auto p = even_odd(d, z, -0.3333333333169734, 0.1999999968563621, -0.14285693596719518,
                            0.1111045000392336, -0.09079137962146798, 0.07568543311754397,
                            -0.058910736472696804, 0.030894979008270294);
    auto angle = hn::MulAdd(hn::Mul(t, z), p, t);
    angle = hn::Add(angle, hn::IfThenElseZero(far, set(d, 0.78539816339744831)));
    angle = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(set(d, 1.5707963267948966), angle), angle);
    angle = hn::IfThenElse(has_minus(d, x), hn::Sub(set(d, 3.1415926535897931), angle), angle);
    return hn::CopySign(angle, y);
}

// ---------------------------------------------------------------------------------------------
// Tables and 3D LUTs. places(cell) converts cells to indices for gather(), and gather(d, samples,
// first, places) reads samples[first + place].

/// A row of four or eight adjacent numbers for each pixel.
template <class D, class I>
struct GatheredRows {
    D d;
    std::span<const Number<D>> numbers;
    I place;

    /// Reads the first four numbers of each row as four vectors, or the second four.
    HWY_INLINE void columns(std::size_t group, Vec<D>* result) const {
        for (std::size_t k = 0; k < 4; ++k)
            result[k] = gather(d, numbers, 4 * group + k, place);
    }
};
/// Processors that load a row faster have another function of this name.
/// @param place  index of the first number of the row
template <class D, class I>
HWY_INLINE GatheredRows<D, I> rows_at(D d, std::span<const Number<D>> numbers, I place,
                                      int /*length*/) {
    return {d, numbers, place};
}

/// Lookup in samples at equal distances over [0, 1], as in Table::operator().
template <class D>
HWY_INLINE Vec<D> lookup(D d, Vec<D> x, const SampledTable& table) {
    const auto samples = table.samples.of<Number<D>>();
    const auto count = static_cast<double>(samples.size());
    // NaN becomes 0, because the comparison fails.
    const auto t = hn::Min(hn::IfThenElseZero(hn::Gt(x, hn::Zero(d)), x), set(d, 1));
    if (table.interpolation != Table::Interpolation::linear) {
        const auto cell = hn::Min(hn::Floor(hn::Mul(t, set(d, count))), set(d, count - 1));
        return gather(d, samples, 0, places(cell));
    }
    const auto position = hn::Mul(t, set(d, count - 1));
    const auto cell = hn::Min(hn::Floor(position), set(d, count > 1 ? count - 2 : 0));
    const auto place = places(cell);
    const auto a = gather(d, samples, 0, place);
    const auto b = gather(d, samples, count > 1 ? 1 : 0, place);
    return hn::MulAdd(hn::Sub(position, cell), hn::Sub(b, a), a);
}

/// Lookup in samples at given positions.
template <class D>
HWY_INLINE void lookup_nonuniform(D d, Vec<D> x, const NonuniformTables& tables, Vec<D>* result) {
    const auto begin = tables.begin.of<Number<D>>();
    const auto first = hn::Set(d, begin[0]);
    const auto last = hn::Set(d, begin[tables.cells - 1]);
    // NaN becomes the first position, because the comparison fails.
    const auto t = hn::Min(hn::IfThenElse(hn::Gt(x, first), x, first), last);
    const auto part = hn::Mul(hn::Sub(t, first), set(d, tables.parts_per_unit));
    auto cell = gather(d, tables.first_cell.of<Number<D>>(), 0, places(part));
    for (std::int32_t half = tables.half_of_most; half > 0; half /= 2) {
        const auto next = gather(d, begin, static_cast<std::size_t>(half), places(cell));
        cell = hn::Add(cell, hn::IfThenElseZero(hn::Ge(t, next), set(d, half)));
    }
    const auto place = places(hn::Mul(cell, set(d, tables.length)));
    auto rows = rows_at(d, tables.rows.of<Number<D>>(), place, tables.length);
    Vec<D> k[8];
    rows.columns(0, k);
    if (tables.length == 8) rows.columns(1, k + 4);
    const auto distance = hn::Sub(t, k[0]);
    for (int i = 0; i < (tables.length == 8 ? 3 : 1); ++i)
        result[i] = hn::MulAdd(k[2 * i + 2], distance, k[2 * i + 1]);
}

/// Tetrahedral interpolation.
template <class D>
HWY_INLINE void interpolate(D d, const Vec<D>* given, const SampledGrid& grid, Vec<D>* result) {
    const double edge = grid.edge;
    Vec<D> cell[3], f[3];
    for (int c = 0; c < 3; ++c) {
        const auto t = hn::Min(hn::Max(given[c], hn::Zero(d)), set(d, 1));
        const auto place = hn::Mul(t, set(d, edge - 1));
        cell[c] = hn::Min(hn::Floor(place), set(d, edge - 2));
        f[c] = hn::Sub(place, cell[c]);
    }
    // Numbers from one node to the next. Four times integers below 2^24 are exact in float, and so
    // are their sums.
    const auto n0 = set(d, 4);
    const auto n1 = set(d, 4 * edge);
    const auto n2 = set(d, 4 * edge * edge);
    const auto corner = hn::MulAdd(cell[0], n2, hn::MulAdd(cell[1], n1, hn::Mul(cell[2], n0)));
    // Steps of the axes with the largest and the smallest fraction.
    const auto red_below_green = hn::Lt(f[0], f[1]);
    const auto upper = hn::Max(f[0], f[1]);
    const auto lower = hn::Min(f[0], f[1]);
    const auto step_upper = hn::IfThenElse(red_below_green, n1, n2);
    const auto step_lower = hn::IfThenElse(red_below_green, n2, n1);
    const auto step_highest = hn::IfThenElse(hn::Lt(upper, f[2]), n0, step_upper);
    const auto step_lowest = hn::IfThenElse(hn::Lt(lower, f[2]), step_lower, n0);
    const auto highest = hn::Max(upper, f[2]);
    const auto lowest = hn::Min(lower, f[2]);
    const auto middle = hn::Max(lower, hn::Min(upper, f[2]));
    const auto far = hn::Add(corner, set(d, 4 * (edge * edge + edge + 1)));
    const Vec<D> place[4] = {corner, hn::Add(corner, step_highest), hn::Sub(far, step_lowest), far};
    const Vec<D> weight[4] = {hn::Sub(set(d, 1), highest), hn::Sub(highest, middle),
                              hn::Sub(middle, lowest), lowest};
    for (int k = 0; k < 4; ++k) {
        Vec<D> node[4];
        rows_at(d, grid.nodes.of<Number<D>>(), places(place[k]), 4).columns(0, node);
        for (int c = 0; c < 3; ++c)
            result[c] =
                k == 0 ? hn::Mul(weight[k], node[c]) : hn::MulAdd(weight[k], node[c], result[c]);
    }
}

// ---------------------------------------------------------------------------------------------
// Compiled curves (compiled_curve.h)

/// Ends of a curve as vectors, which are loaded once: the compiler assumes that the stores of a
/// kernel may change the curve.
template <class D>
struct CurveEnds {
    Vec<D> lo, hi, least, most, at_lo, rest_at_lo;

    HWY_INLINE CurveEnds(D d, const CompiledCurve& curve)
        : lo(set(d, static_cast<double>(curve.lo))),
          hi(set(d, static_cast<double>(curve.hi))),
          least(set(d, static_cast<double>(curve.least))),
          most(set(d, static_cast<double>(curve.most))),
          at_lo(set(d, curve.at_lo)),
          rest_at_lo(set(d, curve.at_lo - static_cast<double>(static_cast<float>(curve.at_lo)))) {}

    HWY_INLINE Vec<D> limit(Vec<D> y) const { return hn::Min(hn::Max(y, least), most); }
};

/// A curve's result is y t + first. A precise curve's result is y + first, added in double.
template <class D>
struct Polynomial {
    Vec<D> y, t, first;
};

/// Polynomials of a curve in segments. table(d, numbers, size).at(index) reads numbers[index].
template <class D>
class SegmentPolynomial {
  public:
    HWY_INLINE SegmentPolynomial(D d, const CompiledCurve& curve)
        : curve_(curve),
          threshold_(
              table(d, curve.threshold.data(), curve.cells == 0 ? curve.segments : curve.cells)),
          segment_(table(d, reinterpret_cast<const float*>(curve.segment.data()), curve.cells)),
          scale_(table(d, curve.scale.data(), curve.segments)),
          offset_(table(d, curve.offset.data(), curve.segments)) {}

    /// @param rest  the part of the input that x lacks, because it was rounded to float; null: none
    HWY_INLINE Polynomial<D> operator()(D d, Vec<D> x, const Vec<D>* rest) const {
        const auto index = segment_of(d, x);
        const auto number =
            [&](const std::array<float, CompiledCurve::kMaxSegments>& numbers)
                HWY_ATTR { return table(d, numbers.data(), curve_.segments).at(index); };
        const auto scale = scale_.at(index);
        auto t = hn::MulAdd(x, scale, offset_.at(index));
        if (rest) t = hn::MulAdd(*rest, scale, t);
        auto k = static_cast<std::size_t>(curve_.degree);
        auto y = number(curve_.coefficient[k]);
        while (--k > 0)
            y = hn::MulAdd(y, t, number(curve_.coefficient[k]));
        if (curve_.is_precise) y = hn::MulAdd(y, t, number(curve_.rest));
        return {y, t, number(curve_.coefficient[0])};
    }

  private:
    HWY_INLINE auto segment_of(D d, Vec<D> x) const {
        const auto tag = bits_tag(d);
        if (curve_.cells == 0) {
            // A binary search finds one bit of the index at a time, the highest first.
            auto index = hn::Zero(tag);
            for (int bit = curve_.segments / 2; bit > 0; bit /= 2) {
                const auto next = hn::Or(index, hn::Set(tag, bit));
                const auto is_there = hn::RebindMask(tag, hn::Ge(x, threshold_.at(next)));
                index = hn::IfThenElse(is_there, next, index);
            }
            return index;
        }
        const auto bits = hn::BitCast(tag, hn::Max(x, hn::Set(d, curve_.cell_floor)));
        const auto first = hn::Set(tag, static_cast<std::int32_t>(curve_.first_cell));
        const auto cell = hn::Sub(hn::ShiftRightSame(bits, curve_.shift), first);
        const auto segment = hn::BitCast(tag, segment_.at(cell));
        const auto is_behind = hn::RebindMask(tag, hn::Ge(x, threshold_.at(cell)));
        return hn::IfThenElse(is_behind, hn::Add(segment, hn::Set(tag, 1)), segment);
    }

    const CompiledCurve& curve_;
    decltype(table(D(), nullptr, 0)) threshold_, segment_, scale_, offset_;
};

/// Polynomials of a curve in rows.
template <class D>
class RowPolynomial {
  public:
    HWY_INLINE RowPolynomial(D d, const CurveRows& rows)
        : numbers_(rows.numbers),
          restarts_(rows.restarts),
          base_(float_of(d, rows.base)),
          shift_(rows.shift),
          length_(rows.length),
          // The last `shift` bits of the first float of each cell are 0.
          is_aligned_(restarts_.empty() &&
                      rows.base % (std::uint32_t{1} << static_cast<unsigned>(shift_)) == 0) {}

    /// @param x     at most the curve's end
    /// @param rest  see SegmentPolynomial
    HWY_INLINE Polynomial<D> operator()(D d, Vec<D> x, const Vec<D>* rest) const {
        const auto tag = bits_tag(d);
        auto base = base_;
        const auto above = hn::Max(x, base);
        for (const CurveRows::Restart& restart : restarts_) {
            const auto is_behind = hn::Ge(above, float_of(d, restart.from));
            base = hn::IfThenElse(is_behind, float_of(d, restart.base), base);
        }
        const auto base_bits = hn::BitCast(tag, base);
        const auto cell = hn::ShiftRightSame(hn::Sub(hn::BitCast(tag, above), base_bits), shift_);
        auto rows = rows_at(d, numbers_, hn::ShiftLeftSame(cell, length_ == 8 ? 3 : 2), length_);
        const auto x0 =
            is_aligned_
                ? hn::And(above, float_of(d, ~std::uint32_t{0} << static_cast<unsigned>(shift_)))
                : hn::BitCast(d, hn::Add(hn::ShiftLeftSame(cell, shift_), base_bits));
        // The bits of scale are 0x7F000000 minus the exponent bits of x0.
        const auto complement = hn::BitCast(tag, hn::AndNot(x0, float_of(d, 0x7F800000)));
        const auto scale = hn::BitCast(d, hn::Add(complement, hn::Set(tag, -0x00800000)));
        auto distance = hn::Sub(x, x0);
        if (rest) distance = hn::Add(distance, *rest);
        const auto t = hn::Mul(distance, scale);
        Vec<D> number[4];
        auto y = hn::Zero(d);
        if (length_ == 8) {
            rows.columns(1, number);
            y = number[3];
            for (int k = 2; k >= 0; --k)
                y = hn::MulAdd(y, t, number[k]);
        }
        rows.columns(0, number);
        y = length_ == 8 ? hn::MulAdd(y, t, number[3]) : number[3];
        y = hn::MulAdd(hn::MulAdd(y, t, number[2]), t, number[1]);
        return {y, t, number[0]};
    }

  private:
    static HWY_INLINE Vec<D> float_of(D d, std::uint32_t bits) {
        return hn::BitCast(d, hn::Set(bits_tag(d), static_cast<std::int32_t>(bits)));
    }

    std::span<const float> numbers_;
    std::span<const CurveRows::Restart> restarts_;
    Vec<D> base_;
    int shift_;
    int length_;
    bool is_aligned_;
};

template <class D, class P>
HWY_INLINE Vec<D> curve_value(D d, const CurveEnds<D>& ends, const P& polynomial, Vec<D> x) {
    const Polynomial<D> p = polynomial(d, hn::Min(x, ends.hi), nullptr);
    const auto y = ends.limit(hn::MulAdd(p.y, p.t, p.first));
    return hn::IfThenElse(hn::Gt(x, ends.lo), y, ends.at_lo);  // NaN is not above
}

/// Value of a precise curve.
/// @param wide_ends  the same ends in double
/// @param exact      the input before it was rounded to x; null: it is x
template <class D, class DD>
HWY_INLINE Doubles precise_curve_value(D d, const CurveEnds<D>& ends,
                                       const CurveEnds<DD>& wide_ends, const auto& polynomial,
                                       Vec<D> x, const Doubles* exact) {
    auto rest = hn::Zero(d);
    if (exact) {
        Doubles lost;
        for (int h = 0; h < kHalves; ++h)
            lost.half[h] = hn::Sub(exact->half[h], promote(x, h));
        rest = hn::IfThenElseZero(hn::Le(x, ends.hi), demote(lost));
    }
    const Polynomial<D> p = polynomial(d, hn::Min(x, ends.hi), exact ? &rest : nullptr);
    const auto is_above = hn::Gt(x, ends.lo);
    const auto first = hn::IfThenElse(is_above, p.first, ends.at_lo);
    const auto y = hn::IfThenElse(is_above, p.y, ends.rest_at_lo);
    Doubles result;
    for (int h = 0; h < kHalves; ++h)
        result.half[h] = wide_ends.limit(hn::Add(promote(first, h), promote(y, h)));
    return result;
}

// ---------------------------------------------------------------------------------------------
// Operations

/// The operation that computes an instruction.
HWY_INLINE ProgramOp computed_by(const Instruction& step) {
    const bool is_near = -kNearPower <= step.k[0] && step.k[0] <= kNearPower;
    return step.op == ProgramOp::power_constant && !step.wide && is_near ? ProgramOp::power_near
                                                                         : step.op;
}

/// True if the operation is computed in double even if its instruction is not wide.
constexpr bool is_always_wide(ProgramOp op) {
    return op == ProgramOp::sine || op == ProgramOp::cosine || op == ProgramOp::atan2 ||
           (op == ProgramOp::log2 && !kHasFma);
}

/// @param x  x(i): operand i
template <ProgramOp op, class D, class X>
HWY_INLINE Vec<D> compute_one(D d, const Program& program, const Instruction& step, const X& x) {
    if constexpr (op == ProgramOp::add) return hn::Add(x(0), x(1));
    if constexpr (op == ProgramOp::subtract) return hn::Sub(x(0), x(1));
    if constexpr (op == ProgramOp::multiply) return hn::Mul(x(0), x(1));
    if constexpr (op == ProgramOp::divide) return hn::Div(x(0), x(1));
    if constexpr (op == ProgramOp::multiply_add) return hn::MulAdd(x(0), x(1), x(2));
    if constexpr (op == ProgramOp::multiply_subtract) return hn::MulSub(x(0), x(1), x(2));
    if constexpr (op == ProgramOp::subtract_product) return hn::NegMulAdd(x(0), x(1), x(2));
    if constexpr (op == ProgramOp::minimum) return minimum(x(0), x(1));
    if constexpr (op == ProgramOp::maximum) return maximum(x(0), x(1));
    if constexpr (op == ProgramOp::clamp) return minimum(maximum(x(0), x(1)), x(2));
    if constexpr (op == ProgramOp::negate) return hn::Neg(x(0));
    if constexpr (op == ProgramOp::absolute) return hn::Abs(x(0));
    if constexpr (op == ProgramOp::square_root) return hn::Sqrt(x(0));
    if constexpr (op == ProgramOp::floor) return hn::Floor(x(0));
    if constexpr (op == ProgramOp::exp2) return exp2(d, x(0));
    if constexpr (op == ProgramOp::log2) return log2(d, x(0), step.is_positive);
    if constexpr (op == ProgramOp::power) return power(d, x(0), x(1));
    if constexpr (op == ProgramOp::power_constant)
        return power(d, x(0), step.k[0], step.is_positive);
    if constexpr (op == ProgramOp::power_near)
        return power_near(d, x(0), step.k[0], step.is_positive);
    if constexpr (op == ProgramOp::sine) return sine(d, x(0), 0);
    if constexpr (op == ProgramOp::cosine) return sine(d, x(0), 1);
    if constexpr (op == ProgramOp::atan2) return atan2(d, x(0), x(1));
    if constexpr (op == ProgramOp::less) return one_where(d, hn::Lt(x(0), x(1)));
    if constexpr (op == ProgramOp::less_equal) return one_where(d, hn::Le(x(0), x(1)));
    if constexpr (op == ProgramOp::equal) return one_where(d, hn::Eq(x(0), x(1)));
    if constexpr (op == ProgramOp::select)
        return hn::IfThenElse(hn::Eq(x(0), hn::Zero(d)), x(2), x(1));
    if constexpr (op == ProgramOp::select_less)
        return hn::IfThenElse(hn::Lt(x(0), x(1)), x(2), x(3));
    if constexpr (op == ProgramOp::select_less_equal)
        return hn::IfThenElse(hn::Le(x(0), x(1)), x(2), x(3));
    if constexpr (op == ProgramOp::select_equal)
        return hn::IfThenElse(hn::Eq(x(0), x(1)), x(2), x(3));
    if constexpr (op == ProgramOp::lookup) return lookup(d, x(0), program.tables[step.table]);
    return x(0);  // copy
}

/// Computes an instruction for a vector of pixels.
/// @tparam op   computed_by(step)
/// @param give  give(c, result) is called for each result that is asked for
template <ProgramOp op, class D, class X, class Give>
HWY_INLINE void compute(D d, const Program& program, const Instruction& step, const X& x,
                        const Give& give) {
    if constexpr (!operation(op).has_channels) {
        give(0, compute_one<op>(d, program, step, x));
    } else if constexpr (op == ProgramOp::dot3) {
        const Vec<D> in[3] = {x(0), x(1), x(2)};
        for (std::size_t row = 0; row < 3; ++row) {
            if (!step.out[row].constant)
                give(row, dot3(d, step.k.data() + 3 * row, in[0], in[1], in[2]));
        }
    } else {
        Vec<D> result[3];
        if constexpr (op == ProgramOp::grid) {
            const Vec<D> in[3] = {x(0), x(1), x(2)};
            interpolate(d, in, program.grids[step.table], result);
        } else {
            lookup_nonuniform(d, x(0), program.positioned[step.table], result);
        }
        for (std::size_t c = 0; c < 3; ++c) {
            if (!step.out[c].constant) give(c, result[c]);
        }
    }
}
