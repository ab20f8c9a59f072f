// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "tonewright/lut.h"

namespace tonewright {
namespace {

struct Range {
    double lo;
    double hi;
};

/// "name", or "name:LO:HI".
Range parse_range(std::string_view text, std::string_view name, Range fallback) {
    if (text == name) return fallback;
    std::string_view rest = text.substr(name.size() + 1);
    const std::size_t colon = rest.find(':');
    const auto number = [&](std::string_view s, double& value) {
        const auto r = std::from_chars(s.data(), s.data() + s.size(), value);
        return r.ec == std::errc() && r.ptr == s.data() + s.size() && std::isfinite(value);
    };
    Range range{};
    if (colon == std::string_view::npos || !number(rest.substr(0, colon), range.lo) ||
        !number(rest.substr(colon + 1), range.hi) || !(range.lo < range.hi)) {
        throw Error("bake: input encoding is " + std::string(text) + "; expected " +
                    std::string(name) + ":LO:HI with numbers LO < HI");
    }
    return range;
}

}  // namespace

InputEncoding parse_input_encoding(std::string_view text) {
    const Expr x = Expr::input();
    const std::string_view name = text.substr(0, text.find(':'));
    InputEncoding e;
    if (text == "acescct") {
        e.id = "acescct";
        e.title = "ACEScct (Academy S-2016-001: AP1 primaries, log with a linear toe)";
        e.encode = acescct_encode(x);
        e.decode = acescct_decode(x);
        e.default_input = "lin_ap1";
        e.scene_lo = evaluate(e.decode, 0.0);
        e.scene_hi = evaluate(e.decode, 1.0);
        return e;
    }
    if (name == "log2") {
        const Range stops = parse_range(text, name, {-10, 6.5});
        if (stops.lo < -64 || stops.hi > 64) {
            throw Error("bake: input encoding is " + std::string(text) +
                        "; expected [-64, 64] stops");
        }
        const double lowest = std::log2(0.18) + stops.lo;
        const double span = stops.hi - stops.lo;
        e.id = fmt::format("log2:{}:{}", shortest(stops.lo), shortest(stops.hi));
        e.scene_lo = std::exp2(lowest);
        e.scene_hi = std::exp2(lowest + span);
        e.encode = (log2(max(x, e.scene_lo)) - lowest) / span;
        e.decode = exp2(x * span + lowest);
        e.title = fmt::format("log2(x / 0.18) from {} to {} stops", shortest(stops.lo),
                              shortest(stops.hi));
        return e;
    }
    if (name == "linear") {
        const Range range = parse_range(text, name, {0, 1});
        e.id = fmt::format("linear:{}:{}", shortest(range.lo), shortest(range.hi));
        e.scene_lo = range.lo;
        e.scene_hi = range.hi;
        e.encode = (x - range.lo) / (range.hi - range.lo);
        e.decode = x * (range.hi - range.lo) + range.lo;
        e.title = fmt::format("scene-linear from {} to {}", shortest(range.lo), shortest(range.hi));
        e.is_linear = true;
        return e;
    }
    const std::vector<std::string> names = {"acescct", "log2", "linear"};
    throw Error("bake: input encoding is " + std::string(text) + "; expected " +
                join_choices(names) + did_you_mean(name, names));
}

std::vector<std::string> lut_format_names() { return {"cube", "clf", "spi1d", "spi3d"}; }

LutFormat parse_lut_format(std::string_view text) {
    const std::vector<std::string> names = lut_format_names();
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i] == text) return static_cast<LutFormat>(i);
    }
    throw Error("bake: format is " + std::string(text) + "; expected " + join_choices(names) +
                did_you_mean(text, names));
}

}  // namespace tonewright
