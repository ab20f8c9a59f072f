// SPDX-License-Identifier: Apache-2.0
#include "ocio/fixed_functions.h"

#include <algorithm>
#include <cmath>

#include "operators/color_modifiers.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN

const std::vector<FixedFunctions>& all_fixed_functions() {
    static const std::vector<FixedFunctions> all = [] {
        using Compression = ReferenceGamutCompression;
        std::vector<double> compression(Compression::limit.begin(), Compression::limit.end());
        compression.insert(compression.end(), Compression::threshold.begin(),
                           Compression::threshold.end());
        compression.push_back(Compression::power);
        const std::vector<FixedFunctionOp> glow_and_red = {{"ACES_Glow10"}, {"ACES_RedMod10"}};
        return std::vector<FixedFunctions>{
            {reference_gamut_compression(), {{"ACES_GamutComp13", compression}}},
            {rrt_glow_and_red_modifier(RrtSaturation::after_glow), glow_and_red},
            // Differs in the saturation of dark colors, with all channels below 0.01.
            {rrt_glow_and_red_modifier(RrtSaturation::before_glow), glow_and_red, false},
            // Unreal and Filament also weight the hue differently, by at most 0.0074 from the
            // B-spline of the functions, in a change of red of at most 18 %.
            {ap1_glow_and_red_modifier(1e-10), glow_and_red, false, rgb_to_rgb(kAP1, kAP0)},
            {ap1_glow_and_red_modifier(1e-5), glow_and_red, false, rgb_to_rgb(kAP1, kAP0)},
        };
    }();
    return all;
}

const FixedFunctions* find_fixed_functions(const CrossTalkStage& stage) {
    const auto& all = all_fixed_functions();
    const auto found = std::find_if(all.begin(), all.end(), [&](const FixedFunctions& row) {
        return std::equal(row.stage.f.begin(), row.stage.f.end(), stage.f.begin(), same);
    });
    return found == all.end() ? nullptr : &*found;
}

namespace {

/// f(n) = gain n max(n, floor)^(gamma - 1).
struct FlooredPower {
    double gain;
    double floor;
    double gamma;

    [[nodiscard]] double operator()(double n) const {
        return gain * n * std::pow(std::max(n, floor), gamma - 1);
    }
};

std::optional<FlooredPower> find_floored_power(const Expr& f) {
    const double gain = evaluate(f, 1);
    const double gamma = std::log2(evaluate(f, 16) / gain) / 4;
    if (!(gain > 0) || !std::isfinite(gamma) || std::fabs(gamma - 1) < 1e-6) return std::nullopt;
    const double lowest = 0x1p-80;
    const double slope = evaluate(f, lowest) / lowest;
    const FlooredPower power = {gain, std::pow(slope / gain, 1 / (gamma - 1)), gamma};
    if (!(power.floor > 2 * lowest)) return std::nullopt;  // a power down to black
    for (double n = lowest; n < kHalfMax; n *= 1.3) {
        if (!(std::fabs(evaluate(f, n) - power(n)) <= 1e-12 * power(n))) return std::nullopt;
    }
    return power;
}

bool are_near(const Vector3& a, const Vector3& b) {
    return std::equal(a.begin(), a.end(), b.begin(),
                      [](double x, double y) { return std::fabs(x - y) < 1e-7; });
}

}  // namespace

std::optional<LoweredOps> find_fixed_function(const ToneScaleStage& stage) {
    if (stage.norm != ToneScaleStage::Norm::luminance) return std::nullopt;
    const auto power = find_floored_power(stage.f);
    if (!power) return std::nullopt;
    const auto is_near = [](double a, double b) { return std::fabs(a - b) <= 1e-9 * b; };

    FixedFunctionOp function;
    double own_floor = 0;
    if (are_near(stage.weights, {0.2627, 0.6780, 0.0593})) {
        function = {"REC2100_Surround", {power->gamma}};
        own_floor = 1e-4;
    } else if (are_near(stage.weights, ap1_weights()) && is_near(power->gamma, 0.9811)) {
        function = {"ACES_DarkToDim10"};
        own_floor = 1e-10;
    } else {
        return std::nullopt;
    }
    LoweredOps ops;
    const auto append_gain = [&](double gain) {
        if (!is_near(gain, 1)) ops.push_back({MatrixOp{scale(kIdentity3, gain)}});
    };
    const double before = own_floor / power->floor;
    append_gain(before);
    ops.push_back({function});
    append_gain(power->gain * std::pow(before, -power->gamma));
    return ops;
}

TONEWRIGHT_NAMESPACE_END
