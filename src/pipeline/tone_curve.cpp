// SPDX-License-Identifier: Apache-2.0
#include "pipeline/tone_curve.h"
#include "base/format_number.h"
#include "tonewright/error.h"

#include <cmath>
#include <span>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Mantiuk et al. 2009, table 1: constants of the fit of saturation to contrast.
struct SaturationFit {
    double k1, k2;
};
constexpr SaturationFit kNonlinearFit = {1.6774, 0.9925};
constexpr SaturationFit kLuminancePreservingFit = {2.3892, 0.8552};

Matrix3 saturation_matrix(double s, const Vector3& weights) {
    Matrix3 m{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j)
            m[i][j] = (1 - s) * weights[j] + (i == j ? s : 0);
    }
    return m;
}

Stage saturation_stage(const Expr& s, const Vector3& weights) {
    if (s.is_constant()) return MatrixStage{saturation_matrix(s.value(), weights)};
    CrossTalkStage stage{{0, 0, 0}};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            const Expr entry = (1 - s) * weights[j] + (i == j ? s : Expr(0));
            stage.f[i] = stage.f[i] + entry * Expr::input(static_cast<int>(j));
        }
    }
    return stage;
}

/// The curve for norms: display-linear, and 0 at 0.
Expr norm_curve(const ToneCurve& curve, const std::string& apply) {
    // Rounding error of formulas that are 0 at 0.
    constexpr double kZero = 1e-7;
    const Expr black = 0;
    const Expr at_black = substitute(curve.f, std::span(&black, 1));
    if (at_black.is_constant() && at_black.value() > kZero) {
        throw Error("apply is " + apply + "; expected channels or hue_preserving: the curve is " +
                    shortest(at_black.value()) + " at black, and a factor cannot lift 0");
    }
    const Expr f = select(equal(at_black, 0), curve.f, max(curve.f, 0));
    return curve.code_power == 0 ? f : pow(f, curve.code_power);
}

/// Corrections that a norm and a matrix cannot express.
CrossTalkStage corrected(const Expr& f, const Params& params, const Vector3& w) {
    const std::array<Expr, 3> c = {Expr::input(0), Expr::input(1), Expr::input(2)};
    const Expr L = named("L", w[0] * c[0] + w[1] * c[1] + w[2] * c[2]);
    const Expr Lo = named("Lo", substitute(f, std::span(&L, 1)));
    const bool is_nonlinear = params.choice("color_correction") == "nonlinear";
    Expr s = params.expr("saturation");
    const bool is_live = !s.is_constant();
    if (params.choice("saturation_from") == "contrast") {
        const auto [k1, k2] = is_nonlinear ? kNonlinearFit : kLuminancePreservingFit;
        const Expr slope = derivative(f);
        const Expr contrast =
            named("contrast_here",
                  select(less(0, Lo), max(L * substitute(slope, std::span(&L, 1)) / Lo, 0), 0));
        const Expr fit = named("fit", k1 * pow(contrast, k2));
        s = named("s", s * ((1 + k1) * (fit / k1) / (1 + fit)));
    }
    const auto channel = [&](const Expr& v) {
        const Expr ratio = named("ratio", v / L);
        if (s.is_constant(0)) return select(less(0, L), Lo, 0);
        // 0^s is 0 for every s above 0, also if the curve is so flat that s rounds to 0.
        const Expr at_0 = is_live ? equal(params.expr("saturation"), 0) : 0;
        const Expr power =
            s.is_constant() ? pow(ratio, s) : select(less(0, v), pow(ratio, s), at_0);
        const Expr colored = is_nonlinear ? power : (ratio - 1) * s + 1;
        return select(less(0, L), colored * Lo, 0);
    };
    return {{channel(c[0]), channel(c[1]), channel(c[2])}};
}

Pipeline apply_norm(const ToneCurve& curve, const Params& params) {
    const std::string& apply = params.choice("apply");
    const Expr f = norm_curve(curve, apply);
    if (apply == "max") return {ToneScaleStage{ToneScaleStage::Norm::max_rgb, {}, f}};
    const ToneScaleStage scale{ToneScaleStage::Norm::luminance, curve.weights, f};
    const std::string& correction = params.choice("color_correction");
    if (correction == "ratio") return {scale};
    // ((C/L - 1) s + 1) f(L) with a constant s is linear in the result of the norm.
    if (correction == "luminance_preserving" && params.choice("saturation_from") == "fixed")
        return {scale, saturation_stage(params.expr("saturation"), curve.weights)};
    return {corrected(f, params, curve.weights)};
}

void check(const Params& params) {
    const std::string& apply = params.choice("apply");
    const std::string& correction = params.choice("color_correction");
    if (correction != "ratio" && apply != "luminance") {
        throw Error("color_correction is " + correction + "; expected ratio with apply=" + apply);
    }
    if (correction != "ratio") return;
    if (const Expr s = params.expr("saturation"); s.is_constant() && s.value() != 1) {
        throw Error("saturation is " + shortest(s.value()) +
                    "; expected 1 with color_correction=ratio");
    }
    if (params.choice("saturation_from") != "fixed") {
        throw Error("saturation_from is " + params.choice("saturation_from") +
                    "; expected fixed with color_correction=ratio");
    }
}

}  // namespace

std::vector<ParameterSpec> with_apply(std::string default_apply, std::vector<ParameterSpec> own) {
    own.push_back(choice_parameter(
        "apply", {"channels", "luminance", "max", "hue_preserving"}, std::move(default_apply),
        "how the curve f is applied; channels: f of each channel; luminance, max: all channels "
        "times f(n)/n, where n is the relative luminance or the largest channel; hue_preserving: f "
        "of the largest and smallest channels, between which the middle one keeps its place"));
    own.push_back(choice_parameter(
        "color_correction", {"ratio", "nonlinear", "luminance_preserving"}, "ratio",
        "with apply=luminance, where L becomes f(L); ratio: C/L f(L); nonlinear: (C/L)^s f(L); "
        "luminance_preserving: ((C/L - 1) s + 1) f(L) (Mantiuk et al. 2009)"));
    own.push_back(number_parameter("saturation", "", 1, 0, 2,
                                   "s of the color correction (1: as in the scene, 0: gray)"));
    own.push_back(choice_parameter("saturation_from", {"fixed", "contrast"}, "fixed",
                                   "fixed: s as given; contrast: s times the paper's fit to the "
                                   "curve's contrast at the pixel's luminance"));
    return own;
}

Pipeline apply_tone_curve(const ToneCurve& curve, const Params& params) {
    check(params);
    const std::string& apply = params.choice("apply");
    if (apply == "channels") {
        return {curve.inverse ? curve_stage(curve.f, *curve.inverse) : curve_stage(curve.f)};
    }
    if (apply == "hue_preserving") return {HuePreservingStage{curve.f}};
    Pipeline stages = apply_norm(curve, params);
    if (curve.code_power != 0) {
        stages.push_back(ClampStage{0, kInfinity});
        stages.push_back(curve_stage(pow(Expr::input(), 1 / curve.code_power)));
    }
    return stages;
}

TONEWRIGHT_NAMESPACE_END
