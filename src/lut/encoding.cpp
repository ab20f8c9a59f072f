// SPDX-License-Identifier: Apache-2.0
#include "base/strings.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::vector<std::string> lut_format_names() {
    return {"cube", "clf", "ctf",  "spi1d", "spi3d",    "csp", "resolve_cube", "3dl",
            "lut",  "icc", "hald", "strip", "strip_up", "raw", "ktx2"};
}

std::string name_of(LutFormat format) {
    return lut_format_names()[static_cast<std::size_t>(format)];
}

bool is_strip(LutFormat format) {
    return format == LutFormat::strip || format == LutFormat::strip_up;
}

bool is_picture_format(LutFormat format) { return format == LutFormat::hald || is_strip(format); }

bool has_shaper(LutFormat format) {
    return format == LutFormat::csp || format == LutFormat::resolve_cube;
}

LutFormat parse_lut_format(std::string_view text) {
    return static_cast<LutFormat>(find_choice("format", text, lut_format_names()));
}

TONEWRIGHT_NAMESPACE_END
