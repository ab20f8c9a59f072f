// SPDX-License-Identifier: Apache-2.0
#include "measure/photographs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "measure/chart_colors.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// A bin of the histogram: indices along its axes, and its pixels of a million.
struct Bin {
    std::uint8_t stops;
    std::uint8_t saturation;
    std::uint8_t hue;
    std::uint32_t count;
};
constexpr Bin kBins[] = {
#include "measure/photograph_density.inc"
};
// The axes of photograph_density.py.
constexpr double kDarkest = -13;
constexpr double kStep = 0.5;
constexpr std::array kSaturations = {0.0, 0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.4,
                                     0.5, 0.6,  0.7,  0.8,  0.9, 0.97, 1.0, 1.1, 1.5};
constexpr double kHues = 24;
constexpr double kMidGray = 0.18;

Vector3 draw(const Bin& bin, SampleRandom& random) {
    const double stops = kDarkest + kStep * (bin.stops + random.uniform(0, 1));
    const double saturation = std::lerp(kSaturations.at(bin.saturation),
                                        kSaturations.at(bin.saturation + 1U), random.uniform(0, 1));
    const double hue = (bin.hue + random.uniform(0, 1)) / kHues;
    return hue_color(hue, saturation, kMidGray * std::exp2(stops));
}

/// Sums of the counts, up to and with each bin.
const std::vector<double>& cumulated() {
    static const std::vector<double> sums = [] {
        std::vector<double> all;
        double sum = 0;
        for (const Bin& bin : kBins)
            all.push_back(sum += bin.count);
        return all;
    }();
    return sums;
}

}  // namespace

const PhotographColors& photograph_colors() {
    static const PhotographColors all = [] {
        // Every bin has one, so that no rare color is missed; frequent bins have more.
        constexpr double kColors = 40000;
        PhotographColors colors;
        SampleRandom random(1);
        const double total = cumulated().back();
        for (const Bin& bin : kBins) {
            const double share = bin.count / total;
            const double count = std::max(std::round(share * kColors), 1.0);
            for (int i = 0; i < static_cast<int>(count); ++i) {
                for (const double channel : draw(bin, random))
                    colors.rgb.push_back(static_cast<float>(channel));
                colors.share.push_back(share / count);
            }
        }
        return colors;
    }();
    return all;
}

std::vector<float> photograph_light(const Primaries& primaries) {
    const std::vector<float>& rgb = photograph_colors().rgb;
    const Matrix3 from_rec709 = rgb_to_rgb(kRec709, primaries);
    std::vector<float> light;
    light.reserve(rgb.size());
    for (std::size_t i = 0; i < rgb.size(); i += 3) {
        const Vector3 color = {static_cast<double>(rgb[i]), static_cast<double>(rgb[i + 1]),
                               static_cast<double>(rgb[i + 2])};
        for (const double channel : multiply(from_rec709, color))
            light.push_back(static_cast<float>(channel));
    }
    return light;
}

Vector3 draw_photograph_color(SampleRandom& random) {
    const std::vector<double>& sums = cumulated();
    const auto at = std::upper_bound(sums.begin(), sums.end() - 1, random.uniform(0, sums.back()));
    return draw(kBins[at - sums.begin()], random);
}

std::string description_of(const Vector3& rec709) {
    const auto [smallest, largest] = std::minmax_element(rec709.begin(), rec709.end());
    if (!(*largest > 0)) return "black";
    const double chroma = *largest - *smallest;
    const std::string stops = fmt::format("{:+.1f} stops", std::log2(*largest / kMidGray));
    const double saturation = chroma / *largest;
    constexpr double kGray = 0.05;
    if (saturation < kGray) return stops + ", gray";
    constexpr std::array kNames = {"red", "yellow", "green", "cyan", "blue", "magenta"};
    const auto [r, g, b] = rec709;
    double hue = (r - g) / chroma + 4;
    if (*largest == r)
        hue = (g - b) / chroma + 6;
    else if (*largest == g)
        hue = (b - r) / chroma + 2;
    const auto name = static_cast<std::size_t>(std::lround(hue)) % kNames.size();
    constexpr double kSaturated = 0.8;
    return fmt::format("{}, {}{}", stops, saturation > kSaturated ? "saturated " : "",
                       kNames.at(name));
}

TONEWRIGHT_NAMESPACE_END
