// SPDX-License-Identifier: Apache-2.0
//
// Unreal Engine 4.15 and later: the filmic curve in log10, between the RRT's modifiers.
//
// Source    Epic Games, FilmToneMap of TonemapCommon.ush, Unreal Engine 4.15 and later, as facts:
//           its text is under the Epic license, and none of it is here.
// In        scene-linear RGB, working primaries AP1 (ACEScg); domain [0, inf), negatives clamped at
//           0.
// Out       display-linear RGB in AP1, 1.0 = display peak; range [0, 1 + white_clip).
// Kind      matrix, curve, matrix; with glow_and_red=on a 3D stage before them. Monotone on the
//           neutral axis: yes with the defaults.
// Keeps     mid gray 0.18 -> 0.18 for every slope and toe, if the shoulder begins above it; 0 -> 0
//           (with black_clip above 0, more than black is shown as 0).
// Differs   The source takes log10 of its input and blends toe, line and shoulder with weights of 0
//           outside their segments; at black that is 0 times infinity. Here each segment is a
//           rational in a power of x, u/(1 + u), and is evaluated only where it has weight, so
//           black is the limit of the toe, -black_clip, clamped to 0. BlueCorrection, ExpandGamut
//           and ToneCurveAmount, which the engine applies before and after it, are not included.
//           Toe 1 without black_clip and shoulder 1 without white_clip leave no toe or shoulder,
//           which is an error. The preset legacy has the numbers of the documentation, from memory.
// Check     mid gray 0.18 -> 0.18, (0.8, 0.1, 0.05) in AP1 -> red 0.582348314 (check_values.json).
#include <algorithm>
#include <cmath>

#include "base/format_number.h"
#include "operators/color_modifiers.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// One s-shaped arm, level * 2u/(1 + u) with u = (x/x0)^power: a logistic function of log x. Its
/// value at x0 is `level`, half its height.
Expr arm(double level, const Expr& u) { return 2 * level * (u / (1 + u)); }

/// The source's names: ts, ss are half the heights of toe and shoulder; tm, sm the log10 of the
/// inputs at half height; st the offset of the line.
Expr film_curve(double slope, double toe, double shoulder, double black_clip, double white_clip) {
    const double ts = 1 + black_clip - toe;
    const double ss = 1 + white_clip - shoulder;
    if (!(ts > 0)) {
        throw Error("toe is " + shortest(toe) +
                    "; expected below 1 + black_clip = " + shortest(1 + black_clip));
    }
    if (!(ss > 0)) {
        throw Error("shoulder is " + shortest(shoulder) +
                    "; expected below 1 + white_clip = " + shortest(1 + white_clip));
    }
    constexpr double kMidGray = 0.18;  // in and out
    const double mid = std::log10(kMidGray);
    const bool is_long_toe = toe > 0.8;
    // Height of mid gray as a fraction of the toe's height 2 ts.
    const double gray_in_toe = (kMidGray + black_clip) / ts / 2;
    const double tm = is_long_toe
                          ? (1 - toe - kMidGray) / slope + mid
                          : mid - 0.5 * std::log(gray_in_toe / (1 - gray_in_toe)) * ts / slope;
    const double st = (1 - toe) / slope - tm;
    const double sm = shoulder / slope - st;

    const Expr x = Expr::input();
    constexpr double top = 6;  // no input reaches 10^6
    const double toe_power = 2 * slope / ts / std::log(10.0);
    const double shoulder_power = 2 * slope / ss / std::log(10.0);
    // Both arms start from a point that fits a float: mid gray for a short toe (tm may be 10^230),
    // tm for a long toe, where it is below mid gray.
    const Expr u =
        named("u", is_long_toe ? pow(min(x, std::pow(10, tm)) / std::pow(10, tm), toe_power)
                               : gray_in_toe / (1 - gray_in_toe) * pow(x / kMidGray, toe_power));
    Expr toe_part = named("toe_part", arm(ts, u) - black_clip);
    if (std::min(tm, sm) >= top) return toe_part;

    const double x_shoulder = std::pow(10, std::min(sm, top));
    const Expr shoulder_part =
        named("shoulder_part",
              1 + white_clip - arm(ss, pow(x_shoulder / max(x, x_shoulder), shoulder_power)));
    if (sm < tm) {
        // No linear segment: toe and shoulder blend into each other.
        const Expr l = named("log_light", log2(max(x, x_shoulder)) * std::log10(2.0));
        return mix(toe_part, shoulder_part, smoothstep(sm, tm, l));
    }
    const double x_toe = std::pow(10, tm);
    const Expr line = named("straight", slope * (log2(max(x, x_toe)) * std::log10(2.0) + st));
    const Expr above =
        named("above", sm < top ? select(less(x_shoulder, x), shoulder_part, line) : line);
    return select(less(x, x_toe), toe_part, above);
}

}  // namespace

std::vector<Operator> define_unreal() {
    Operator op;
    op.id = "unreal";
    op.title = "Unreal Engine (filmic)";
    op.view = "Unreal Filmic";
    op.character =
        "ACES look with adjustable toe and shoulder, fixed mid gray; its white is a little above "
        "display white";
    op.source = "Epic Games, FilmToneMap of TonemapCommon.ush, Unreal Engine 4.15 and later";
    op.license = "Epic EULA; formula and constants as facts; none of its code is used";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Unreal";
    op.bounds = {.lut3d = 7e-3,
                 .reason = "OpenColorIO's fixed functions weight hues near red differently"};
    op.working = kAP1;
    op.parameters = fixed_parameters({
        number_parameter("slope", "", 0.88, 0.01, 1, "slope of the linear segment, per log10"),
        number_parameter("toe", "", 0.55, 0.01, 1, "share of the range that is toe"),
        number_parameter("shoulder", "", 0.26, 0.01, 1, "share of the range that is shoulder"),
        number_parameter("black_clip", "display-linear", 0, 0, 1,
                         "distance from black down to the end of the toe"),
        number_parameter("white_clip", "display-linear", 0.04, 0, 1,
                         "distance from white up to the end of the shoulder"),
        choice_parameter("glow_and_red", {"on", "off"}, "on",
                         "apply the glow and the red modifier of the ACES rendering transform in "
                         "AP0, before the curve"),
    });
    op.presets = {{"legacy",
                   "close to the tone mapper of Unreal Engine 4 before 4.15",
                   {{"slope", "0.98"},
                    {"toe", "0.3"},
                    {"shoulder", "0.22"},
                    {"black_clip", "0"},
                    {"white_clip", "0.025"}}}};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 1.04, ""},
                      {DocumentedDifference::Kind::exceeds_white, 1.025, "legacy"}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr f = film_curve(p.number("slope"), p.number("toe"), p.number("shoulder"),
                                  p.number("black_clip"), p.number("white_clip"));
        Pipeline stages = {limit_to_positive()};
        if (p.choice("glow_and_red") == "on") {
            stages.push_back(ap1_glow_and_red_modifier(1e-10));
            stages.push_back(ClampStage{0, kInfinity});
        }
        stages.push_back(MatrixStage{saturation_matrix(0.96, ap1_weights()), "rrt_saturation"});
        stages.push_back(named("film_curve", curve_stage(f)));
        stages.push_back(MatrixStage{saturation_matrix(0.93, ap1_weights()), "odt_saturation"});
        stages.push_back(ClampStage{0, kInfinity});
        return stages;
    };
    return {op};
}

TONEWRIGHT_NAMESPACE_END
