// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "tonewright/color.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Part of the sample set that a color belongs to.
enum class SampleKind : unsigned char {
    gray,        // R = G = B, -12..+12 stops around 0.18, and black
    grid,        // gamut grids of Rec.709, Rec.2020 and AP1 at five exposures
    random,      // log-uniform, 2^-16..2^12 per channel, a tenth with a channel at 0
    near_black,  // down to denormals
    negative,    // one or two channels below 0, up to mixed signs of thousands
    picture,     // pixels given by the caller
    special,     // NaN, infinities, the largest float
};

/// The colors that every form of a view is measured on. Scene-linear float, interleaved RGB.
struct TONEWRIGHT_API SampleSet {
    std::vector<float> rgb;
    std::vector<SampleKind> kind;

    [[nodiscard]] std::size_t size() const { return kind.size(); }
    /// All three channels >= 0 and finite.
    [[nodiscard]] bool is_non_negative(std::size_t i) const;
    void add(double r, double g, double b, SampleKind k);
};

struct SampleSetOptions {
    int gamut_grid_size = 33;
    std::size_t random_count = 100000;
};

/// The standard set in the given input space; the same on every machine (fixed seed).
[[nodiscard]] TONEWRIGHT_API SampleSet make_sample_set(const InputSpace& input,
                                                       const SampleSetOptions& options = {});

TONEWRIGHT_NAMESPACE_END
