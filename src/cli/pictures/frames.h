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

/// The name of a frame. Its number replaces every `%d`, `%04d` (printf), `####` (as many digits) or
/// `#` (four, as in oiiotool) of the pattern. If there is none of these, it replaces every `@@@@`
/// (as many digits) in the file's name; names of folders may contain @.
/// @param what     the argument, for the message
/// @throws Error   a pattern without a placeholder for the number
[[nodiscard]] std::string frame_name(const char* what, const std::string& pattern, int frame);

/// True for a name with placeholders for a number.
[[nodiscard]] bool is_frame_pattern(const std::string& name);

TONEWRIGHT_NAMESPACE_END
