// SPDX-License-Identifier: Apache-2.0
#include "tonewright/picture_options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "base/strings.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN

void set_alpha(WriteOptions& options, std::string_view text) {
    using Alpha = WriteOptions::Alpha;
    constexpr std::string_view kOver = "over:";
    const bool is_over = text.starts_with(kOver);
    const std::string name(is_over ? "over:R,G,B" : text);
    constexpr std::array kAlphas = {Alpha::keep, Alpha::ignore, Alpha::opaque, Alpha::over};
    options.alpha = kAlphas[find_choice("alpha", name, {"keep", "ignore", "opaque", "over:R,G,B"})];
    if (!is_over) {
        if (options.alpha == Alpha::over)
            throw Error({.parameter = "alpha", .value = "over:R,G,B", .expected = "numbers"});
        return;
    }
    const std::string numbers(text.substr(kOver.size()));
    std::size_t at = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t comma = std::min(numbers.find(',', at), numbers.size());
        const char* const end = numbers.data() + comma;
        float& value = options.background[c];
        const auto [stop, error] = std::from_chars(numbers.data() + at, end, value);
        const bool is_last = comma == numbers.size();
        if (error != std::errc() || stop != end || !(value >= 0 && value <= 1) ||
            is_last != (c == 2)) {
            throw Error({.parameter = "alpha",
                         .value = std::string(text),
                         .expected = "over:R,G,B with three code values in [0, 1]"});
        }
        at = std::min(comma + 1, numbers.size());
    }
}

void set_pixel_type(WriteOptions& options, std::string_view text) {
    options.bits = text == "uint10" ? 10 : text == "uint12" ? 12 : 0;
    options.type =
        options.bits > 0 ? OIIO::TypeDesc(OIIO::TypeDesc::UINT16) : parse_pixel_type(text);
}

OIIO::TypeDesc parse_pixel_type(std::string_view text) {
    static const std::vector<std::pair<std::string, OIIO::TypeDesc>> types = {
        {"uint8", OIIO::TypeDesc::UINT8},
        {"uint16", OIIO::TypeDesc::UINT16},
        {"half", OIIO::TypeDesc::HALF},
        {"float", OIIO::TypeDesc::FLOAT}};
    std::vector<std::string> names;
    names.reserve(types.size());
    for (const auto& type : types)
        names.push_back(type.first);
    return types[find_choice("pixel_type", text, names)].second;
}

TONEWRIGHT_NAMESPACE_END
