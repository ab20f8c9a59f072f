// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// What a LUT file of ours says that goes in.
struct StatedInput {
    /// Id of an input encoding; `linear` where light goes in as it is.
    std::string encoding;
    /// Id of the input space whose light that is.
    std::string space;
    /// For people: "DaVinci Intermediate, of scene-linear Linear Rec.709".
    std::string text;
};

/// Reads the line that write_lut() puts into all files that have room for text: comments,
/// descriptions, metadata, the copyright of a device link.
/// @param contents  of the file: all of a device link; of the others the beginning is enough
/// @returns  nothing where no line of ours says it
[[nodiscard]] TONEWRIGHT_API std::optional<StatedInput> read_stated_input(
    std::string_view contents);

/// What comes out, as read_stated_input() reads what goes in: the id of the display whose code
/// values they are, or `linear`. Nothing for the values of an operator itself.
[[nodiscard]] TONEWRIGHT_API std::optional<std::string> read_stated_display(
    std::string_view contents);

TONEWRIGHT_NAMESPACE_END
