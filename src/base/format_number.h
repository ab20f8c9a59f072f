// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Shortest decimal text that reads back as the same double ("0.1", "1e-10", "inf").
[[nodiscard]] TONEWRIGHT_API std::string shortest(double value);

/// Appends a float with 9 significant digits (enough to read back the same float), in fixed
/// notation because several applications do not read exponents. Trailing zeros are left out.
TONEWRIGHT_API void append_number(std::string& text, float value);
/// The same with a fixed number of decimals.
TONEWRIGHT_API void append_decimals(std::string& text, float value, int decimals);
/// Appends 8 decimals or 6 significant digits, whichever is finer, or fewer that read back as the
/// same float; with an exponent where that is shorter. Half a unit of the last place is below a
/// tenth of what float32 operations leave of light in [0, 1] behind sRGB's curve, in two thirds of
/// the space. Below 1e-14 only the rounding of doubles near 1 is left, so the text is 0.
TONEWRIGHT_API void append_compact(std::string& text, float value);
/// Turns the 0.25 that begins at `begin` and ends the text into .25.
TONEWRIGHT_API void drop_zero_before_point(std::string& text, std::size_t begin);

/// Three significant digits, rounded up: the text is never less than the value, and at most 1 %
/// more.
[[nodiscard]] TONEWRIGHT_API std::string three_digits_up(double value);

TONEWRIGHT_NAMESPACE_END
