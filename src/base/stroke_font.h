// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct Stroke {
    float x0, y0, x1, y1;
};

/// A letter as line segments, y upwards. Capitals are 7 high, small letters 5, descenders reach -2.
struct Glyph {
    std::vector<Stroke> strokes;
    float advance;  // to the next letter
};

inline constexpr double kCapHeight = 7;
inline constexpr double kStrokeWidth = 0.85;
/// Space between the strokes of neighboring letters.
inline constexpr double kLetterSpacing = 1.75;

/// The glyph of a character; that of `?` for what is not printable ASCII.
[[nodiscard]] TONEWRIGHT_API const Glyph& glyph_of(char character);

/// Width of a line of ASCII text, in the units of the glyphs.
[[nodiscard]] TONEWRIGHT_API double stroke_text_width(std::string_view text);
/// The strokes of a line of ASCII text that begins at (0, 0), as an SVG path in hundredths of the
/// glyphs' unit, y upwards.
[[nodiscard]] TONEWRIGHT_API std::string stroke_text_path(std::string_view text);

TONEWRIGHT_NAMESPACE_END
