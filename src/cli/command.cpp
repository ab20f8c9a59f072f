// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN

Settings ViewOptions::settings() const {
    Settings result;
    for (const std::string& text : set) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0) {
            throw Error("--set is " + text + "; expected name=value");
        }
        const std::string value = text.substr(equals + 1);
        const auto [known, is_new] = result.emplace(text.substr(0, equals), value);
        if (!is_new && known->second != value) {
            throw Error("--set: " + known->first + " is " + known->second + " and " + value +
                        "; expected it once");
        }
    }
    return result;
}

View ViewOptions::view() const {
    return make_view(resolve_operator(op, settings(), look), input, exposure, display,
                     reference_white);
}

TONEWRIGHT_NAMESPACE_END
