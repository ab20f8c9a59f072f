// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "base/strings.h"
#include "lut/formats/formats.h"
#include "lut/formats/text_lines.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// FilmLight's Truelight cube: values of the 1D LUT are positions in the 3D LUT, from 0 to N - 1.
void check_cub(TextLines& text) {
    if (!text.next_line() || !lowercase(text.line()).starts_with("# truelight cube"))
        text.refuse("# Truelight Cube v2.0");
    std::size_t lengths[2] = {0, 0};  // of the 1D and of the 3D LUT
    std::size_t found[2] = {0, 0};
    std::optional<std::size_t> section;
    while (text.next_line()) {
        const std::string_view first = text.word();
        if (first.empty()) continue;
        if (first.front() != '#') {
            if (!section) text.refuse("# InputLUT or # Cube before the first row");
            text.rewind();
            text.numbers(3);
            if (++found[*section] > lengths[*section]) text.too_many_rows(lengths[*section]);
            continue;
        }
        const std::string_view key = text.word();
        const std::string name = lowercase(key);
        if (name == "width") {
            if (lengths[1] > 0) text.fail("width appears twice; expected once");
            lengths[1] = cubed(text.edge());
        } else if (name == "lutlength") {
            if (lengths[0] > 0) text.fail("lutLength appears twice; expected once");
            lengths[0] = static_cast<std::size_t>(text.size(key, text.word(), 2, kLargestTable));
            if (!text.word().empty()) text.refuse("one size");
        } else if (name == "inputlut") {
            section = 0;
        } else if (name == "cube") {
            section = 1;
        } else if (name == "end") {
            break;
        }
    }
    for (const std::size_t i : {0, 1}) {
        if (found[i] < lengths[i]) text.end_early(found[i], lengths[i]);
    }
    if (lengths[0] + lengths[1] == 0) text.fail("the file has no table; expected # width");
}

TONEWRIGHT_NAMESPACE_END
