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

/// An error of a code value, or of its light in units in which sRGB's slope at black turns it into
/// code values, whichever is less: a display with a pure power has an infinite slope there, where
/// light too faint to see is many code values.
[[nodiscard]] double visible_error(double code, double light);

/// How far code values that a view makes are from themselves after an inverse and the view once
/// more, by the reference.
class RoundTrip {
  public:
    /// @param samples  scene light; what has negative channels is left out
    /// @param one_of  so many of them, one is taken
    RoundTrip(const View& view, const SampleSet& samples, std::size_t one_of = 1);
    /// @param codes  that the view makes
    RoundTrip(const View& view, std::vector<float> codes);

    /// Code values -> scene light in the view's input space, of so many pixels.
    using Inverse = std::function<void(const float* in, float* out, std::size_t count)>;
    struct Result {
        ErrorStats errors;
        bool is_finite = true;
    };
    [[nodiscard]] Result measure(const Inverse& back) const;

  private:
    /// A plane for each channel, as the next.
    using Planes = std::array<std::vector<double>, 3>;
    [[nodiscard]] Planes show(const std::vector<float>& scene) const;
    [[nodiscard]] Planes light_of(Planes codes) const;

    ReferenceEngine engine_;
    ReferenceEngine decode_;
    std::vector<float> codes_;
    Planes light_;
};

TONEWRIGHT_NAMESPACE_END
