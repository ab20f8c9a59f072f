// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/typedesc.h>

#include <algorithm>
#include <cstddef>

#include "picture/png_chunks.h"
#include "tonewright/engine.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Measures the light of rows that hold code values of an HDR display.
class LightLevelMeter {
  public:
    explicit LightLevelMeter(const Display& display) : to_light_(display.decode) {}

    /// @param pixels  interleaved
    /// @param type    of the file, whose rounded values count
    /// @param alpha   -1: none
    void add(const float* pixels, std::size_t count, std::size_t channels,
             const OIIO::TypeDesc& type, int alpha);
    [[nodiscard]] LightLevels levels() const {
        return {largest_ * kUnitLuminance, sum_ / std::max(count_, 1.0) * kUnitLuminance};
    }

  private:
    SimdEngine to_light_;
    double largest_ = 0;
    double sum_ = 0;
    double count_ = 0;
};

TONEWRIGHT_NAMESPACE_END
