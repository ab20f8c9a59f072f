// SPDX-License-Identifier: Apache-2.0
//
// OpenImageIO has functions for this, too. In 2.4 a step of 0 never ends in them, and a % that is
// no number ends the process.
#include "cli/frames.h"

#include <fmt/format.h>

#include <cstdlib>
#include <regex>
#include <sstream>

#include "tonewright/error.h"

namespace tonewright {
namespace {

constexpr std::size_t kMostFrames = 1'000'000;

const std::regex& place_of_number() {
    static const std::regex place("%(?:0([1-9]))?d|#+");
    return place;
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

bool is_frame_pattern(const std::string& name) {
    return std::regex_search(name, place_of_number());
}

std::string frame_name(const char* what, const std::string& pattern, int frame) {
    std::string name;
    std::string rest = pattern;
    for (std::smatch match; std::regex_search(rest, match, place_of_number());) {
        const bool is_hashes = match[0].str().front() == '#';
        const auto digits = is_hashes ? match.length() == 1 ? 4 : static_cast<int>(match.length())
                            : match[1].matched ? std::stoi(match[1])
                                               : 1;
        // As printf does, the sign is one of the digits.
        name += match.prefix().str() + fmt::format("{:0{}d}", frame, digits);
        rest = match.suffix();
    }
    if (name.empty() && rest == pattern) {
        throw Error(fmt::format(
            "apply: {} is {}; expected a place for the frame's number, as in shot.%04d.exr or "
            "shot.####.exr",
            what, pattern));
    }
    return name + rest;
}

}  // namespace tonewright
