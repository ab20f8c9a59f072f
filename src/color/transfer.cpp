// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tonewright/color.h"

TONEWRIGHT_NAMESPACE_BEGIN

Expr srgb_encode(const Expr& linear) {
    // The power never gets negative numbers, because the linear segment applies there.
    return select(less_equal(linear, 0.0031308), 12.92 * linear,
                  1.055 * pow(max(linear, 0.0031308), 1 / 2.4) - 0.055);
}

Expr srgb_decode(const Expr& code) {
    return select(less_equal(code, 0.04045), code / 12.92,
                  pow((max(code, 0.04045) + 0.055) / 1.055, 2.4));
}

Expr power_encode(const Expr& linear, double exponent) { return pow(max(linear, 0), 1 / exponent); }
Expr power_decode(const Expr& code, double exponent) { return pow(max(code, 0), exponent); }

Expr bt1886_encode(const Expr& linear) { return power_encode(linear, 2.4); }
Expr bt1886_decode(const Expr& code) { return power_decode(code, 2.4); }

Expr bt709_inverse_oetf(const Expr& code) {
    return select(less(code, 4.5 * 0.018), code / 4.5,
                  pow((max(code, 4.5 * 0.018) + 0.099) / 1.099, 1 / 0.45));
}

namespace {
Expr mirror(const Expr& x, const Expr& of_magnitude) {
    return select(less(x, 0), -named("magnitude", of_magnitude), of_magnitude);
}
}  // namespace

Expr smpte_240m_decode(const Expr& code) {
    return select(less(code, 4 * 0.0228), code / 4,
                  pow((max(code, 4 * 0.0228) + 0.1115) / 1.1115, 1 / 0.45));
}

Expr xvycc_decode(const Expr& code) { return mirror(code, bt1886_decode(abs(code))); }

Expr bt1361_decode(const Expr& code) {
    return select(less(code, 0), -bt1886_decode(-4 * code) / 4, bt1886_decode(code));
}

Expr log_range_decode(const Expr& code, double decades) {
    return exp2((max(code, 0) - 1) * (decades * std::log2(10.0)));
}

Expr st428_decode(const Expr& code) { return power_decode(code, 2.6) * (52.37 / 48); }

namespace {
// SMPTE ST 2084:2014, 5.1, as printed there.
constexpr double kPqM1 = 2610.0 / 4096 * (1.0 / 4);
constexpr double kPqM2 = 2523.0 / 4096 * 128;
constexpr double kPqC1 = 3424.0 / 4096;
constexpr double kPqC2 = 2413.0 / 4096 * 32;
constexpr double kPqC3 = 2392.0 / 4096 * 32;

// ITU-R BT.2100-2, table 5.
constexpr double kHlgA = 0.17883277;
constexpr double kHlgB = 1 - 4 * kHlgA;                  // 0.28466892
const double kHlgC = 0.5 - kHlgA * std::log(4 * kHlgA);  // 0.55991073
}  // namespace

Expr pq_encode_nits(const Expr& nits) {
    const Expr y = named("y", pow(abs(nits) / 10000, kPqM1));
    return named("pq", mirror(nits, pow((kPqC1 + kPqC2 * y) / (1 + kPqC3 * y), kPqM2)));
}

Expr pq_decode_nits(const Expr& code) {
    // The standard ends at 1; at 1.95 the formula divides by 0.
    const Expr p = named("p", pow(min(abs(code), 1), 1 / kPqM2));
    return named("nits",
                 mirror(code, 10000 * pow(max(p - kPqC1, 0) / (kPqC2 - kPqC3 * p), 1 / kPqM1)));
}

Expr hlg_oetf(const Expr& scene_linear) {
    const Expr e = abs(scene_linear);
    return mirror(scene_linear, select(less_equal(e, 1.0 / 12), sqrt(3 * e),
                                       kHlgA * log(max(12 * e - kHlgB, 1e-10)) + kHlgC));
}

Expr hlg_inverse_oetf(const Expr& code) {
    const Expr c = abs(code);
    return mirror(code,
                  select(less_equal(c, 0.5), c * c / 3, (exp((c - kHlgC) / kHlgA) + kHlgB) / 12));
}

namespace {
constexpr double kHlgGamma = 1.2;
const double kHlgStraightBelow = 1e-4 / std::pow(3.0, kHlgGamma);
}  // namespace

Expr hlg_inverse_ootf_luminance(const Expr& display_luminance) {
    return display_luminance * pow(max(display_luminance, kHlgStraightBelow), 1 / kHlgGamma - 1);
}

Expr hlg_ootf_luminance(const Expr& scene_luminance) {
    const double straight_below = std::pow(kHlgStraightBelow, 1 / kHlgGamma);
    return scene_luminance * pow(max(scene_luminance, straight_below), kHlgGamma - 1);
}

namespace {
// Academy S-2016-001, equations 1 and 2.
constexpr double kCctBreakLinear = 0.0078125;
constexpr double kCctBreakCode = 0.155251141552511;
constexpr double kCctSlope = 10.5402377416545;
constexpr double kCctOffset = 0.0729055341958355;
}  // namespace

Expr acescct_encode(const Expr& linear) {
    return select(less_equal(linear, kCctBreakLinear), kCctSlope * linear + kCctOffset,
                  (log2(max(linear, kCctBreakLinear)) + 9.72) / 17.52);
}

Expr acescct_decode(const Expr& code) {
    return select(less_equal(code, kCctBreakCode), (code - kCctOffset) / kCctSlope,
                  exp2(code * 17.52 - 9.72));
}

Expr acescc_decode(const Expr& code) {
    const Expr light = exp2(code * 17.52 - 9.72);
    return select(less(code, (9.72 - 15) / 17.52), (light - std::exp2(-16)) * 2, light);
}

namespace {
Expr log10(const Expr& x) { return log2(x) * std::log10(2.0); }
Expr exp10(const Expr& x) { return exp2(x * std::log2(10.0)); }

struct LogC {
    double cut, a, b, c, d, e, f;
};
constexpr LogC kLogC3 = {0.010591, 5.555556, 0.052272, 0.247190, 0.385537, 5.367655, 0.092809};
constexpr LogC kUnityLogC = {0.011361, 5.555556, 0.047996, 0.244161, 0.386036, 5.301883, 0.092819};

struct LogC4 {
    double a = (std::exp2(18) - 16) / 117.45;
    double b = (1023.0 - 95) / 1023;
    double c = 95.0 / 1023;
    double s = 7 * std::log(2) * std::exp2(7 - 14 * c / b) / (a * b);
    double t = (std::exp2(14 * (-c / b) + 6) - 64) / a;
};

constexpr double kSLog3Cut = 0.01125000;
constexpr double kSLog3Knee = 171.2102946929;

constexpr double kDaVinciA = 0.0075;
constexpr double kDaVinciB = 7.0;
constexpr double kDaVinciC = 0.07329248;
constexpr double kDaVinciM = 10.44426855;
constexpr double kDaVinciLinearCut = 0.00262409;
constexpr double kDaVinciLogCut = 0.02740668;

double unreal_log_black() { return std::exp2(-444.0 / 1023 * 14) * 0.18; }
}  // namespace

Expr arri_logc3_encode(const Expr& linear) {
    return select(less_equal(linear, kLogC3.cut), kLogC3.e * linear + kLogC3.f,
                  kLogC3.c * log10(kLogC3.a * max(linear, kLogC3.cut) + kLogC3.b) + kLogC3.d);
}

Expr arri_logc3_decode(const Expr& code) {
    return select(less_equal(code, kLogC3.e * kLogC3.cut + kLogC3.f), (code - kLogC3.f) / kLogC3.e,
                  (exp10((code - kLogC3.d) / kLogC3.c) - kLogC3.b) / kLogC3.a);
}

Expr arri_logc4_encode(const Expr& linear) {
    const LogC4 p;
    return select(less(linear, p.t), (linear - p.t) / p.s,
                  (log2(p.a * max(linear, p.t) + 64) - 6) / 14 * p.b + p.c);
}

Expr arri_logc4_decode(const Expr& code) {
    const LogC4 p;
    return select(less(code, 0), code * p.s + p.t,
                  (exp2(14 * ((code - p.c) / p.b) + 6) - 64) / p.a);
}

Expr sony_slog3_encode(const Expr& linear) {
    return select(less(linear, kSLog3Cut), (linear * (kSLog3Knee - 95) / kSLog3Cut + 95) / 1023,
                  (420 + log10((max(linear, kSLog3Cut) + 0.01) / (0.18 + 0.01)) * 261.5) / 1023);
}

Expr sony_slog3_decode(const Expr& code) {
    return select(less(code, kSLog3Knee / 1023), (code * 1023 - 95) * kSLog3Cut / (kSLog3Knee - 95),
                  exp10((code * 1023 - 420) / 261.5) * (0.18 + 0.01) - 0.01);
}

Expr davinci_intermediate_encode(const Expr& linear) {
    return select(less_equal(linear, kDaVinciLinearCut), linear * kDaVinciM,
                  (log2(max(linear, kDaVinciLinearCut) + kDaVinciA) + kDaVinciB) * kDaVinciC);
}

Expr davinci_intermediate_decode(const Expr& code) {
    return select(less_equal(code, kDaVinciLogCut), code / kDaVinciM,
                  exp2(code / kDaVinciC - kDaVinciB) - kDaVinciA);
}

Expr canon_log2_decode(const Expr& code) {
    constexpr double kOffset = 0.092864125;
    const Expr light = (exp10(abs(code - kOffset) / 0.24136077) - 1) * (0.9 / 87.099375);
    return select(less(code, kOffset), -light, light);
}

Expr canon_log3_decode(const Expr& code) {
    constexpr double kSlope = 0.36726845;
    constexpr double kUnit = 0.9 / 14.98325;
    return select(less(code, 0.097465473), (1 - exp10((0.12783901 - code) / kSlope)) * kUnit,
                  select(less_equal(code, 0.15277891), (code - 0.12512219) * (0.9 / 1.9754798),
                         (exp10((code - 0.12240537) / kSlope) - 1) * kUnit));
}

Expr panasonic_vlog_decode(const Expr& code) {
    return select(less(code, 0.181), (code - 0.125) / 5.6,
                  exp10((code - 0.598206) / 0.241514) - 0.00873);
}

Expr red_log3g10_decode(const Expr& code) {
    return select(less(code, 0), code / 15.1927, (exp10(code / 0.224282) - 1) / 155.975327) - 0.01;
}

Expr cineon_decode(const Expr& code) {
    constexpr double kDensityOfCode = 0.002;
    constexpr double kGamma = 0.6;
    constexpr double kBlack = 95;
    constexpr double kWhite = 685;
    const double black = std::pow(10, (kBlack - kWhite) * kDensityOfCode / kGamma);
    return (exp10((code * 1023 - kWhite) * (kDensityOfCode / kGamma)) - black) / (1 - black);
}

Expr unity_logc_encode(const Expr& linear) {
    return kUnityLogC.c * log10(max(kUnityLogC.a * linear + kUnityLogC.b, 1e-10)) + kUnityLogC.d;
}

Expr unity_logc_decode(const Expr& code) {
    return (exp10((code - kUnityLogC.d) / kUnityLogC.c) - kUnityLogC.b) / kUnityLogC.a;
}

Expr unreal_log_encode(const Expr& linear) {
    return log2(max(linear, unreal_log_black()) / 0.18) / 14 + 444.0 / 1023;
}

Expr unreal_log_decode(const Expr& code) { return exp2((code - 444.0 / 1023) * 14) * 0.18; }

TONEWRIGHT_NAMESPACE_END
