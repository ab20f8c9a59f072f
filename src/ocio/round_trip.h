// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "measure/error_metric.h"
#include "measure/sample_set.h"
#include "tonewright/engine.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

inline constexpr double kSrgbSlopeAtBlack = 12.92;

/// Error of a code value, or of its display-linear value times sRGB's slope at black, whichever is
/// less. A display with a pure power has an infinite slope at black, where invisible differences
/// are many code values.
[[nodiscard]] double visible_error(double code, double light);

/// Measures the round trip: an inverse of a view's code values, then the view by the reference.
class RoundTrip {
  public:
    /// @param samples  scene-linear; colors with negative channels are left out
    /// @param one_of  uses every one_of-th sample
    RoundTrip(const View& view, const SampleSet& samples, std::size_t one_of = 1);
    /// @param codes  that the view makes
    RoundTrip(const View& view, std::vector<float> codes);

    /// Code values -> scene-linear in the view's input space, for a number of pixels.
    using Inverse = std::function<void(const float* in, float* out, std::size_t count)>;
    struct Result {
        ErrorStats errors;
        bool is_finite = true;
    };
    [[nodiscard]] Result measure(const Inverse& back) const;

  private:
    /// One plane per channel, as below.
    using Planes = std::array<std::vector<double>, 3>;
    [[nodiscard]] Planes show(const std::vector<float>& scene) const;
    [[nodiscard]] Planes light_of(Planes codes) const;

    ReferenceEngine engine_;
    ReferenceEngine decode_;
    std::vector<float> codes_;
    Planes light_;
};

TONEWRIGHT_NAMESPACE_END
