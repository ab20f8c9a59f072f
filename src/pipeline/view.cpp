// SPDX-License-Identifier: Apache-2.0
#include "tonewright/view.h"

#include <algorithm>
#include <cmath>

namespace tonewright {
namespace {

/// Operator output -> display light, not limited above.
Pipeline decode_stages(const Operator& op) {
    if (op.output == OutputKind::display_linear) return {};
    const Expr x = Expr::input(0);
    // A curve may undershoot 0 (AgX's polynomials do); a power of a negative is no number.
    return {ClampStage{0, kInfinity},
            curve_stage(pow(x, op.code_power), pow(x, 1 / op.code_power))};
}

void append(Pipeline& to, const Pipeline& from) { to.insert(to.end(), from.begin(), from.end()); }

}  // namespace

View make_view(ResolvedOperator op, std::string_view input, double exposure_stops,
               std::string_view display) {
    if (!(std::fabs(exposure_stops) <= 64)) {
        throw Error("exposure is " + shortest(exposure_stops) + "; expected [-64, 64] stops");
    }
    View view{std::move(op), find_input_space(input).id, exposure_stops, std::string(display)};
    if (display != kLinearOutput && display != kNativeOutput)
        view.display = find_display(display).id;
    return view;
}

bool is_inside(const Primaries& gamut, const Primaries& display) {
    // Rec.709 and P3 share their blue: a coefficient that is 0 but for rounding.
    constexpr double kRounding = -1e-9;
    for (const auto& row : rgb_to_rgb(gamut, display)) {
        for (const double x : row) {
            if (x < kRounding) return false;
        }
    }
    return true;
}

Pipeline display_light_stages(const Operator& op, const Primaries& display) {
    Pipeline stages = decode_stages(op);
    // A gamut inside the display's is limited as its own: then every such display shows the same
    // colours. A wider one is limited where the display ends.
    if (is_inside(op.working, display)) stages.push_back(ClampStage{0, 1});
    if (!(display == op.working)) {
        stages.push_back(MatrixStage{rgb_to_rgb(op.working, display)});
        stages.push_back(ClampStage{0, 1});
    }
    return stages;
}

Pipeline build_view(const View& view) {
    const Operator& op = *view.op.op;
    Pipeline stages;
    Matrix3 to_working = rgb_to_rgb(find_input_space(view.input).primaries, op.working);
    stages.push_back(MatrixStage{scale(to_working, std::exp2(view.exposure_stops))});
    append(stages, view.op.build());
    if (view.display == kNativeOutput) return stages;
    if (view.display == kLinearOutput) {
        append(stages, decode_stages(op));
        stages.push_back(MatrixStage{rgb_to_rgb(op.working, kRec709)});
        return stages;
    }
    const Display& display = find_display(view.display);
    append(stages, display_light_stages(op, display.primaries));
    stages.push_back(curve_stage(display.encode, display.decode));
    return stages;
}

bool keeps_greys(const Pipeline& view) {
    const std::array<Expr, 3> rgb = compose(view);
    for (int half_stops = -32; half_stops <= 32; ++half_stops) {
        const double grey = 0.18 * std::exp2(half_stops / 2.0);
        const std::array<double, 3> in = {grey, grey, grey};
        const double r = evaluate(rgb[0], in);
        const double g = evaluate(rgb[1], in);
        const double b = evaluate(rgb[2], in);
        if (!(std::max({r, g, b}) - std::min({r, g, b}) <= 0.5 / 1023)) return false;
    }
    return true;
}

}  // namespace tonewright
