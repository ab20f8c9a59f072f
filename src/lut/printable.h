// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tonewright {

/// What somebody's file holds, as it can be shown in a message of one line.
inline std::string printable(std::string_view text, std::size_t longest = 60) {
    std::string result(text.substr(0, longest));
    for (char& c : result) {
        if (c < ' ' || c > '~') c = '?';
    }
    return result + (text.size() > longest ? "..." : "");
}

}  // namespace tonewright
