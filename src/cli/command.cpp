// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN

Settings ViewOptions::settings() const {
    Settings result;
    for (const std::string& text : set) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0) {
            throw Error("--set: setting is " + text + "; expected name=value");
        }
        result[text.substr(0, equals)] = text.substr(equals + 1);
    }
    return result;
}

View ViewOptions::view() const {
    return make_view(resolve_operator(op, settings(), look), input, exposure, display,
                     reference_white);
}

TONEWRIGHT_NAMESPACE_END
