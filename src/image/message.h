// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace tonewright {

/// Errors of OIIO come in several lines; ours have one: the first, which says what happened.
[[nodiscard]] inline std::string first_line(const std::string& text) {
    const std::size_t begin = text.find_first_not_of("\r\n ");
    if (begin == std::string::npos) return "unknown error";
    return text.substr(begin, text.find_first_of("\r\n", begin) - begin);
}

}  // namespace tonewright
