// SPDX-License-Identifier: Apache-2.0
#include "measure/chart_colors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

TONEWRIGHT_NAMESPACE_BEGIN

Vector3 hue_color(double hue, double saturation, double value) {
    const auto channel = [&](double offset) {
        const double t = std::fmod(hue * 6 + offset, 6.0);
        const double k = std::clamp(std::fabs(t - 3) - 1, 0.0, 1.0);
        return value * (1 - saturation * (1 - k));
    };
    return {channel(0), channel(4), channel(2)};
}

std::vector<NamedColor> chart_colors() {
    constexpr std::array<const char*, 6> kNames = {"red",  "yellow", "green",
                                                   "cyan", "blue",   "magenta"};
    constexpr std::array<const char*, 12> kHueNames = {
        "red",  "orange", "yellow", "yellow-green", "green",   "blue-green",
        "cyan", "azure",  "blue",   "violet",       "magenta", "crimson"};
    constexpr std::array<const char*, 4> kTintNames = {"gray", "light skin", "orange", "deep blue"};
    constexpr std::array<const char*, 4> kLampNames = {"red", "green", "blue", "neon magenta"};
    std::vector<NamedColor> colors;
    for (const double saturation : {1.0, 0.5}) {
        // The sweeps are continuous; operators bend most along the faces of a gamut.
        const int hues = saturation == 1.0 ? 72 : 24;
        for (int i = 0; i < hues; ++i) {
            const double hue = static_cast<double>(i) / hues;
            const auto nearest = static_cast<std::size_t>(std::lround(12 * hue)) % kHueNames.size();
            colors.push_back({fmt::format("{} (hue {:.0f} degrees, saturation {})",
                                          kHueNames.at(nearest), 360 * hue, saturation),
                              hue_color(hue, saturation, 1)});
        }
    }
    for (const Primaries* gamut : {&kP3D65, &kRec2020}) {
        const Matrix3 to_rec709 = rgb_to_rgb(*gamut, kRec709);
        for (std::size_t i = 0; i < kNames.size(); ++i) {
            colors.push_back({fmt::format("{} of {}", kNames[i], gamut->name),
                              multiply(to_rec709, hue_color(static_cast<double>(i) / 6, 1, 1))});
        }
    }
    for (std::size_t i = 0; i < kGradientTints.size(); ++i)
        colors.push_back({kTintNames[i], kGradientTints[i]});
    for (std::size_t i = 0; i < kLamps.size(); ++i) {
        const Vector3& lamp = kLamps[i];
        const double largest = std::max({lamp[0], lamp[1], lamp[2]});
        colors.push_back({fmt::format("{} lamp", kLampNames[i]),
                          {lamp[0] / largest, lamp[1] / largest, lamp[2] / largest}});
    }
    return colors;
}

TONEWRIGHT_NAMESPACE_END
