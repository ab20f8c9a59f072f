// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace tonewright {

/// Of ASCII, whatever the locale.
inline std::string lowercase(std::string_view text) {
    std::string result(text);
    for (char& c : result) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return result;
}

/// The extension of a path in lower case, with its dot; empty where there is none.
inline std::string extension_of(const std::string& path) {
    return lowercase(std::filesystem::path(path).extension().string());
}

}  // namespace tonewright
