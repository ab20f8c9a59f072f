// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "base/random.h"
#include "tonewright/color.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Colors of photographs and renders, scene-linear Rec.709, interleaved RGB, each with its share of
/// their pixels. Shares add up to 1. The colors are spread evenly over the bins of a histogram of
/// many pictures (photograph_density.py), so rare ones are there, too.
struct PhotographColors {
    std::vector<float> rgb;
    std::vector<double> share;
};
[[nodiscard]] TONEWRIGHT_API const PhotographColors& photograph_colors();
/// The same colors as light of other primaries, interleaved RGB.
[[nodiscard]] TONEWRIGHT_API std::vector<float> photograph_light(const Primaries& primaries);

/// A random color of that histogram.
[[nodiscard]] TONEWRIGHT_API Vector3 draw_photograph_color(SampleRandom& random);

/// "+3.4 stops, saturated blue": the largest channel in stops from 0.18, and the hue.
[[nodiscard]] TONEWRIGHT_API std::string description_of(const Vector3& rec709);

TONEWRIGHT_NAMESPACE_END
