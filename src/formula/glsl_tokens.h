// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct GlslToken {
    enum class Kind : unsigned char { end, number, name, sign };
    Kind kind = Kind::end;
    /// Position in the text; for a macro's token, the use of the macro.
    std::size_t begin = 0;
    std::string_view text;

    [[nodiscard]] bool is(std::string_view sign) const {
        return kind == Kind::sign && text == sign;
    }
    [[nodiscard]] bool is_name(std::string_view name) const {
        return kind == Kind::name && text == name;
    }
};

/// The tokens of a shader, without comments, its macros replaced. The last one is the end.
/// @param text  outlives the tokens
/// @throws FormulaError
[[nodiscard]] std::vector<GlslToken> glsl_tokens(std::string_view text);

TONEWRIGHT_NAMESPACE_END
