// SPDX-License-Identifier: Apache-2.0
#include "ocio/round_trip.h"

#include <algorithm>
#include <cmath>
#include <utility>

TONEWRIGHT_NAMESPACE_BEGIN

double visible_error(double code, double light) {
    return std::min(code, kSrgbSlopeAtBlack * light);
}

namespace {

std::array<std::vector<double>, 3> planes_of(const std::vector<float>& rgb) {
    std::array<std::vector<double>, 3> planes;
    for (std::size_t c = 0; c < 3; ++c) {
        planes[c].resize(rgb.size() / 3);
        for (std::size_t i = 0; i < planes[c].size(); ++i)
            planes[c][i] = static_cast<double>(rgb[3 * i + c]);
    }
    return planes;
}

/// In place.
void run(const ReferenceEngine& engine, std::array<std::vector<double>, 3>& planes) {
    const std::array<double*, 3> at = {planes[0].data(), planes[1].data(), planes[2].data()};
    engine.run({at[0], at[1], at[2]}, at, planes[0].size());
}

}  // namespace

RoundTrip::RoundTrip(const View& view, const SampleSet& samples, std::size_t one_of)
    : engine_(build_view(view)), decode_(find_display(view.display).decode) {
    for (std::size_t i = 0; i < samples.size(); i += one_of) {
        if (!samples.is_non_negative(i) || samples.kind[i] == SampleKind::special) continue;
        codes_.insert(codes_.end(), &samples.rgb[3 * i], &samples.rgb[3 * i] + 3);
    }
    const Planes codes = show(codes_);
    for (std::size_t i = 0; i < codes_.size(); ++i)
        codes_[i] = static_cast<float>(codes[i % 3][i / 3]);
    light_ = light_of(planes_of(codes_));
}

RoundTrip::RoundTrip(const View& view, std::vector<float> codes)
    : engine_(build_view(view)),
      decode_(find_display(view.display).decode),
      codes_(std::move(codes)),
      light_(light_of(planes_of(codes_))) {}

RoundTrip::Result RoundTrip::measure(const Inverse& back) const {
    std::vector<float> scene(codes_.size());
    back(codes_.data(), scene.data(), codes_.size() / 3);
    const Planes again = show(scene);
    const Planes light_again = light_of(again);
    Result result;
    std::vector<double> errors(codes_.size() / 3);
    for (std::size_t i = 0; i < errors.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const auto before = static_cast<double>(codes_[3 * i + c]);
            errors[i] =
                std::max(errors[i], visible_error(std::fabs(again[c][i] - before),
                                                  std::fabs(light_again[c][i] - light_[c][i])));
            result.is_finite = result.is_finite && std::isfinite(scene[3 * i + c]);
        }
    }
    result.errors = summarise(errors);
    return result;
}

RoundTrip::Planes RoundTrip::show(const std::vector<float>& scene) const {
    Planes planes = planes_of(scene);
    run(engine_, planes);
    return planes;
}

RoundTrip::Planes RoundTrip::light_of(Planes codes) const {
    run(decode_, codes);
    return codes;
}

TONEWRIGHT_NAMESPACE_END
