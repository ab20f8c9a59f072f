// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The frames that `1001-1100`, `1-9x2` (every second) or `1,5,10-20` name, in that order.
/// @throws Error
[[nodiscard]] std::vector<int> parse_frames(const std::string& text);

/// The same frames as a text that parse_frames() takes; in order, each once.
[[nodiscard]] std::string format_frames(std::vector<int> frames);

/// The name of a frame: every `%d`, `%04d` (printf), `####` (as many digits) or `#` (four, as in
/// oiiotool) in the pattern is its number. Where there is none of these, every `@@@@` (as many
/// digits) in the file's name is: names of folders have an @ of their own.
/// @param what     the argument, for the message
/// @throws Error   a pattern that has no place for a number
[[nodiscard]] std::string frame_name(const char* what, const std::string& pattern, int frame);

/// True for a name that has places for a number.
[[nodiscard]] bool is_frame_pattern(const std::string& name);

TONEWRIGHT_NAMESPACE_END
