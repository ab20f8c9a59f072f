// SPDX-License-Identifier: Apache-2.0
#include "ocio/round_trip.h"

#include <algorithm>
#include <cmath>

TONEWRIGHT_NAMESPACE_BEGIN

double visible_error(double code, double light) {
    constexpr double kSrgbSlopeAtBlack = 12.92;
    return std::min(code, kSrgbSlopeAtBlack * light);
}

RoundTrip::RoundTrip(const View& view, const SampleSet& samples, std::size_t one_of)
    : engine_(build_view(view)), decode_(find_display(view.display).decode) {
    for (std::size_t i = 0; i < samples.size(); i += one_of) {
        if (!samples.is_non_negative(i) || samples.kind[i] == SampleKind::special) continue;
        codes_.insert(codes_.end(), &samples.rgb[3 * i], &samples.rgb[3 * i] + 3);
    }
    const std::vector<double> codes = show(codes_);
    codes_.assign(codes.begin(), codes.end());
}

RoundTrip::Result RoundTrip::measure(const WayBack& back) const {
    std::vector<float> scene(codes_.size());
    back(codes_.data(), scene.data(), codes_.size() / 3);
    const std::vector<double> again = show(scene);
    Result result;
    std::vector<double> errors;
    for (std::size_t i = 0; i < codes_.size(); i += 3) {
        const Vector3 before = {static_cast<double>(codes_[i]), static_cast<double>(codes_[i + 1]),
                                static_cast<double>(codes_[i + 2])};
        const Vector3 after = {again[i], again[i + 1], again[i + 2]};
        const Vector3 light_before = decode_(before);
        const Vector3 light_after = decode_(after);
        double worst = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            worst = std::max(worst, visible_error(std::fabs(after[c] - before[c]),
                                                  std::fabs(light_after[c] - light_before[c])));
            result.is_finite = result.is_finite && std::isfinite(scene[i + c]);
        }
        errors.push_back(worst);
    }
    result.errors = summarise(errors);
    return result;
}

std::vector<double> RoundTrip::show(const std::vector<float>& scene) const {
    std::vector<double> codes(scene.size());
    engine_.run_rgb(scene.data(), codes.data(), scene.size() / 3);
    return codes;
}

TONEWRIGHT_NAMESPACE_END
