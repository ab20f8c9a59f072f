// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "tonewright/registry.h"

#include <algorithm>

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

void add_view_options(CLI::App& command, ViewOptions& options) {
    command.add_option("--set", options.set, "operator parameter, name=value; repeat for more")
        ->allow_extra_args(false);
    command.add_option("--look", options.look, "look of the operator");
    command.add_option("--exposure", options.exposure, "stops, before the operator")
        ->capture_default_str();
    command.add_option("--input", options.input, "scene-linear space of the input")
        ->capture_default_str();
    command
        .add_option("--display", options.display,
                    "display, or `linear` (display-linear Rec.709, unclamped), or `native` (the "
                    "operator's own output)")
        ->capture_default_str();
    command
        .add_option("--reference-white", options.reference_white,
                    "what an HDR display shows light 1 at, cd/m2; 203 as BT.2408 has it")
        ->capture_default_str();
}

TONEWRIGHT_NAMESPACE_END
