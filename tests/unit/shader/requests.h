// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tonewright/registry.h"
#include "tonewright/shader.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

inline ShaderRequest request_of(const std::string& op, const std::string& look = "",
                                const std::string& display = "linear",
                                ShaderLanguage language = ShaderLanguage::glsl) {
    ShaderRequest request;
    request.view = make_view(resolve_operator(op, {}, look), "lin_rec709", 0, display);
    request.language = language;
    return request;
}

TONEWRIGHT_NAMESPACE_END
