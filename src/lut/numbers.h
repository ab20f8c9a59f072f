// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace tonewright {

/// Of the 1D table before a cube: as many as readers take, or make of a prelut.
inline constexpr int kShaperSteps = 65536;

/// Appends a float with 9 significant digits (enough to read back the same float), in fixed
/// notation: several hosts do not read exponents. Trailing zeros are left out.
void append_number(std::string& text, float value);
/// The same with a fixed number of decimals.
void append_decimals(std::string& text, float value, int decimals);
/// 8 decimals or 6 significant digits, whichever is finer, or fewer that read back as the same
/// float; with an exponent where that is shorter. Half a unit of
/// the last place is below a tenth of what float32 operations leave of light in [0, 1] behind
/// sRGB's curve, in two thirds of the space. Below 1e-14 nothing is left but the rounding of
/// doubles near 1: 0.
void append_compact(std::string& text, float value);
/// Makes .25 of the 0.25 that begins there, and ends the text.
void drop_zero_before_point(std::string& text, std::size_t begin);

/// Three significant digits, rounded up: what is printed is never less than what was measured, and
/// at most 1 % more.
[[nodiscard]] std::string three_digits_up(double value);

/// FNV-1a, 32 bits, as 8 hexadecimal digits: names LUT files by their contents, because OCIO caches
/// files by name.
[[nodiscard]] std::string content_hash(const std::string& contents);

/// Text as XML character data and attribute value.
[[nodiscard]] std::string xml_escape(const std::string& text);

}  // namespace tonewright
