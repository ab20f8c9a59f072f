// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "tonewright/color.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The three numbers of a line of `tonewright eval`, or none if it is blank or a comment.
/// @param number  of the line, for the message
/// @throws Error
[[nodiscard]] std::optional<Vector3> parse_color_line(std::string_view line, std::size_t number);

TONEWRIGHT_NAMESPACE_END
