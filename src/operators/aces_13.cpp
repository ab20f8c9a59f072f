// SPDX-License-Identifier: Apache-2.0
//
// The output transforms of ACES 1.0 to 1.3: RRT and ODT for SDR, single-stage transforms for HDR,
// and optionally the reference gamut compression before them.
//
// Source    Academy of Motion Picture Arts and Sciences, aces-dev 1.3 (CTL): RRT 1.0.3 with
//           ACESlib.RRT_Common, ACESlib.Tonescales and ACESlib.ODT_Common; ODT.Academy.* of 48 and
//           of 100 cd/m2 dim; ACESlib.SSTS and ACESlib.OutputTransforms 1.1 (RRTODT.Academy.*);
//           LMT.Academy.ReferenceGamutCompress. OpenColorIO 2.1, transforms/builtins/ACES.cpp and
//           ops/gradingrgbcurve, FixedFunction ACES_GLOW_10, ACES_RED_MOD_10, ACES_DARK_TO_DIM_10,
//           ACES_GAMUT_COMP_13.
// In        scene-linear RGB, working primaries AP0 (ACES2065-1); domain (-inf, inf), limited to
//           +-65504.
// Out       SDR: display-linear RGB of the limiting primaries, 1.0 = white (48 cd/m2 for the
//           cinema, otherwise 100); [0, 1]. With limit=none: AP1, up to 1.1. HDR: display-linear
//           RGB of Rec.2020, 1.0 = 100 cd/m2. The limiting primaries clip it to [0, peak] under the
//           ACES white; then it is adapted to D65. The adaptation moves clipped colors slightly
//           outside the primaries, and blue to at most 1.09 times the peak. OpenColorIO and the CTL
//           show the same. The output is Rec.2020 for every limit.
// Kind      3D (gamut compression, glow and red modifier), then matrix, curve, for video a scale by
//           luminance (dim surround), matrix. Monotone on the neutral axis: SDR yes; HDR not in the
//           last 5 % below the peak, in the limiting primaries: red has reached its limit and falls
//           by up to 0.13 % while green and blue still rise.
// Keeps     0 -> 0 (spline=ocio: 6e-12). SDR shows grays up to 0.00199 as black.
// Differs   spline=ocio is OpenColorIO's built-in transform, spline=ctl is the Academy's. They
//           differ in four points: the saturation for the red modifier (after or before the glow);
//           the CTL's limit of AP1 at 65504; OpenColorIO's floor under the luminance of the dim
//           surround; and the curve. OpenColorIO's curve has knots with eight decimals, and the
//           tops of three of its curves (RRT, 1000 and 108 cd/m2) differ: see ocio_knots().
//           OpenColorIO has no transform for limit=rec2020 of SDR, rec709 of HDR and some limits of
//           the cinema; these are built like the others. Left out: the simulations of the D60 and
//           DCI whites.
// Check     mid gray 0.18 -> 0.104063516219 (ocio), 0.104063518162 (ctl); output=hdr_1000: 0.15
//           (check_values.json).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "operators/color_modifiers.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// A variant of the standard, chosen by `output`.
struct Form {
    const char* id;
    bool is_hdr;
    bool is_video;
    double peak;     // cd/m2 of the curve's largest light
    double mid = 0;  // of HDR: cd/m2 of scene-linear 0.18
    /// @see ocio_knots
    bool has_other_top = false;
};

constexpr std::array<Form, 6> kForms = {{
    {"sdr_video", false, true, 48},
    {"sdr_cinema", false, false, 48},
    {"hdr_1000", true, true, 1000, 15, true},
    {"hdr_2000", true, true, 2000, 15},
    {"hdr_4000", true, true, 4000, 15},
    {"hdr_cinema", true, false, 108, 7.2, true},
}};

const Form& form_of(const Params& p) {
    return *std::find_if(kForms.begin(), kForms.end(),
                         [&](const Form& f) { return p.choice("output") == f.id; });
}

// ---------------------------------------------------------------------------------------------
// Curves from log10 to log10: quadratics between knots

struct Knot {
    double x, y, slope;
};
using Knots = std::vector<Knot>;

/// Knots of the uniform quadratic B-spline whose coefficients straddle them.
template <std::size_t N>
Knots bspline_knots(const std::array<double, N>& c, double begin, double end) {
    const double step = (end - begin) / static_cast<double>(N - 2);
    Knots knots;
    for (std::size_t i = 0; i + 1 < N; ++i) {
        knots.push_back({begin + static_cast<double>(i) * step, (c[i] + c[i + 1]) / 2,
                         (c[i + 1] - c[i]) / step});
    }
    return knots;
}

/// The CTL's curves, below and above mid gray. Both halves have a knot there.
struct TwoSplines {
    Knots low, high;
};

/// y + t (slope + t bend) with t = x - `x`.
struct Quadratic {
    double x, y, slope, bend;
};
using Quadratics = std::vector<Quadratic>;

Quadratics quadratics(const Knots& knots) {
    Quadratics pieces;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        const Knot& k = knots[i];
        const Knot& next = knots[i + 1];
        pieces.push_back({k.x, k.y, k.slope, (next.slope - k.slope) / (2 * (next.x - k.x))});
    }
    pieces.push_back({knots.back().x, knots.back().y, knots.back().slope, 0});
    return pieces;
}

Quadratics quadratics(const TwoSplines& splines) {
    Quadratics pieces = quadratics(splines.low);
    pieces.pop_back();
    const Quadratics high = quadratics(splines.high);
    pieces.insert(pieces.end(), high.begin(), high.end());
    return pieces;
}

/// Constant below the first piece; the last piece is unbounded.
Expr spline(const Quadratics& pieces, const Expr& x) {
    const Expr at = named("inside", max(x, pieces.front().x));
    const auto value = [&](const Quadratic& q) {
        const Expr t = named("t", at - q.x);
        return q.y + t * (q.slope + t * q.bend);
    };
    Expr y = value(pieces.back());
    for (std::size_t i = pieces.size() - 1; i-- > 0;)
        y = named("y", select(less(at, pieces[i + 1].x), value(pieces[i]), y));
    return y;
}

constexpr double kMidGray = 0.18;
constexpr double kMidLight = 4.8;  // cd/m2 of it
constexpr double kMidSlope = 1.55;

/// Scene value of `stops` above scene-linear 0.18.
double log10_scene(double stops) { return std::log10(kMidGray) + stops * std::log10(2.0); }

/// ACESlib.Tonescales, segmented_spline_c5, without the last of six coefficients each, which no
/// interval uses.
TwoSplines rrt_splines() {
    constexpr std::array low = {-4.0, -4.0, -3.1573765773, -0.4852499958, 1.8477324706};
    constexpr std::array high = {-0.7185482425, 2.0810307172, 3.6681241237, 4.0, 4.0};
    const double mid = log10_scene(0);
    return {bspline_knots(low, log10_scene(-15), mid), bspline_knots(high, mid, log10_scene(18))};
}

/// ACESlib.Tonescales, segmented_spline_c9 of 48 cd/m2, without the last coefficients.
TwoSplines odt_splines() {
    constexpr std::array low = {-1.6989700043, -1.6989700043, -1.4779,      -1.2291,     -0.8648,
                                -0.4480,       0.00518,       0.4511080334, 0.9113744414};
    constexpr std::array high = {0.5154386965, 0.8470437783, 1.1358,       1.3802,      1.5197,
                                 1.5985,       1.6467,       1.6746091357, 1.6878733390};
    const auto rendered = [rrt = quadratics(rrt_splines())](double stops) {
        return spline(rrt, log10_scene(stops)).value();
    };
    constexpr double stops = 6.5;
    TwoSplines odt = {bspline_knots(low, rendered(-stops), rendered(0)),
                      bspline_knots(high, rendered(0), rendered(stops))};
    odt.high.back().slope = 0.04;
    return odt;
}

double between(double x, double x0, double x1, double y0, double y1) {
    return std::lerp(y0, y1, std::clamp((x - x0) / (x1 - x0), 0.0, 1.0));
}

constexpr double kHdrBlack = 1e-4;  // cd/m2
constexpr double kSdrBlack = 0.02;

/// ACESlib.SSTS, init_TsParams, with the exposure of ACESlib.OutputTransforms that puts 0.18 at
/// `mid_light`.
TwoSplines ssts_splines(double peak, double mid_light) {
    const double bottom = std::log10(kHdrBlack);
    const double top = std::log10(peak);
    const double mid = std::log10(kMidLight);
    constexpr double low_stops = -15;  // of 0.0001 cd/m2; 0.02 has -6.5
    const double high_stops = between(top, std::log10(48.0), 4, 6.5, 18);
    // The outermost coefficients lie half an interval away, along the slope at mid gray.
    const double half_low = kMidSlope * std::log10(2.0) * -low_stops / 6;
    const double half_high = kMidSlope * std::log10(2.0) * high_stops / 6;
    const std::array low = {bottom, bottom, std::lerp(bottom, mid, 0.18), mid - half_low,
                            mid + half_low};
    const double bend = between(high_stops, 6.5, 18, 0.89, 0.90);
    const std::array high = {mid - half_high, mid + half_high, std::lerp(mid, top, bend), top, top};
    TwoSplines splines = {bspline_knots(low, log10_scene(low_stops), log10_scene(0)),
                          bspline_knots(high, log10_scene(0), log10_scene(high_stops))};
    const double exposure =
        inverse_at(spline(quadratics(splines), Expr::input()), std::log10(mid_light),
                   log10_scene(0), log10_scene(high_stops)) -
        log10_scene(0);
    for (Knots* knots : {&splines.low, &splines.high}) {
        for (Knot& k : *knots)
            k.x -= exposure;
    }
    return splines;
}

/// Position where two quadratics meet that have the slopes of two knots. One quadratic would miss
/// the second knot.
Knot knot_between(const Knot& a, const Knot& b) {
    const double width = b.x - a.x;
    const double mean = (b.y - a.y) / width;
    const double bend = b.slope - a.slope;
    const double from_a = a.slope - mean;
    const double from_b = b.slope - mean;
    const double x = std::fabs(from_a) > std::fabs(from_b) ? b.x + from_a * width / bend
                                                           : a.x + from_b * width / bend;
    const double slope = 2 * mean - b.slope + bend * (x - a.x) / width;
    return {x, a.y + (a.slope + slope) / 2 * (x - a.x), slope};
}

/// The knots as OpenColorIO prints them, with eight decimals.
/// @param has_other_top  OpenColorIO limits slopes so that a curve stays monotone. In the flat last
///                       interval of this curve, rounding to float makes it use 0.995 of the slope
///                       at the start of the interval, and split both intervals that meet there.
Knots ocio_knots(const TwoSplines& splines, bool has_other_top) {
    Knots knots = splines.low;
    knots.insert(knots.end(), splines.high.begin() + 1, splines.high.end());
    for (Knot& k : knots) {
        for (double* number : {&k.x, &k.y, &k.slope})
            *number = std::round(*number * 1e8) / 1e8;
    }
    if (!has_other_top) return knots;
    const std::size_t n = knots.size();
    knots[n - 2].slope *= 0.995;
    const Knot before = knot_between(knots[n - 3], knots[n - 2]);
    const Knot behind = knot_between(knots[n - 2], knots[n - 1]);
    knots.insert(knots.end() - 1, behind);
    knots.insert(knots.end() - 3, before);
    return knots;
}

Expr power_of_10(const Expr& y) { return exp2(y * std::log2(10.0)); }

/// A channel of AP1 -> display-linear value between black and peak, [0, 1].
Expr tone_curve(const Form& form, bool is_ocio) {
    constexpr double half_min = 0x1p-24;  // below it all curves are constant
    const Expr x = named("log_scene", log2(max(Expr::input(), half_min)) * std::log10(2.0));
    const auto curve = [&](const TwoSplines& splines, bool has_other_top) {
        return is_ocio ? quadratics(ocio_knots(splines, has_other_top)) : quadratics(splines);
    };
    Expr y = x;
    double bottom = 0;
    if (form.is_hdr) {
        const Quadratics ssts = curve(ssts_splines(form.peak, form.mid), form.has_other_top);
        y = spline(ssts, x);
        bottom = ssts.front().y;
    } else {
        const Quadratics odt = curve(odt_splines(), false);
        y = spline(odt, spline(curve(rrt_splines(), true), x));
        bottom = odt.front().y;
    }
    // The CTL computes its black so that black is 0.
    const double standard_black = form.is_hdr ? kHdrBlack : kSdrBlack;
    const double black = is_ocio ? standard_black : power_of_10(bottom).value();
    return (power_of_10(y) - black) / (form.peak - black);
}

// ---------------------------------------------------------------------------------------------
// After the curve

/// Limited in the primaries under the ACES white, then adapted to D65, in units of 100 cd/m2.
Pipeline hdr_light(const Primaries& limit, double peak) {
    const Matrix3 to_limit = multiply(inverse(rgb_to_xyz(limit)), rgb_to_xyz(kAP1));
    const Matrix3 adapted = multiply(bradford_adaptation(kAcesWhite, kD65), rgb_to_xyz(limit));
    return {MatrixStage{to_limit}, ClampStage{0, 1},
            MatrixStage{scale(multiply(inverse(rgb_to_xyz(kRec2020)), adapted), peak / 100)}};
}

/// From a dark to a dim surround: Y^0.9811, same chromaticity.
ToneScaleStage dim_surround(bool is_ocio) {
    const Expr x = Expr::input();
    constexpr double gamma = 0.9811;
    return {ToneScaleStage::Norm::luminance, ap1_weights(),
            is_ocio ? x * pow(max(x, 1e-10), gamma - 1) : pow(x, gamma)};
}

Pipeline build(const Params& p) {
    const Form& form = form_of(p);
    const bool is_ocio = p.choice("spline") == "ocio";
    const bool is_limited = p.choice("limit") != "none";
    if (form.is_hdr && !is_limited) {
        throw Error("limit is none; expected rec709, p3d65 or rec2020 with output=" +
                    p.choice("output"));
    }
    Pipeline stages = {ClampStage{-kHalfMax, kHalfMax}};
    if (p.choice("gamut_compression") == "yes") {
        stages.push_back(MatrixStage{rgb_to_rgb(kAP0, kAP1), "ap0_to_ap1"});
        stages.push_back(reference_gamut_compression());
        stages.push_back(MatrixStage{rgb_to_rgb(kAP1, kAP0), "ap1_to_ap0"});
    }
    stages.push_back(rrt_glow_and_red_modifier(is_ocio ? RrtSaturation::after_glow
                                                       : RrtSaturation::before_glow));
    stages.push_back(ClampStage{0, kInfinity});
    stages.push_back(MatrixStage{rgb_to_rgb(kAP0, kAP1), "ap0_to_ap1"});
    stages.push_back(ClampStage{0, is_ocio ? kInfinity : static_cast<double>(kHalfMax)});
    stages.push_back(MatrixStage{saturation_matrix(0.96, ap1_weights()), "rrt_saturation"});
    stages.push_back(named("tone_curve", curve_stage(tone_curve(form, is_ocio))));
    const Primaries limit = limiting_primaries(p, kAP1);
    if (form.is_hdr) return stages + hdr_light(limit, form.peak);
    if (form.is_video) {
        stages.push_back(dim_surround(is_ocio));
        stages.push_back(MatrixStage{saturation_matrix(0.93, ap1_weights()), "odt_saturation"});
    }
    if (is_limited) {
        stages.push_back(MatrixStage{rgb_to_rgb(kAP1, limit), "to_limit"});
        stages.push_back(ClampStage{0, 1});
    }
    return stages;
}

}  // namespace

std::vector<Operator> define_aces_13() {
    Operator op;
    op.id = "aces_13";
    op.title = "ACES 1.3";
    op.view = "ACES 1.3";
    op.character =
        "film look of ACES 1: strong contrast, mid gray at 0.104; bright saturated colors shift to "
        "yellow, cyan and magenta";
    op.source =
        "Academy of Motion Picture Arts and Sciences, aces-dev 1.3: RRT 1.0.3, ODT and RRTODT, "
        "LMT.Academy.ReferenceGamutCompress; OpenColorIO 2.1, built-in transforms ACES-OUTPUT";
    op.license =
        "Academy (free to use with its notice), BSD-3-Clause; formulas and constants only; none of "
        "their code is used";
    op.negatives =
        "kept by the glow and the red modifier in AP0, then clamped at 0 there and again in AP1; "
        "gamut_compression=yes first moves colors outside AP1 into it";
    op.dialects = "ACES";
    op.working = kAP0;
    // simd: AVX2 at 1000 cd/m2 for light of -25, 49, 38: 3.1e-5; AVX-512 keeps to 2e-5.
    op.bounds = {
        .simd = 4e-5,
        .simd_goal = 8e-6,
        .ocio_cpu = 3e-5,
        .ocio_gpu = 6e-5,
        .lut3d = 2e-3,
        .reason =
            "simd: twice as fast as with 1e-6; hdr: output up to 10, where a float has steps of "
            "1e-6; ctl: OpenColorIO's red modifier uses another saturation in dark colors"};
    ParameterSpec output = choice_parameter(
        "output", {"sdr_video", "sdr_cinema", "hdr_1000", "hdr_2000", "hdr_4000", "hdr_cinema"},
        "sdr_video",
        "sdr: 1 is display white, in a dim (video) or dark (cinema) surround; hdr: 1 is 100 cd/m2, "
        "and the number is the peak (hdr_cinema: 108 cd/m2)");
    output = display_parameter(std::move(output), [](const DisplayFacts& display) -> std::string {
        if (!display.is_hdr) return "sdr_video";
        if (display.peak >= 4000) return "hdr_4000";
        return display.peak >= 2000 ? "hdr_2000" : "hdr_1000";
    });
    ParameterSpec limit = limit_parameter({"none", "rec709", "p3d65", "rec2020"}, "rec709");
    limit.help += "; none: no limit, sdr output only; Blender uses p3d65 on Rec.2020 displays";
    op.parameters = {
        output,
        limit,
        choice_parameter(
            "gamut_compression", {"no", "yes"}, "no",
            "apply the reference gamut compression of ACES 1.3 first, for colors outside AP1"),
        choice_parameter(
            "spline", {"ocio", "ctl"}, "ocio",
            "ocio: the curve of OpenColorIO and its applications; ctl: the Academy's CTL"),
    };
    op.presets = {
        {"sdr_cinema",
         "cinema projector: white at 48 cd/m2, dark surround",
         {{"output", "sdr_cinema"}}},
        {"hdr_1000", "HDR display of 1000 cd/m2", {{"output", "hdr_1000"}}},
        {"ctl", "tone curve of the Academy's CTL", {{"spline", "ctl"}}},
        {"gamut_compressed",
         "reference gamut compression before the transform",
         {{"gamut_compression", "yes"}}},
    };
    op.warnings = {
        "hdr outputs tint grays near the peak slightly blue, because red reaches its limit first"};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 10, "hdr_1000"},
                      {DocumentedDifference::Kind::crushes_black, 0.00199, "ctl"}};
    op.build = build;
    op.output_primaries = [](const Params& p) {
        return form_of(p).is_hdr ? kRec2020 : limiting_primaries(p, kAP1);
    };
    op.peak = [](const Params& p) {
        constexpr double bluest = 1.09;  // what the adaptation to D65 makes of the limit's blue
        const Form& form = form_of(p);
        return form.is_hdr ? bluest * form.peak / 100 : 1;
    };
    return {op};
}

TONEWRIGHT_NAMESPACE_END
