// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Error bound of RayFit along the rays: less than kLargestRayError, because other colors lie
/// between the rays.
inline constexpr double kFittedRayError = 0.7 * kLargestRayError;

/// Which bounds a 3D LUT gets.
struct RayBounds {
    /// Falls along the rays: less than kLargestFall, because other colors lie between the rays.
    double largest_fall = 0.85 * kLargestFall;
    /// Each channel within kFittedRayError of the operator.
    bool has_band = false;
};

/// Which nodes move.
enum class RayNodes : std::uint8_t {
    all,
    /// Most those that photographs do not use; grays stay.
    unused,
};

/// Rays of rising exposure of all hues and saturations of Rec.709, P3 and Rec.2020.
class RayFit {
  public:
    /// @param lut  of the size that fit() gets
    RayFit(const Lut& lut, const LutRequest& request, LutInterpolation interpolation,
           RayNodes nodes);
    ~RayFit();
    RayFit(const RayFit&) = delete;
    RayFit& operator=(const RayFit&) = delete;

    /// Makes the smallest changes to the nodes so that the LUT follows the operator along the rays:
    /// falling only where the operator falls, and within the band. Rays that cannot meet the bounds
    /// keep the result of 128 rounds.
    void fit(Lut& lut, const RayBounds& bounds) const;

  private:
    struct Prepared;
    std::unique_ptr<const Prepared> prepared_;
};

TONEWRIGHT_NAMESPACE_END
