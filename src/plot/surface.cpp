// SPDX-License-Identifier: Apache-2.0
#include "plot/surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/stroke_font.h"

TONEWRIGHT_NAMESPACE_BEGIN

const PlotColors& colors_of(PlotTheme theme) {
    static constexpr PlotColors kLight = {"#fff",    "#24292f", "#8c959f",
                                          "#e4e8ec", "#d0d7de", "#000"};
    static constexpr PlotColors kDark = {"#1b1d20", "#d8dce1", "#7d858e",
                                         "#33373c", "#444a50", "#f2f4f6"};
    return theme == PlotTheme::light ? kLight : kDark;
}

std::string two_decimals(double value) {
    std::string text = fmt::format("{:.2f}", value);
    while (text.back() == '0')
        text.pop_back();
    if (text.back() == '.') text.pop_back();
    return text == "-0" ? "0" : text;
}

Lettering lettering_of(const PlotSurface::TextStyle& style, std::string_view words) {
    struct Replacement {
        std::string_view character, ascii;
    };
    constexpr std::array<Replacement, 3> kReplacements = {
        {{"\u2212", "-"}, {"\u2192", "->"}, {"\u00d7", "x"}}};
    Lettering letters;
    while (!words.empty()) {
        const auto found =
            std::find_if(kReplacements.begin(), kReplacements.end(),
                         [&](const Replacement& r) { return words.starts_with(r.character); });
        if (found != kReplacements.end()) {
            letters.ascii += found->ascii;
            words.remove_prefix(found->character.size());
            continue;
        }
        const char c = words.front();
        const bool is_ascii = c >= ' ' && c <= '~';
        const bool continues_character = (static_cast<unsigned char>(c) & 0xC0U) == 0x80;
        if (!continues_character) letters.ascii += is_ascii ? c : '?';
        letters.is_complete = letters.is_complete && is_ascii;
        words.remove_prefix(1);
    }
    // Helvetica's capitals are 0.72 of its size.
    letters.unit = 0.72 * (style.is_heading ? 13 : 11) / kCapHeight;
    // Thinner strokes than a pixel would disappear.
    letters.stroke_width = std::max(kStrokeWidth * letters.unit, 1.0);
    if (style.is_heading) letters.stroke_width += 0.6;
    letters.width = letters.unit * stroke_text_width(letters.ascii);
    return letters;
}

double anchor_offset(const PlotSurface::TextStyle& style, const Lettering& letters) {
    return static_cast<int>(style.anchor) / 2.0 * letters.width;
}

TONEWRIGHT_NAMESPACE_END
