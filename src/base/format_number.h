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
/// Appends the shortest number that is within `tolerance` (positive) of the value: fixed, without a
/// zero before the point, or with an exponent.
/// @pre both are within 10^-50 and 10^40, or the value is 0.
TONEWRIGHT_API void append_near(std::string& text, double value, double tolerance);
/// Appends 0 or one digit, with an exponent where that is shorter: a number that is not less than
/// the value, or not more than it.
TONEWRIGHT_API void append_one_digit(std::string& text, double value, bool is_up);
/// Turns the 0.25 that begins at `begin` and ends the text into .25.
TONEWRIGHT_API void drop_zero_before_point(std::string& text, std::size_t begin);

/// So many significant digits, or fewer: "0.0029", "1.3e+04".
[[nodiscard]] TONEWRIGHT_API std::string rounded(double value, int digits);

/// The next number of so many significant digits that is not less than the value. Numbers that are
/// not positive or not finite stay.
[[nodiscard]] TONEWRIGHT_API double round_up(double value, int digits);
/// The same as text with an exponent, such as "1.3e-07". Errors are printed so, because the text
/// must not be less than the measured error.
[[nodiscard]] TONEWRIGHT_API std::string rounded_up(double value, int digits = 2);

TONEWRIGHT_NAMESPACE_END
