// SPDX-License-Identifier: Apache-2.0
//
// EETFs: map the luminance of one display to that of a display with a lower peak. Report BT.2390,
// Report BT.2446 method A, and libplacebo's spline.
//
// Source    Report ITU-R BT.2390, "High dynamic range television for production and international
//           programme exchange", EETF. Report ITU-R BT.2446, "Methods for conversion of high
//           dynamic range content to standard dynamic range content and vice-versa", method A, its
//           curve. libplacebo, tone_mapping.c: spline, and its variant of bt2390.
// In        display-linear RGB of the master, working primaries Rec.2020, D65; 1.0 =
//           reference_white cd/m2; domain [source_black, source_peak], constant outside (negatives:
//           0).
// Out       display-linear RGB; output=sdr: 1.0 = target_peak, [target_black/target_peak, 1];
//           output=hdr: the same in units of 100 cd/m2. bt2390 with target_black above source_black
//           ends slightly above 1, because it adds the black lift there, too.
// Kind      per channel, luminance, max or hue-preserving (parameter `apply`). Monotone on the
//           neutral axis: yes with the defaults; bt2446a as printed jumps up where its segments
//           meet, by 0.0006 and 0.00001 of Yc.
// Keeps     source_black -> target_black, source_peak -> target_peak (except as under Out).
// Differs   bt2390:libplacebo and spline scale luminance; libplacebo puts its curves on I of an IPT
// and
//           then maps the gamut. Colors of a chart are 2 code values of 8 bits from it on average;
//           on channels, 4 to 6. libplacebo subtracts the display's black from SDR code values, and
//           target_black above source_black needs apply=channels or hue_preserving. mpv's output
//           `gpu`, before gpu-next, is the Report's bt2390 with apply=max.
//           bt2446a is the Report's curve without its color correction: method A works on Y' of
//           gamma-encoded Y'CbCr; here `apply` chooses what the curve works on. The result is
//           limited to target_black, which a knee below 0 (large knee_offset) would undercut.
//           Without compression (source peak at or below target peak) only the source's limits
//           apply. The exponent 1/mn of libplacebo's black is 4 for mn <= 0.
// Check     18 cd/m2 of 1000 to 100 cd/m2: 18 (bt2390), 16.540679 (preset libplacebo), 5.25011361
//           (bt2446a), 10.5269722 (spline) (check_values.json).
#include <algorithm>
#include <cmath>
#include <span>

#include "base/format_number.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Limits of source and target, in cd/m2.
struct Limits {
    double source_black, source_peak, target_black, target_peak, reference_white;

    explicit Limits(const Params& p)
        : source_black(p.number("source_black")),
          source_peak(p.number("source_peak")),
          target_black(p.number("target_black")),
          target_peak(p.number("target_peak")),
          reference_white(p.number("reference_white")) {
        const double lowest_peak = std::min(source_peak, target_peak);
        if (!(source_black < lowest_peak)) {
            throw Error("source_black is " + shortest(source_black) + "; expected below " +
                        shortest(lowest_peak) + " cd/m2, the lower of source_peak and target_peak");
        }
        if (!(target_black < lowest_peak)) {
            throw Error("target_black is " + shortest(target_black) + "; expected below " +
                        shortest(lowest_peak) + " cd/m2, the lower of source_peak and target_peak");
        }
    }
    [[nodiscard]] bool is_compressed() const { return source_peak > target_peak; }
    /// Limits of the source as scene values.
    [[nodiscard]] double lowest() const { return source_black / reference_white; }
    [[nodiscard]] double highest() const { return source_peak / reference_white; }
};

/// cd/m2 of output 1.
double output_unit(const Params& p) {
    return p.choice("output") == "hdr" ? 100 : p.number("target_peak");
}

std::vector<ParameterSpec> with_limits(std::string default_apply, std::vector<ParameterSpec> own) {
    std::vector<ParameterSpec> all = {
        number_parameter("source_peak", "cd/m2", 1000, 1, 10000,
                         "peak luminance that the source was mastered for"),
        display_parameter(number_parameter("target_peak", "cd/m2", 100, 1, 10000,
                                           "peak luminance of the display"),
                          [](const DisplayFacts& display) { return shortest(display.peak); }),
        number_parameter("source_black", "cd/m2", 0, 0, 10000,
                         "black level that the source was mastered for"),
        number_parameter("target_black", "cd/m2", 0, 0, 10000,
                         "black level of the display; it stays in the result and in SDR code "
                         "values, from which libplacebo subtracts it"),
        number_parameter("reference_white", "cd/m2", 100, 1, 1000, "luminance of scene-linear 1"),
        sdr_or_hdr_parameter("sdr: 1 is target_peak; hdr: 1 is 100 cd/m2"),
    };
    all.insert(all.end(), own.begin(), own.end());
    return with_apply(std::move(default_apply), fixed_parameters(std::move(all)));
}

Operator eetf_operator() {
    Operator op;
    op.negatives = kNegativesClampAtZero;
    op.working = kRec2020;
    op.dialects = "EETF";
    op.bounds = {
        // With a goal of 1e-6, one color far outside the gamut exceeded the bound slightly.
        .simd_goal = 7e-7,
        .ocio_cpu = 3e-5,
        .ocio_gpu = 5e-5,
        .reason =
            "hdr: values up to 10 in PQ; a channel near 0 keeps the float rounding of the larger "
            "ones"};
    op.peak = [](const Params& p) { return p.number("target_peak") / output_unit(p); };
    return op;
}

/// @param nits  luminance on the target in cd/m2, for a scene value between the source's limits.
Pipeline eetf(const Expr& nits, const Limits& limits, const Params& params) {
    const double unit = output_unit(params);
    const double target_lo = limits.is_compressed() ? limits.target_black / unit : 0;
    const Expr f = nits / unit;
    // Per channel, the limits are separate stages, so that the tables have no corners.
    if (params.choice("apply") == "channels") {
        return Pipeline{ClampStage{limits.lowest(), limits.highest()}} +
               apply_tone_curve({.f = f, .weights = kRec2020Weights}, params) +
               Pipeline{ClampStage{target_lo, kInfinity}};
    }
    const Expr limited = named("limited", clamp(Expr::input(), limits.lowest(), limits.highest()));
    const Expr limited_f =
        named("limited_f", max(substitute(f, std::span(&limited, 1)), target_lo));
    return tone_curve_pipeline({.f = limited_f, .weights = kRec2020Weights}, params);
}

Expr source_nits(const Limits& limits) { return Expr::input() * limits.reference_white; }
double pq(double nits) { return pq_encode_nits(nits).value(); }
double lerp(double a, double b, double t) { return a + t * (b - a); }

/// PQ code values with the source's range scaled to [0, 1]: `E` of the Report.
Expr bt2390_curve(const Limits& limits, double knee_offset, bool is_libplacebo) {
    const double lo = pq(limits.source_black);
    const double range = pq(limits.source_peak) - lo;
    const double mn = (pq(limits.target_black) - lo) / range;
    const double mx = (pq(limits.target_peak) - lo) / range;
    const double knee = (1 + knee_offset) * mx - knee_offset;  // below mx, as mx < 1

    const Expr e1 = named("e1", (pq_encode_nits(source_nits(limits)) - lo) / range);
    const Expr t = named("t", clamp((e1 - knee) / (1 - knee), 0, 1));
    const Expr t2 = named("t2", t * t);
    const Expr t3 = named("t3", t2 * t);
    const Expr hermite =
        (2 * t3 - 3 * t2 + 1) * knee + (t3 - 2 * t2 + t) * (1 - knee) + (3 * t2 - 2 * t3) * mx;
    const Expr e2 = named("e2", select(less(e1, knee), e1, hermite));

    const Expr below = named("below", max(1 - e2, 0));
    Expr e3 = e2;
    if (is_libplacebo) {
        const double power = mn > 0 ? std::min(1 / mn, 4.0) : 4.0;
        const double loss = 1 + mn / mx * std::pow(1 - mx, power);
        if (!(loss > 0)) {
            throw Error("source_black is " + shortest(limits.source_black) +
                        "; expected further below target_peak with black_lift=libplacebo");
        }
        e3 = (e2 + mn * pow(below, power) - mn) / loss + mn;
    } else {
        e3 = e2 + mn * ((below * below) * (below * below));
    }
    return pq_decode_nits(clamp(e3 * range + lo, 0, 1));
}

Operator bt2390() {
    Operator op = eetf_operator();
    op.id = "bt2390";
    op.title = "BT.2390 EETF";
    op.view = "BT.2390 EETF";
    op.character =
        "HDR masters on a display with a lower peak: unchanged below a knee, then a spline in PQ; "
        "darker than scene operators";
    op.source = "Report ITU-R BT.2390, EETF; knee and black of libplacebo, tone_mapping.c: bt2390";
    op.license = "published formula; libplacebo: LGPL-2.1+, formula only, none of its code is used";
    op.parameters = with_limits(
        "channels",
        {
            number_parameter("knee_offset", "", 0.5, 0.5, 2,
                             "o of the knee (1 + o) mx - o: 0.5 in the Report, 1 in libplacebo"),
            choice_parameter("black_lift", {"report", "libplacebo"}, "report",
                             "black lift to target_black; report: adds mn (1 - E)^4; libplacebo: "
                             "another power, and a gain that keeps the peak"),
        });
    op.presets = {{"libplacebo",
                   "libplacebo's variant, on luminance",
                   {{"knee_offset", "1"}, {"black_lift", "libplacebo"}, {"apply", "luminance"}}}};
    op.build = [](const Params& p) -> Pipeline {
        const Limits limits(p);
        const Expr nits = named("nits", limits.is_compressed()
                                            ? bt2390_curve(limits, p.number("knee_offset"),
                                                           p.choice("black_lift") == "libplacebo")
                                            : source_nits(limits));
        return eetf(nits, limits, p);
    };
    return op;
}

Expr bt2446a_curve(const Limits& limits) {
    const double rho_source = 1 + 32 * std::pow(limits.source_peak / 10000, 1 / 2.4);
    const double rho_target = 1 + 32 * std::pow(limits.target_peak / 10000, 1 / 2.4);
    const Expr above = named("above", max(Expr::input() - limits.lowest(), 0));
    const Expr y = pow(above / (limits.highest() - limits.lowest()), 1 / 2.4);
    const Expr yp = named("yp", log(1 + (rho_source - 1) * y) / std::log(rho_source));
    const Expr yc =
        select(less_equal(yp, 0.7399), 1.0770 * yp,
               select(less(yp, 0.9909), -1.1510 * yp * yp + 2.7811 * yp - 0.6302, 0.5 * yp + 0.5));
    const Expr y_sdr =
        named("y_sdr", max(exp(yc * std::log(rho_target)) - 1, 0) / (rho_target - 1));
    const double black = std::pow(limits.target_black, 1 / 2.4);
    const double peak = std::pow(limits.target_peak, 1 / 2.4);
    return pow((peak - black) * y_sdr + black, 2.4);
}

Operator bt2446a() {
    Operator op = eetf_operator();
    op.id = "bt2446a";
    op.title = "BT.2446 method A";
    op.view = "BT.2446 A";
    op.character =
        "HDR masters of 1000 cd/m2 for SDR television: one smooth curve over the whole range, low "
        "contrast";
    op.source = "Report ITU-R BT.2446, method A, its tone mapping curve";
    op.license = "published formula";
    op.parameters = with_limits("channels", {});
    // 1.0770 Y and -1.1510 Y^2 + 2.7811 Y - 0.6302 differ at Y = 0.7399.
    op.differences = {{DocumentedDifference::Kind::jumps, 0.00104, ""}};
    // 0.001 display-linear, amplified by a matrix and by sRGB's slope at black.
    op.bounds = {.ocio_cpu = 5e-3,
                 .ocio_gpu = 5e-3,
                 .reason = "the Report's curve jumps where its segments meet"};
    op.build = [](const Params& p) -> Pipeline {
        const Limits limits(p);
        return eetf(limits.is_compressed() ? bt2446a_curve(limits) : source_nits(limits), limits,
                    p);
    };
    return op;
}

/// Two polynomials that meet at a pivot with equal slope, in PQ code values.
/// @param average  of the scene, in cd/m2; 0 if unknown.
Expr spline_curve(const Limits& limits, double contrast, double average) {
    const double smin = pq(limits.source_black);
    const double smax = pq(limits.source_peak);
    const double dmin = pq(limits.target_black);
    const double dmax = pq(limits.target_peak);
    const auto smooth = [](double a, double b, double v) { return smoothstep(a, b, v).value(); };

    const double scene = average > 0 ? pq(average) : lerp(smin, smax, 0.4);
    const double src = std::clamp(scene, lerp(smin, smax, 0.1), lerp(smin, smax, 0.8));
    const double target = (src - smin) / (smax - smin);
    const double adapted = lerp(dmin, dmax, target);
    const double tuning = 1 - smooth(0.8, 0.4, target) * smooth(0.1, 0.4, target);
    const double dst = std::clamp(lerp(src, adapted, lerp(0.4, 1, tuning)), lerp(dmin, dmax, 0.1),
                                  lerp(dmin, dmax, 0.8));
    const double ratio = std::clamp(1.5 * (smax / dmax - 1), 0.2, 1.2);
    const double slope = std::pow((dst - dmin) / (src - smin), (1 - contrast) * ratio);

    const double lo = smin - src;
    const double hi = smax - src;
    const double pa = (dmin - dst - slope * lo) / (lo * lo);
    const double t = 2 * hi * hi;
    const double qa = (slope * hi - (dmax - dst)) / (hi * t);
    const double qb = -3 * (slope * hi - (dmax - dst)) / t;

    const Expr x = named("from_pivot", pq_encode_nits(source_nits(limits)) - src);
    const Expr y = named(
        "bent", select(less_equal(x, 0), (pa * x + slope) * x, ((qa * x + qb) * x + slope) * x));
    return pq_decode_nits(clamp(y + dst, dmin, dmax));
}

Operator spline() {
    Operator op = eetf_operator();
    op.id = "spline";
    op.title = "Spline (libplacebo)";
    op.view = "Spline libplacebo";
    op.character =
        "HDR masters on a display with a lower peak, about a pivot that follows the scene average; "
        "adjustable contrast";
    op.source = "libplacebo, tone_mapping.c: spline, its default";
    op.license = "LGPL-2.1+; formula only, none of its code is used";
    op.parameters = with_limits(
        "luminance", {
                         number_parameter("contrast", "", 0.5, 0, 1.5,
                                          "contrast about the pivot; 1 keeps its slope at 1"),
                         number_parameter("average", "cd/m2", 0, 0, 10000,
                                          "average luminance of the scene (0: unknown)"),
                     });
    op.build = [](const Params& p) -> Pipeline {
        const Limits limits(p);
        const Expr nits =
            named("nits", limits.is_compressed()
                              ? spline_curve(limits, p.number("contrast"), p.number("average"))
                              : source_nits(limits));
        return eetf(nits, limits, p);
    };
    return op;
}

}  // namespace

std::vector<Operator> define_eetf() { return {bt2390(), bt2446a(), spline()}; }

TONEWRIGHT_NAMESPACE_END
