// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Input that a LUT file of Tonewright states.
struct StatedInput {
    /// Id of an input encoding; `linear` for scene-linear input.
    std::string encoding;
    /// Id of the input space.
    std::string space;
    /// Text for messages: "DaVinci Intermediate, of scene-linear Linear Rec.709".
    std::string text;
};

/// Reads the line that write_lut() writes into all files that can hold text: comments,
/// descriptions, metadata, the copyright of a device link.
/// @param contents  of the file: a whole device link, or the beginning of any other file
/// @returns  nothing if no line of Tonewright states it
[[nodiscard]] TONEWRIGHT_API std::optional<StatedInput> read_stated_input(
    std::string_view contents);

/// Reads the stated output like read_stated_input(): the id of the display of its code values, or
/// `linear`. Nothing for an operator's native values.
[[nodiscard]] TONEWRIGHT_API std::optional<std::string> read_stated_display(
    std::string_view contents);

TONEWRIGHT_NAMESPACE_END
