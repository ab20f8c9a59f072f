// SPDX-License-Identifier: Apache-2.0
#include "tonewright/view.h"
#include "base/format_number.h"
#include "base/strings.h"
#include "pipeline/exposure.h"
#include "pipeline/invert.h"

#include <algorithm>
#include <cmath>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Operator output -> display-linear, not limited above.
Pipeline decode_stages(const ResolvedOperator& resolved) {
    const Operator& op = *resolved.op;
    if (resolved.output() == OutputKind::display_linear) return {};
    if (const std::string name = resolved.output_display(); !name.empty()) {
        const Display& display = find_display(name);
        Pipeline stages = {ClampStage{0, display.is_hdr ? 1 : kInfinity}};
        stages.insert(stages.end(), display.decode.begin(), display.decode.end());
        return stages;
    }
    const Expr x = Expr::input(0);
    // A curve may undershoot 0 (AgX's polynomials do), and powers of negatives are NaN.
    return {ClampStage{0, kInfinity},
            named("decode", curve_stage(pow(x, op.code_power), pow(x, 1 / op.code_power)))};
}

void append(Pipeline& to, const Pipeline& from) { to.insert(to.end(), from.begin(), from.end()); }

Pipeline exposed_input(const View& view, bool is_exposure_live) {
    const Expr exposure = is_exposure_live ? exp2(Expr::uniform(std::string(kExposureUniform)))
                                           : Expr(std::exp2(view.exposure_stops));
    return exposed_stages(view.input_decode, view.input_scale * exposure);
}

}  // namespace

Pipeline exposed_stages(const Pipeline& decode, const Expr& factor) {
    Pipeline stages = decode;
    const bool is_linear = stages.empty();
    if (!factor.is_constant()) {
        stages.push_back(named("expose", curve_stage(Expr::input() * factor)));
    } else if (factor.value() != 1) {
        stages.push_back(MatrixStage{scale(kIdentity3, factor.value()), "expose"});
    } else if (is_linear) {
        return stages;
    }
    stages.push_back(ClampStage{-kHalfMax, kHalfMax, is_linear});
    return stages;
}

InputUnits parse_input_units(std::string_view text) {
    constexpr InputUnits kUnits[] = {InputUnits::relative, InputUnits::luminance};
    return kUnits[find_choice("input_units", text, {"relative", "cd/m2"})];
}

SourceColor in_units(SourceColor source, InputUnits units) {
    if (units == InputUnits::relative || source.is_absolute) return source;
    source.is_absolute = true;
    source.scale /= kUnitLuminance;
    return source;
}

double scene_scale(const SourceColor& source, double reference_white) {
    return source.scale * (source.is_absolute ? kUnitLuminance / reference_white : 1);
}

void check_exposure(double stops) {
    if (!(std::fabs(stops) <= 64))
        throw Error("exposure is " + shortest(stops) + "; expected [-64, 64] stops");
}

View make_view(ResolvedOperator op, std::string_view input, double exposure_stops,
               std::string_view display, double reference_white) {
    const InputSpace& space = find_input_space(input);
    return make_view(std::move(op), SourceColor{space.id, space.primaries}, exposure_stops, display,
                     reference_white);
}

View make_view(ResolvedOperator op, SourceColor input, double exposure_stops,
               std::string_view display, double reference_white) {
    check_exposure(exposure_stops);
    if (!(reference_white >= 50 && reference_white <= 1000)) {
        throw Error("reference white is " + shortest(reference_white) +
                    "; expected [50, 1000] cd/m2");
    }
    const bool is_absolute = input.is_absolute;
    const double input_scale = scene_scale(input, reference_white);
    View view{std::move(op),   std::move(input.name), exposure_stops,          std::string(display),
              reference_white, input.primaries,       std::move(input.decode), input_scale};
    for (const std::string_view output : {kLinearOutput, kNativeOutput}) {
        if (is_same_name(display, output)) view.display = output;
    }
    const bool is_display = view.display != kLinearOutput && view.display != kNativeOutput;
    if (reference_white != kUnitLuminance && !is_absolute &&
        !(is_display && find_display(display).is_hdr)) {
        throw Error("reference white is " + shortest(reference_white) + "; expected " +
                    shortest(kUnitLuminance) + " with display " + std::string(display) +
                    ", which is not an HDR display, and input " + view.input +
                    ", which is not in cd/m2");
    }
    if (!is_display) return view;
    const std::vector<std::string> others{std::string(kLinearOutput), std::string(kNativeOutput)};
    const Display& found = find_display(display, others);
    view.display = found.id;
    const double unit = found.is_hdr ? kUnitLuminance / reference_white : 1;
    view.op = resolve_for_display(view.op, {found.primaries, found.is_hdr, found.peak * unit});
    return view;
}

bool is_inside(const Primaries& gamut, const Primaries& display) {
    // Rec.709 and P3 share their blue: this coefficient is 0 except for rounding.
    constexpr double kRounding = -1e-9;
    for (const auto& row : rgb_to_rgb(gamut, display)) {
        for (const double x : row) {
            if (x < kRounding) return false;
        }
    }
    return true;
}

DisplayLimit display_limit(const ResolvedOperator& op, const Display& display) {
    const Primaries own = op.output_primaries();
    return {is_inside(own, display.primaries) ? own : display.primaries,
            std::min(op.peak(), display.largest_light)};
}

Pipeline display_light_stages(const ResolvedOperator& op, const DisplayLimit& limit) {
    Pipeline stages = decode_stages(op);
    if (!(limit.primaries == op.output_primaries()))
        stages.push_back(
            MatrixStage{rgb_to_rgb(op.output_primaries(), limit.primaries), "to_limit"});
    stages.push_back(ClampStage{0, limit.peak});
    return stages;
}

Pipeline build_view(const View& view) { return build_live_view(view, {}); }

Pipeline build_live_view(const View& view, const std::vector<std::string>& uniforms) {
    const Operator& op = *view.op.op;
    std::vector<std::string> parameters = uniforms;
    const bool is_exposure_live = std::erase(parameters, kExposureUniform) > 0;
    Pipeline stages = exposed_input(view, is_exposure_live);
    stages.push_back(MatrixStage{rgb_to_rgb(view.input_primaries, op.working), "to_working"});
    append(stages, parameters.empty() ? view.op.build() : build_live(view.op, parameters));
    if (view.display == kNativeOutput) return stages;
    if (view.display == kLinearOutput) {
        append(stages, decode_stages(view.op));
        stages.push_back(MatrixStage{rgb_to_rgb(view.op.output_primaries(), kRec709), "to_rec709"});
        return stages;
    }
    const Display& display = find_display(view.display);
    const bool is_same_white = view.reference_white == kUnitLuminance;
    if (view.op.output_display() == display.id && is_same_white) {
        // The operator's own display: no conversion of its code values.
        stages.push_back(ClampStage{0, 1});
        return stages;
    }
    const DisplayLimit limit = display_limit(view.op, display);
    append(stages, display_light_stages(view.op, limit));
    if (!(limit.primaries == display.primaries)) {
        stages.push_back(MatrixStage{rgb_to_rgb(limit.primaries, display.primaries), "to_display"});
        stages.push_back(ClampStage{0, limit.peak});
    }
    if (display.is_hdr && !is_same_white) {
        stages.push_back(MatrixStage{scale(kIdentity3, view.reference_white / kUnitLuminance)});
        stages.push_back(ClampStage{0, display.largest_light});
    }
    append(stages, display.encode);
    return stages;
}

Pipeline build_inverse_view(const View& view) {
    const Operator& op = *view.op.op;
    const auto inverse = [&] {
        try {
            return op.build_inverse ? op.build_inverse(view.op.params)
                                    : invert_stages(view.op.build());
        } catch (const Error& e) {
            throw Error(op.name() + " has no inverse: " + e.text());
        }
    };
    Pipeline stages;
    const Primaries own = view.op.output_primaries();
    if (view.display == kLinearOutput) {
        stages.push_back(MatrixStage{rgb_to_rgb(kRec709, own)});
    } else if (view.display != kNativeOutput) {
        const Display& display = find_display(view.display);
        stages = display.decode;
        stages.push_back(MatrixStage{
            scale(rgb_to_rgb(display.primaries, own), kUnitLuminance / view.reference_white)});
    }
    if (view.display != kNativeOutput && view.op.output() == OutputKind::code_value) {
        const std::string own_display = view.op.output_display();
        if (own_display.empty()) {
            stages.push_back(curve_stage(power_encode(Expr::input(), op.code_power)));
        } else {
            append(stages, find_display(own_display).encode);
        }
    }
    append(stages, inverse());
    const Matrix3 to_input = rgb_to_rgb(op.working, view.input_primaries);
    stages.push_back(
        MatrixStage{scale(to_input, std::exp2(-view.exposure_stops) / view.input_scale)});
    return stages;
}

bool keeps_grays(const Pipeline& view) {
    const std::array<Expr, 3> rgb = compose(view);
    for (int half_stops = -32; half_stops <= 32; ++half_stops) {
        const double gray = 0.18 * std::exp2(half_stops / 2.0);
        const std::array<double, 3> in = {gray, gray, gray};
        const double r = evaluate(rgb[0], in);
        const double g = evaluate(rgb[1], in);
        const double b = evaluate(rgb[2], in);
        if (!(std::max({r, g, b}) - std::min({r, g, b}) <= 0.5 / 1023)) return false;
    }
    return true;
}

TONEWRIGHT_NAMESPACE_END
