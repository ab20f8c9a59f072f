// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>

#include "base/strings.h"
#include "lut/formats/formats.h"
#include "lut/formats/xml.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string without_quotes_and_blanks(std::string_view text) {
    std::string kept(text);
    std::erase_if(kept,
                  [](char c) { return c == '"' || kBlank.find(c) != kBlank.npos || c == '\n'; });
    return kept;
}

/// Eight digits: four bytes, the least significant first.
float float_of(const TextLines& text, std::string_view digits) {
    std::uint32_t bits = 0;
    for (std::size_t byte = 4; byte-- > 0;) {
        std::uint32_t value = 0;
        const char* const first = digits.data() + 2 * byte;
        if (std::from_chars(first, first + 2, value, 16).ptr != first + 2)
            text.fail("data is " + printable(digits) + "; expected hexadecimal digits");
        bits = bits << 8U | value;
    }
    const auto value = std::bit_cast<float>(bits);
    if (!std::isfinite(value))
        text.fail("data has a number that is not finite; expected finite ones");
    return value;
}

}  // namespace

/// Iridas .look: the 3D LUT as hexadecimal digits of little-endian floats, with red fastest.
CubeText read_look(TextLines& text) {
    std::map<std::string, std::string> found;  // LUT and its elements
    bool has_mask = false;
    visit_xml(text, "look", [&](const XmlElement& element, const std::vector<XmlElement>& around) {
        const auto is_inside = [&](std::string_view title) {
            return std::any_of(around.begin(), around.end(),
                               [&](const XmlElement& other) { return other.title == title; });
        };
        const std::string& title = element.title;
        const bool has_text = title == "size" || title == "data" || title == "mask";
        const std::string body = has_text ? without_quotes_and_blanks(element.body) : "";
        has_mask = has_mask || is_inside("mask") || (title == "mask" && !body.empty());
        if (title != "LUT" && !(is_inside("LUT") && has_text && title != "mask")) return;
        if (body.find_first_of("<&") != body.npos)
            text.fail(
                fmt::format("<{}> has a tag, comment or reference in it; expected text", title));
        if (!found.emplace(title, body).second)
            text.fail(fmt::format("<{}> appears twice; expected once", title));
    });
    if (has_mask) text.fail("it has a mask; expected a look of the whole picture");
    for (const char* title : {"LUT", "size", "data"}) {
        if (!found.contains(title))
            text.fail(fmt::format("<{}> is missing; expected it in LUT", title));
    }
    CubeText result;
    result.cube.size = text.size("size", found["size"], 2, kLargestCube);
    const std::string& digits = found["data"];
    constexpr std::size_t kDigitsOfFloat = 8;
    const std::size_t expected = 3 * kDigitsOfFloat * cubed(result.cube.size);
    if (digits.size() != expected)
        text.fail(fmt::format("data has {} digits; expected {}", digits.size(), expected));
    for (std::size_t at = 0; at < digits.size(); at += kDigitsOfFloat)
        result.cube.rows.push_back(
            float_of(text, std::string_view(digits).substr(at, kDigitsOfFloat)));
    return result;
}

TONEWRIGHT_NAMESPACE_END
