// SPDX-License-Identifier: Apache-2.0
//
// OpenImageIO's functions for this are not used: in 2.4 they never end with a step of 0, and a %
// without a number ends the process.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <regex>
#include <sstream>
#include <string_view>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::size_t kMostFrames = 1'000'000;

/// A placeholder for the number in a pattern.
struct Place {
    std::size_t begin;
    std::size_t length;
    int width;
};

/// @param is_at  of @, not of the others
std::optional<Place> next_place(std::string_view pattern, std::size_t from, bool is_at) {
    for (std::size_t i = from; i < pattern.size(); ++i) {
        const std::string_view rest = pattern.substr(i);
        if (rest.front() == (is_at ? '@' : '#')) {
            const std::size_t length = std::min(rest.find_first_not_of(rest.front()), rest.size());
            return Place{i, length, !is_at && length == 1 ? 4 : static_cast<int>(length)};
        }
        if (is_at) continue;
        if (rest.starts_with("%d")) return Place{i, 2, 1};
        if (rest.starts_with("%0") && rest.size() > 3 && rest[2] >= '1' && rest[2] <= '9' &&
            rest[3] == 'd')
            return Place{i, 4, rest[2] - '0'};
    }
    return std::nullopt;
}

/// Not with std::regex, which needs a stack for every character.
std::vector<Place> places_of_number(std::string_view pattern) {
    std::vector<Place> places;
    const auto add = [&](std::size_t from, bool is_at) {
        while (const std::optional<Place> place = next_place(pattern, from, is_at)) {
            places.push_back(*place);
            from = place->begin + place->length;
        }
    };
    add(0, false);
    if (places.empty()) add(pattern.rfind('/') + 1, true);
    return places;
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

bool is_frame_pattern(const std::string& name) { return !places_of_number(name).empty(); }

std::string frame_name(const char* what, const std::string& pattern, int frame) {
    std::string name;
    std::size_t from = 0;
    for (const Place& place : places_of_number(pattern)) {
        // The sign is one of the digits, as it is in printf.
        name +=
            pattern.substr(from, place.begin - from) + fmt::format("{:0{}d}", frame, place.width);
        from = place.begin + place.length;
    }
    if (from == 0) {
        throw Error(
            fmt::format("apply: {} is {}; expected a placeholder for the frame number, as in "
                        "shot.%04d.exr, "
                        "shot.####.exr or shot.@@@@.exr",
                        what, pattern));
    }
    return name + pattern.substr(from);
}

TONEWRIGHT_NAMESPACE_END
