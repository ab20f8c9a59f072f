// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tonewright/sequence.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The frames that `1001-1100`, `1-9x2` (every second) or `1,5,10-20` name, in that order.
/// @param parameter  for the message
[[nodiscard]] std::vector<int> parse_frames(const std::string& text,
                                            const char* parameter = "frames");

/// The same frames as a text that parse_frames() takes; in order, each once.
[[nodiscard]] std::string format_frames(std::vector<int> frames);

/// The name of a frame. Its number replaces every `%d`, `%04d` (printf), `####` (as many digits) or
/// `#` (four, as in oiiotool) of the pattern. If there is none of these, it replaces every `@@@@`
/// (as many digits) in the file's name; names of folders may contain @.
/// @param parameter  for the message
/// @throws Error     a pattern without a placeholder for the number
[[nodiscard]] std::string frame_name(const char* parameter, const std::string& pattern, int frame);

/// True for a name with placeholders for a number.
[[nodiscard]] bool is_frame_pattern(const std::string& name);

/// The files of a shot.
struct ShotRequest {
    /// Names with placeholders for the number. @see frame_name
    std::string in;
    std::string out;
    std::vector<int> numbers;
    /// Treatment of missing input frames.
    enum class Missing : unsigned char {
        /// They have a problem.
        error,
        skip,
        /// The last earlier frame replaces them.
        hold,
    };
    Missing missing = Missing::error;
    bool skips_existing = false;
    bool is_in_place = false;
};

/// `error`, `skip` or `hold`. @throws Error  any other text
[[nodiscard]] ShotRequest::Missing parse_missing(const std::string& text);

struct Shot {
    std::vector<int> numbers;
    std::vector<FrameFiles> frames;  // as many
    std::size_t missing_count = 0;   // skipped
    std::size_t held_count = 0;
};

/// The frames that exist or replace others.
/// @throws Error  a number twice, or an output that replaces an input
[[nodiscard]] Shot plan_shot(const ShotRequest& request);

TONEWRIGHT_NAMESPACE_END
