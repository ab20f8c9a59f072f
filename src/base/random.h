// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Fixed-seed generator (SplitMix64, Steele et al. 2014): the same numbers with every compiler,
/// which std::uniform_real_distribution does not promise.
class SampleRandom {
  public:
    explicit SampleRandom(std::uint64_t seed) : state_(seed) {}

    std::uint64_t bits() {
        std::uint64_t z = state_ += 0x9E3779B97F4A7C15ULL;
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
        return z ^ (z >> 31);
    }
    /// In [lo, hi).
    double uniform(double lo, double hi) {
        return lo + (hi - lo) * (static_cast<double>(bits() >> 11) * 0x1p-53);
    }

  private:
    std::uint64_t state_;
};

TONEWRIGHT_NAMESPACE_END
