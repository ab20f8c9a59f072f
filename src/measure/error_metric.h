// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Errors over a set of colors; for each color, the worst channel counts.
struct ErrorStats {
    double max = 0;
    double p999 = 0;  // 99.9th percentile
    double mean = 0;
    std::size_t count = 0;
    std::size_t worst = 0;  // index of the color with the largest error
};

/// Over values already computed; a NaN counts as an infinite error.
[[nodiscard]] TONEWRIGHT_API ErrorStats summarise(std::span<const double> errors);

/// Largest channel difference of one color, `candidate` against `truth`; infinite where one is
/// NaN.
[[nodiscard]] TONEWRIGHT_API double channel_error(const double* truth, const float* candidate);

/// Color differences of pairs of code-value triplets (interleaved RGB) shown on a display, ITU-R
/// BT.2124-0: dE_ITP, where 1 is about the smallest difference that can be seen.
/// @param unit_nits  luminance of light 1 in cd/m2; 100 is the reference of SDR grading, and what
///                   HDR displays have.
[[nodiscard]] TONEWRIGHT_API std::vector<double> delta_e_itp(const Display& display,
                                                             std::span<const double> code_a,
                                                             std::span<const double> code_b,
                                                             double unit_nits = kUnitLuminance);
/// The same in two steps, where one side is compared with many: I of all colors, then Ct, then Cp.
[[nodiscard]] TONEWRIGHT_API std::vector<double> ictcp_of_codes(const Display& display,
                                                                std::span<const double> code,
                                                                double unit_nits = kUnitLuminance);
[[nodiscard]] TONEWRIGHT_API std::vector<double> delta_e_itp(std::span<const double> ictcp_a,
                                                             std::span<const double> ictcp_b);

TONEWRIGHT_NAMESPACE_END
