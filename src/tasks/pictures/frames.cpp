// SPDX-License-Identifier: Apache-2.0
//
// OpenImageIO's functions for this are not used: in 2.4 they never end with a step of 0, and a %
// without a number ends the process.

#include "tasks/pictures/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/input_file.h"
#include "base/strings.h"
#include "image/picture_file.h"
#include "image/tonemap_file.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

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

std::vector<int> parse_frames(const std::string& text, const char* parameter) {
    const auto refuse = [&] {
        throw Error({.parameter = parameter,
                     .value = text,
                     .expected = fmt::format(
                         "frames such as 1001-1100, 1-9x2 or 1,5,10-20, at most {}", kMostFrames)});
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

std::string frame_name(const char* parameter, const std::string& pattern, int frame) {
    std::string name;
    std::size_t from = 0;
    for (const Place& place : places_of_number(pattern)) {
        // The sign is one of the digits, as it is in printf.
        name +=
            pattern.substr(from, place.begin - from) + fmt::format("{:0{}d}", frame, place.width);
        from = place.begin + place.length;
    }
    if (from == 0) {
        throw Error({.parameter = parameter,
                     .value = pattern,
                     .expected = "a placeholder for the frame number, as in shot.%04d.exr, "
                                 "shot.####.exr or shot.@@@@.exr"});
    }
    return name + pattern.substr(from);
}

namespace {

/// The files of a shot, some of whose frames may be missing.
class InputFrames {
  public:
    explicit InputFrames(const std::string& pattern) : pattern_(pattern) {}

    [[nodiscard]] std::string name(int frame) const { return frame_name("in", pattern_, frame); }
    [[nodiscard]] bool has(int frame) {
        const auto known = known_.find(frame);
        if (known != known_.end()) return known->second;
        std::error_code error;
        // A file without access is not a missing frame: reading it reports the reason.
        const fs::file_type type = fs::status(name(frame), error).type();
        return known_[frame] = type != fs::file_type::not_found;
    }
    /// The frame that replaces a missing one. It depends on the files only, not on the request, so
    /// every part of a shot gets the same frames.
    [[nodiscard]] std::optional<int> held(int frame) {
        // Frames mostly come in order: no gap is searched twice.
        int first = frame - kMostHeld;
        std::optional<int> found;
        if (searched_ && *searched_ < frame && *searched_ >= first) {
            first = *searched_;
            if (found_ && *found_ >= frame - kMostHeld) found = found_;
        }
        for (int earlier = frame - 1; earlier >= first; --earlier) {
            if (!has(earlier)) continue;
            found = earlier;
            break;
        }
        searched_ = frame;
        found_ = found;
        return found;
    }

    static constexpr int kMostHeld = 1000;

  private:
    std::string pattern_;
    std::map<int, bool> known_;
    std::optional<int> searched_, found_;  // the last held frame that was asked for, and the answer
};

/// Every missing frame that an earlier one replaces, and that one.
std::map<int, int> held_frames(InputFrames& shot, std::vector<int> numbers) {
    std::sort(numbers.begin(), numbers.end());
    std::map<int, int> held;
    for (const int number : numbers) {
        if (shot.has(number)) continue;
        if (const std::optional<int> earlier = shot.held(number)) held[number] = *earlier;
    }
    return held;
}

/// The reason why a missing frame cannot be read; nothing if a reader understands its name, as that
/// of a picture that is computed.
std::optional<Problem> why_missing(const std::string& name) {
    try {
        (void)open_picture(name);
        return {};
    } catch (const FileError&) {
        return why_not_readable(name);
    }
}

/// Refuses outputs that would be read as inputs after they were written.
void check_inputs_stay(const Shot& shot, const ShotRequest& request) {
    const auto absolute = [](const std::string& name) {
        return fs::absolute(name).lexically_normal().string();
    };
    std::set<std::string> ins;
    for (const FrameFiles& frame : shot.frames)
        ins.insert(absolute(frame.in));
    for (const FrameFiles& frame : shot.frames) {
        if (!ins.contains(absolute(frame.out))) continue;
        throw Error(
            {.value = fmt::format("output is {}, which is also an input frame", request.out),
             .expected = request.skips_existing ? "other files with <<skip_existing=yes>>"
                                                : "other files with <<missing=hold>>"});
    }
}

}  // namespace

ShotRequest::Missing parse_missing(const std::string& text) {
    return static_cast<ShotRequest::Missing>(
        find_choice("missing", text, {"error", "skip", "hold"}));
}

Shot plan_shot(const ShotRequest& request) {
    std::set<int> known;
    for (const int number : request.numbers) {
        if (!known.insert(number).second)
            throw Error({.value = fmt::format("<<frames>> names frame {} twice", number),
                         .expected = "once"});
    }
    using Missing = ShotRequest::Missing;
    InputFrames inputs(request.in);
    std::map<int, int> held;
    if (request.missing == Missing::hold) held = held_frames(inputs, request.numbers);
    std::optional<std::optional<Problem>> reason;  // of every missing frame
    Shot shot;
    for (const int number : request.numbers) {
        FrameFiles frame = {inputs.name(number), frame_name("out", request.out, number)};
        const auto earlier = held.find(number);
        if (earlier != held.end()) {
            frame.in = inputs.name(earlier->second);
            ++shot.held_count;
        } else if (!inputs.has(number)) {
            if (request.missing == Missing::skip) {
                ++shot.missing_count;
                continue;
            }
            // A million of them must not take a million attempts to open a picture.
            if (!reason) reason = why_missing(frame.in);
            if (*reason) frame.problem = within(frame.in + ": cannot read", **reason);
        }
        shot.numbers.push_back(number);
        shot.frames.push_back(std::move(frame));
    }
    if (request.missing == Missing::hold || request.skips_existing)
        check_inputs_stay(shot, request);
    check_overwriting(shot.frames, request.is_in_place);
    return shot;
}

TONEWRIGHT_NAMESPACE_END
