// SPDX-License-Identifier: Apache-2.0
//
// Rising Sun Research, cineSpace.
#include <fmt/format.h>

#include <limits>

#include "base/strings.h"
#include "lut/formats/formats.h"
#include "lut/formats/text_lines.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// cineSpace: three preluts, then the table.
void check_csp(TextLines& text) {
    const auto next = [&](const char* expected) {
        if (!text.next_filled(false)) text.end(expected);
    };
    const auto only = [&](const char* expected) {
        if (!text.word().empty()) text.refuse(expected);
    };
    next("CSPLUTV100");
    if (lowercase(text.word()) != "csplutv100") text.refuse("CSPLUTV100");
    next("1D or 3D");
    const std::string kind = lowercase(text.word());
    if (kind != "1d" && kind != "3d") text.refuse("1D or 3D");
    next("a prelut");
    if (lowercase(text.line()).starts_with("begin metadata")) {
        do {
            if (!text.next_line()) text.end("END METADATA");
        } while (!lowercase(text.line()).starts_with("end metadata"));
        next("a prelut");
    }
    for (int c = 0; c < 3; ++c) {
        if (c > 0) next("a prelut");
        const int points = text.size("prelut's size", text.word(), 0, kLargestTable);
        only("one size");
        if (points < 2) continue;
        double last = -std::numeric_limits<double>::infinity();
        for (const bool is_input : {true, false}) {
            next("the numbers of a prelut");
            int found = 0;
            for (std::string_view word = text.word(); !word.empty(); word = text.word()) {
                const double value = text.number("number", word);
                if (is_input && !(value > last)) text.refuse("rising numbers");
                last = value;
                if (++found > points) break;
            }
            if (found != points)
                text.fail(fmt::format("the prelut has {} {} numbers; expected {}",
                                      found > points ? "more than" : "only",
                                      found > points ? points : found, points));
        }
    }
    next("the table's size");
    TableRows rows;
    if (kind == "1d") {
        rows.expect(static_cast<std::size_t>(text.size("size", text.word(), 2, kLargestTable)));
    } else {
        int n = 0;
        for (int c = 0; c < 3; ++c) {
            const int size = text.size("size", text.word(), 2, kLargestCube);
            if (c > 0 && size != n) text.refuse("three equal sizes");
            n = size;
        }
        rows.expect(cubed(n));
    }
    only("the table's size");
    while (text.next_filled(false))
        rows.add(text);
    rows.finish(text);
}

TONEWRIGHT_NAMESPACE_END
