// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/format_number.h"
#include "tonewright/engine.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr double kMidGray = 0.18;
constexpr double kSeen = 1.0 / 1023;
constexpr int kStepsPerStop = 16;

double stops_of(double light) { return std::log2(light / kMidGray); }

/// Stops at which half floats end.
double brightest() { return stops_of(kHalfMax); }
double darkest() { return stops_of(0x1p-24); }

/// Change of the displayed color if its scene value is clamped to [lo, hi].
double change(const ReferenceEngine& engine, const Vector3& rgb, double lo, double hi) {
    Vector3 kept = rgb;
    for (double& channel : kept)
        channel = std::clamp(channel, lo, hi);
    const Vector3 all = engine(rgb);
    const Vector3 clipped = engine(kept);
    double largest = 0;
    for (std::size_t c = 0; c < 3; ++c)
        largest = std::max(largest, std::fabs(all[c] - clipped[c]));
    return largest;
}

}  // namespace

LutClipping measure_clipping(const LutRequest& request, const Lut& lut) {
    LutClipping clipping;
    if (lut.is_half_domain) return clipping;
    const ReferenceEngine engine(build_view(request.view));
    const Matrix3 from_rec709 = rgb_to_rgb(kRec709, find_input_space(request.view.input).primaries);
    const double lo = request.encoding.scene_lo;
    const double hi = request.encoding.scene_hi;
    const auto note = [](std::optional<ClippedStops>& side, double end, double stops, double error,
                         bool is_above) {
        if (!(error > kSeen)) return;
        if (!side) side = {end, stops, 0};
        side->last = is_above ? std::max(side->last, stops) : std::min(side->last, stops);
        side->error = std::max(side->error, error);
    };
    for (int i = 0;; ++i) {
        const double stops = stops_of(hi) + static_cast<double>(i) / kStepsPerStop;
        if (!(stops <= brightest())) break;
        for (unsigned mask = 1; mask < 8; ++mask) {
            const double light = kMidGray * std::exp2(stops);
            const Vector3 rec709 = {mask & 1 ? light : 0, mask & 2 ? light : 0,
                                    mask & 4 ? light : 0};
            Vector3 rgb = multiply(from_rec709, rec709);
            // The brightest channel is at that stop, in any primaries.
            const double largest = *std::max_element(rgb.begin(), rgb.end());
            for (double& channel : rgb)
                channel *= light / largest;
            note(clipping.above, stops_of(hi), stops, change(engine, rgb, -kInfinity, hi), true);
        }
    }
    for (int i = 0; lo > 0; ++i) {
        const double stops = stops_of(lo) - static_cast<double>(i) / kStepsPerStop;
        if (!(stops >= darkest())) break;
        const double light = kMidGray * std::exp2(stops);
        note(clipping.below, stops_of(lo), stops,
             change(engine, {light, light, light}, lo, kInfinity), false);
    }
    return clipping;
}

std::string to_string(const LutClipping& clipping) {
    constexpr double kStep = 1.0 / kStepsPerStop;
    std::string text;
    if (clipping.above) {
        const std::string last = clipping.above->last > brightest() - kStep
                                     ? "without end"
                                     : fmt::format("up to {:+.2f}", clipping.above->last);
        text += fmt::format("above {:+.2f} stops from 0.18, {}, by up to {}", clipping.above->end,
                            last, rounded_up(clipping.above->error));
    }
    if (clipping.below) {
        const std::string last = clipping.below->last < darkest() + kStep
                                     ? "down to black"
                                     : fmt::format("down to {:+.2f}", clipping.below->last);
        text += fmt::format("{}below {:+.2f} stops{}, {}, by up to {}", text.empty() ? "" : "; ",
                            clipping.below->end, text.empty() ? " from 0.18" : "", last,
                            rounded_up(clipping.below->error));
    }
    return text;
}

TONEWRIGHT_NAMESPACE_END
