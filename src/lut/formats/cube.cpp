// SPDX-License-Identifier: Apache-2.0
//
// Adobe, "Cube LUT Specification 1.0" (2013); Blackmagic Design, DaVinci Resolve's own .cube.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/strings.h"
#include "lut/formats/formats.h"
#include "lut/formats/text_lines.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Keywords that are misspelled or not supported, and whose meaning would be lost.
bool is_known_to_others(std::string_view key) {
    return key.starts_with("lut_1d_") || key.starts_with("lut_2d_") || key.starts_with("lut_3d_") ||
           key.starts_with("domain_");
}

}  // namespace

CubeText read_cube(TextLines& text) {
    CubeText result;
    TableRows rows;
    std::vector<std::string> seen;
    std::array<double, 3> lo = {0, 0, 0};
    std::array<double, 3> hi = {1, 1, 1};
    int domain_line = 0;
    const auto has = [&](std::string_view key) {
        return std::find(seen.begin(), seen.end(), key) != seen.end();
    };
    while (text.next_filled()) {
        const std::string_view first = text.word();
        if (begins_number(first)) {
            text.rewind();
            const std::array<float, 3> row = rows.add(text);
            const bool is_of_table = rows.found() <= static_cast<std::size_t>(result.table.size);
            std::vector<float>& values = is_of_table ? result.table.rows : result.cube.rows;
            values.insert(values.end(), row.begin(), row.end());
            continue;
        }
        const std::string key = lowercase(first);
        if (rows.found() > 0) text.refuse("three numbers");
        if (key == "title") continue;
        if (has(key)) text.fail(std::string(first) + " appears twice; expected once");
        if (key == "lut_1d_size") {
            result.table.size = text.size(first, text.word(), 2, kLargestTable);
            rows.expect(static_cast<std::size_t>(result.table.size));
        } else if (key == "lut_3d_size") {
            result.cube.size = text.size(first, text.word(), 2, kLargestCube);
            rows.expect(cubed(result.cube.size));
        } else if (key == "domain_min" || key == "domain_max") {
            for (double& v : key == "domain_min" ? lo : hi)
                v = text.number(first, text.word());
            domain_line = text.line_number();
        } else if (key == "lut_1d_input_range" || key == "lut_3d_input_range") {
            CubeText::Table& table = key == "lut_1d_input_range" ? result.table : result.cube;
            table.lo.fill(text.number(first, text.word()));
            table.hi.fill(text.number(first, text.word()));
            if (!(table.lo[0] < table.hi[0])) text.refuse("the first number below the second");
        } else if (begins_keyword(first) && !is_known_to_others(key) && !has("lut_1d_size") &&
                   !has("lut_3d_size")) {
            // OpenColorIO and ffmpeg skip such lines there, and fail at them after the size.
            text.ignore_keyword(first);
            continue;
        } else {
            text.refuse("keyword", first,
                        "TITLE, LUT_1D_SIZE, LUT_3D_SIZE, DOMAIN_MIN, DOMAIN_MAX, "
                        "LUT_1D_INPUT_RANGE, LUT_3D_INPUT_RANGE or three numbers");
        }
        if (!text.word().empty()) text.refuse("no more on this line");
        seen.push_back(key);
        const bool is_adobe = has("domain_min") || has("domain_max");
        if (is_adobe && (has("lut_1d_input_range") || has("lut_3d_input_range")))
            text.refuse("DOMAIN_MIN and DOMAIN_MAX, or input ranges, not both");
        if (is_adobe && has("lut_1d_size") && has("lut_3d_size"))
            text.refuse("input ranges where there are two tables");
    }
    for (std::size_t c = 0; c < 3; ++c) {
        if (lo[c] < hi[c]) continue;
        text.fail_at(domain_line,
                     fmt::format("DOMAIN_MIN is {}, DOMAIN_MAX {}; expected DOMAIN_MIN "
                                 "below DOMAIN_MAX in each channel",
                                 fmt::join(lo, " "), fmt::join(hi, " ")));
    }
    if (domain_line > 0) {
        CubeText::Table& table = result.cube.size > 0 ? result.cube : result.table;
        table.lo = lo;
        table.hi = hi;
    }
    rows.finish(text);
    result.note = text.note();
    return result;
}

/// Iridas .itx: a 3D LUT without a domain.
void check_itx(TextLines& text) {
    TableRows rows;
    bool has_size = false;
    while (text.next_filled()) {
        const std::string_view first = text.word();
        if (begins_number(first)) {
            text.rewind();
            rows.add(text);
        } else if (lowercase(first) == "lut_3d_size" && rows.found() == 0) {
            rows.expect(cubed(text.size(first, text.word(), 2, kLargestCube)));
            has_size = true;
        } else if (!has_size && begins_keyword(first) && !is_known_to_others(lowercase(first))) {
            text.ignore_keyword(first);
        } else {
            text.refuse("LUT_3D_SIZE or three numbers");
        }
    }
    rows.finish(text);
}

TONEWRIGHT_NAMESPACE_END
