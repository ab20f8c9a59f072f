// SPDX-License-Identifier: Apache-2.0
//
// 3D LUTs whose rows have blue fastest.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/strings.h"
#include "lut/formats/formats.h"
#include "lut/formats/text_lines.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Triplets of a 3D LUT in the other order.
std::vector<float> red_fastest(const std::vector<float>& blue_fastest, int size) {
    const auto n = static_cast<std::size_t>(size);
    std::vector<float> turned(blue_fastest.size());
    for (std::size_t i = 0; i < n * n * n; ++i) {
        const std::size_t to = (i % n * n + i / n % n) * n + i / (n * n);
        std::copy_n(&blue_fastest[3 * i], 3, &turned[3 * to]);
    }
    return turned;
}

}  // namespace

/// DaVinci's .dat, as ffmpeg reads it: a size (33 without one), then rows with blue fastest.
CubeText read_dat(TextLines& text) {
    CubeText result;
    if (!text.next_filled()) text.end("3DLUTSIZE or three numbers");
    result.cube.size = 33;
    const std::string_view first = text.word();
    if (first == "3DLUTSIZE") {
        result.cube.size = text.size(first, text.word(), 2, kLargestCube);
        if (!text.word().empty()) text.refuse("no more on this line");
        if (!text.next_filled()) text.end("three numbers");
    } else {
        text.rewind();
    }
    TableRows rows;
    rows.expect(cubed(result.cube.size));
    std::vector<float> blue_fastest;
    do {
        const std::array<float, 3> row = rows.add(text);
        blue_fastest.insert(blue_fastest.end(), row.begin(), row.end());
    } while (text.next_filled());
    rows.finish(text);
    result.cube.rows = red_fastest(blue_fastest, result.cube.size);
    return result;
}

/// Nuke's .vf: a 3D LUT with blue fastest.
void check_vf(TextLines& text) {
    if (!text.next_line() || !lowercase(text.line()).starts_with("#inventor"))
        text.refuse("#Inventor V2.1 ascii");
    TableRows rows;
    bool has_size = false;
    bool is_open = false;
    while (text.next_filled()) {
        const std::string_view first = text.word();
        const std::string key = lowercase(first);
        if (is_open) {
            text.rewind();
            rows.add(text);
        } else if (key == "grid_size") {
            if (has_size) text.fail("grid_size appears twice; expected once");
            has_size = true;
            rows.expect(cubed(text.edge()));
        } else if (key == "global_transform") {
            for (int i = 0; i < 16; ++i)
                (void)text.number(first, text.word());
            if (!text.word().empty()) text.refuse("16 numbers");
        } else if (key == "data") {
            is_open = true;
        } else if (key == "element_size" || key == "world_origin") {
            continue;  // the same as global_transform, in parts
        } else if (begins_keyword(first)) {
            text.ignore_keyword(first);
        } else {
            text.refuse("keyword", first, "grid_size, global_transform or data");
        }
    }
    if (!is_open) text.end("data");
    rows.finish(text);
}

/// Pandora's .mga and .m3d: whole numbers, with blue fastest. OpenColorIO reads rows with an index
/// before the three numbers, ffmpeg rows without one.
CubeText read_pandora(TextLines& text) {
    constexpr int kLargest = 131071;  // twice the 16-bit range
    CubeText result;
    int largest = 0;
    bool is_open = false;
    while (!is_open && text.next_filled()) {
        const std::string_view first = text.word();
        const std::string key = lowercase(first);
        const auto value = [&](std::string_view wanted) {
            if (lowercase(text.word()) != wanted) text.refuse(fmt::format("{} {}", key, wanted));
        };
        if (key == "channel") {
            value("3d");
        } else if (key == "in") {
            const int nodes =
                text.size(first, text.word(), 8, kLargestCube * kLargestCube * kLargestCube);
            result.cube.size = static_cast<int>(std::lround(std::cbrt(nodes)));
            if (cubed(result.cube.size) != static_cast<std::size_t>(nodes))
                text.refuse("in and N x N x N, such as 4913 with N = 17");
        } else if (key == "out") {
            largest = text.size(first, text.word(), 2, 65536) - 1;
        } else if (key == "format") {
            value("lut");
        } else if (key == "values") {
            for (const char* channel : {"red", "green", "blue"})
                value(channel);
            is_open = true;
        } else {
            text.refuse("keyword", first, "channel, in, out, format or values");
        }
        if (!text.word().empty()) text.refuse("no more on this line");
    }
    if (!is_open) text.end("values red green blue");
    if (result.cube.size == 0 || largest == 0) text.refuse("in and out before values");
    const std::size_t expected = cubed(result.cube.size);
    std::vector<float> blue_fastest;
    std::size_t columns = 0;
    while (text.next_filled()) {
        std::vector<int> row;
        for (std::string_view word = text.word(); !word.empty() && row.size() < 5;
             word = text.word())
            row.push_back(text.size("number", word, -kLargest, std::numeric_limits<int>::max()));
        if (columns == 0) columns = row.size();
        if (row.size() != columns || columns < 3 || columns > 4)
            text.refuse("three numbers, or an index and three numbers");
        if (blue_fastest.size() == 3 * expected) text.too_many_rows(expected);
        for (std::size_t c = columns - 3; c < columns; ++c) {
            if (row[c] > kLargest) text.refuse(fmt::format("numbers of at most {}", kLargest));
            blue_fastest.push_back(static_cast<float>(row[c]) / static_cast<float>(largest));
        }
    }
    if (blue_fastest.size() < 3 * expected) text.end_early(blue_fastest.size() / 3, expected);
    result.cube.rows = red_fastest(blue_fastest, result.cube.size);
    return result;
}

TONEWRIGHT_NAMESPACE_END
