// SPDX-License-Identifier: Apache-2.0
//
// FFmpeg's filter tonemap, and its curve mobius.
//
// Source    FFmpeg 5.1.9, libavfilter/vf_tonemap.c, executed (Debian 7:5.1.9-0+deb12u1, float
//           planes). mobius also in mpv (tone-mapping=mobius) and libplacebo (tone_mapping.c).
//           Its hable: J. Hable, "Filmic Tonemapping Operators", filmicworlds.com, 2010-05-05.
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, 65504], negatives clamped
//           at 0 (the filter scales them with the other channels).
// Out       display-linear RGB, 1.0 = display peak. tonemap=clip [0, 1]; the others exceed 1 above
//           `peak`, none and linear and gamma without an upper bound.
// Kind      ffmpeg: with desat, 3D (towards the luminance L, by a weight that depends on L), then a
//           scale by the largest channel. mobius: as `apply` chooses, by default the largest
//           channel. Monotone on the neutral axis: yes.
// Keeps     0 -> 0; grays and colors with L up to desat, except for the weight 1e-6/L; f(peak) = 1
//           with gamma, reinhard, hable, mobius, and linear with its default parameter.
// Differs   The filter leaves desat out if the frame's matrix is unknown; here desat=0 does that.
//           Its floor of 1e-6 on the largest channel only prevents 0/0. Without the option peak the
//           filter reads the frame's metadata, and takes 10, or 100 for PQ, if there are none.
// Check     (2, 1, 0.5), peak 100, desat 0 -> red 0.673333 (reinhard), 0.113796 (gamma), 0.798312
//           (mobius); (100, 0, 0), peak 100, desat 2 -> (0.97596, 0.65569, 0.65569) (reinhard)
//           (engine executed; python_check/operators/ffmpeg.py).
#include <optional>

#include "base/format_number.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

ParameterSpec peak_parameter() {
    return number_parameter("peak", "scene-linear", 10, 1.01, kHalfMax,
                            "scene value shown as display white");
}

/// The identity up to j, and a hyperbola with the same slope from there to (peak, 1).
Expr mobius_curve(const Expr& j, const Expr& peak) {
    const Expr j2 = named("j2", j * j);
    const Expr a = named("a", -j2 * (peak - 1) / (j2 - 2 * j + peak));
    const Expr b = named("b", (j2 - 2 * j * peak + peak) / (peak - 1));
    const Expr scale = named("scale", (b * b + 2 * b * j + j2) / (b - a));
    const Expr x = Expr::input();
    const Expr above = named("above", max(x, j));
    return select(less(j, x), scale * (above + a) / (above + b), x);
}

Operator mobius() {
    Operator op;
    op.id = "mobius";
    op.title = "Mobius (mpv, FFmpeg)";
    op.view = "Mobius";
    op.character =
        "unchanged up to a knee, then a soft shoulder to the peak: exact midtones, compressed "
        "highlights";
    op.source = "FFmpeg 5.1.9, vf_tonemap.c: mobius; also in mpv and libplacebo";
    op.license = "LGPL-2.1+; formula only, none of its code is used";
    op.negatives = kNegativesClampAtZero;
    op.parameters =
        with_apply("max", {number_parameter("knee", "scene-linear", 0.3, 0.001, 0.99,
                                            "j: scene value up to which colors do not change"),
                           peak_parameter()});
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 1.1, ""}};
    op.build = [](const Params& p) -> Pipeline {
        return tone_curve_pipeline({.f = mobius_curve(p.expr("knee"), p.expr("peak"))}, p);
    };
    return op;
}

/// Colors move towards their luminance L, by the share max(L - desat, 1e-6)/L.
CrossTalkStage desaturation(double desat) {
    const std::array<Expr, 3> c = {Expr::input(0), Expr::input(1), Expr::input(2)};
    const Vector3& w = kRec709Weights;
    const Expr L = named("L", w[0] * c[0] + w[1] * c[1] + w[2] * c[2]);
    const Expr overbright = named("overbright", max(L - desat, 1e-6) / max(L, 1e-6));
    CrossTalkStage stage = named("desaturation", CrossTalkStage{c});
    for (Expr& channel : stage.f)
        channel = mix(channel, L, overbright);
    return stage;
}

/// The option param; 0 stands for the default of the curve.
double param_or(double usual, const Params& p) {
    const double param = p.number("param");
    return param == 0 ? usual : param;
}

/// @param highest  inclusive
double param_within(double usual, double highest, const Params& p) {
    const double param = param_or(usual, p);
    if (param > highest) {
        throw Error("param is " + shortest(param) + "; expected up to " + shortest(highest) +
                    " with tonemap=" + p.choice("tonemap"));
    }
    return param;
}

Expr uncharted(const Expr& x) {
    return (x * (0.15 * x + 0.10 * 0.50) + 0.20 * 0.02) / (x * (0.15 * x + 0.50) + 0.20 * 0.30) -
           0.02 / 0.30;
}

/// The curve on the largest channel, a function of input 0.
Expr curve_of(const Params& p) {
    const std::string& tonemap = p.choice("tonemap");
    const Expr x = Expr::input();
    const Expr peak = p.expr("peak");
    if (tonemap == "linear") return x * param_or(1, p) / peak;
    if (tonemap == "clip") return min(x * param_or(1, p), 1);
    if (tonemap == "hable") return uncharted(x) / named("at_peak", uncharted(peak));
    if (tonemap == "mobius") return mobius_curve(param_within(0.3, 0.99, p), peak);
    if (tonemap == "reinhard") {
        const double param = param_within(0.5, 1, p);
        const double offset = (1 - param) / param;
        return x / (x + offset) * (peak + offset) / peak;
    }
    constexpr double kLinearBelow = 0.05;
    const double power = 1 / param_or(1.8, p);
    const Expr above = named("above", pow(max(x, kLinearBelow) / peak, power));
    const Expr below = named("below", x * (pow(kLinearBelow / peak, power) / kLinearBelow));
    return select(less(kLinearBelow, x), above, below);
}

Operator ffmpeg() {
    Operator op;
    op.id = "ffmpeg";
    op.title = "FFmpeg tonemap";
    op.view = "FFmpeg Tonemap";
    op.character =
        "the filter of FFmpeg: bright colors fade to gray, then a curve on the largest channel, "
        "which keeps hue";
    op.source = "FFmpeg 5.1.9, libavfilter/vf_tonemap.c";
    op.license = "LGPL-2.1+; formula and constants only; none of its code is used";
    op.negatives = kNegativesClampAtZero;
    op.parameters = {
        choice_parameter("tonemap",
                         {"none", "linear", "gamma", "clip", "reinhard", "hable", "mobius"},
                         "hable", "curve on the largest channel; the filter's own default is none"),
        fixed_parameters({number_parameter(
            "param", "", 0, 0, 100,
            "param of the curve (0: its default, which is 1 for linear and clip, 1.8 for gamma, "
            "0.5 for reinhard, 0.3 for mobius)")})[0],
        fixed_parameters(
            {number_parameter("desat", "scene-linear", 2, 0, kHalfMax,
                              "luminance above which colors fade to gray (0: no color does)")})[0],
        peak_parameter()};
    for (const char* tonemap : {"none", "linear", "gamma", "clip", "reinhard", "hable", "mobius"})
        op.presets.push_back(
            {tonemap, std::string("tonemap=") + tonemap + " with desat=2", {{"tonemap", tonemap}}});
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 1.32, ""},
                      {DocumentedDifference::Kind::exceeds_white, kInfinity, "none"},
                      {DocumentedDifference::Kind::exceeds_white, kInfinity, "linear"},
                      {DocumentedDifference::Kind::exceeds_white, kInfinity, "gamma"},
                      {DocumentedDifference::Kind::exceeds_white, 1.1, "reinhard"},
                      {DocumentedDifference::Kind::exceeds_white, 1.1, "mobius"}};
    op.bounds = {.lut3d = 0.3,
                 .reason =
                     "the slope of the desaturation jumps at the luminance desat, and no node "
                     "of a 3D LUT is there; desat=0 needs no 3D LUT"};
    op.build = [](const Params& p) -> Pipeline {
        Pipeline stages = {limit_to_positive()};
        if (p.number("desat") > 0) {
            stages.emplace_back(desaturation(p.number("desat")));
            stages.emplace_back(limit_to_positive());  // no effect: a mix of channels from 0 up
        }
        if (p.choice("tonemap") != "none")
            stages.emplace_back(ToneScaleStage{ToneScaleStage::Norm::max_rgb, {}, curve_of(p)});
        return stages;
    };
    return op;
}

}  // namespace

std::vector<Operator> define_ffmpeg() { return {ffmpeg(), mobius()}; }

TONEWRIGHT_NAMESPACE_END
