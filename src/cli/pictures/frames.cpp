// SPDX-License-Identifier: Apache-2.0
//
// OpenImageIO's functions for this are not used: in 2.4 they never end with a step of 0, and a %
// without a number ends the process.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <regex>
#include <sstream>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::size_t kMostFrames = 1'000'000;

/// Position of the number in a pattern, from `begin` on.
struct Places {
    std::regex shape;
    std::size_t begin;
};

Places places_of_number(const std::string& pattern) {
    static const std::regex common("%(?:0([1-9]))?d|#+");
    static const std::regex at("@+");
    if (std::regex_search(pattern, common)) return {common, 0};
    return {at, pattern.rfind('/') == std::string::npos ? 0 : pattern.rfind('/') + 1};
}

}  // namespace

std::vector<int> parse_frames(const std::string& text) {
    const auto refuse = [&] {
        throw Error(fmt::format(
            "apply: --frames is {}; expected frames such as 1001-1100, 1-9x2 or 1,5,10-20, at most "
            "{}",
            text, kMostFrames));
    };
    static const std::regex range("(-?\\d{1,9})(?:-(-?\\d{1,9})(?:x(\\d{1,9}))?)?");
    std::vector<int> frames;
    std::istringstream parts(text + ',');
    for (std::string part; std::getline(parts, part, ',');) {
        std::smatch match;
        if (!std::regex_match(part, match, range)) refuse();
        const int first = std::stoi(match[1]);
        const int last = match[2].matched ? std::stoi(match[2]) : first;
        const int step = match[3].matched ? std::stoi(match[3]) : 1;
        if (step == 0) refuse();
        const int count = std::abs(last - first) / step + 1;
        if (frames.size() + static_cast<std::size_t>(count) > kMostFrames) refuse();
        for (int i = 0; i < count; ++i)
            frames.push_back(first + (last < first ? -i : i) * step);
    }
    return frames;
}

std::string format_frames(std::vector<int> frames) {
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    std::string text;
    for (std::size_t i = 0; i < frames.size();) {
        const int step = i + 1 < frames.size() ? frames[i + 1] - frames[i] : 1;
        std::size_t last = i;
        while (last + 1 < frames.size() && frames[last + 1] - frames[last] == step)
            ++last;
        if (step > 1 && last < i + 2) last = i;  // two make no range
        text += fmt::format("{}{}", text.empty() ? "" : ",", frames[i]);
        if (last > i) text += fmt::format("-{}", frames[last]);
        if (last > i && step > 1) text += fmt::format("x{}", step);
        i = last + 1;
    }
    return text;
}

bool is_frame_pattern(const std::string& name) {
    const Places places = places_of_number(name);
    return std::regex_search(name.substr(places.begin), places.shape);
}

std::string frame_name(const char* what, const std::string& pattern, int frame) {
    const Places places = places_of_number(pattern);
    std::string name = pattern.substr(0, places.begin);
    std::string rest = pattern.substr(places.begin);
    bool has_place = false;
    for (std::smatch match; std::regex_search(rest, match, places.shape); has_place = true) {
        const bool is_hash = match[0] == "#";
        const bool is_printf = match[0].str().front() == '%';
        const int width = is_hash            ? 4
                          : !is_printf       ? static_cast<int>(match.length())
                          : match[1].matched ? std::stoi(match[1])
                                             : 1;
        // As printf does, the sign is one of the digits.
        name += match.prefix().str() + fmt::format("{:0{}d}", frame, width);
        rest = match.suffix();
    }
    if (!has_place) {
        throw Error(
            fmt::format("apply: {} is {}; expected a placeholder for the frame number, as in "
                        "shot.%04d.exr, "
                        "shot.####.exr or shot.@@@@.exr",
                        what, pattern));
    }
    return name + rest;
}

TONEWRIGHT_NAMESPACE_END
