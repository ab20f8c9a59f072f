// SPDX-License-Identifier: Apache-2.0
//
// Text in the language of man(7).
#pragma once

#include <string>
#include <string_view>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Text that man prints as it is, so that a reader can copy every `-` and `'` of it.
[[nodiscard]] std::string roff_escape(std::string_view text);
/// Prose: `code` and `--option` in bold, Markdown links as their text.
[[nodiscard]] std::string roff_prose(std::string_view text);
/// Lines that man does not fill.
[[nodiscard]] std::string roff_lines(std::string_view lines);

/// The sections of a Markdown document with level-2 headings as .SH. Tables become .TP lists. Fonts
/// of terminals differ in box-drawing and Braille characters, so the page leaves plots out.
/// @param first_row  the start of a table row: the section that has it is the first one converted
/// @throws Error     no section has it
[[nodiscard]] std::string roff_of_markdown(std::string_view markdown, std::string_view first_row);

TONEWRIGHT_NAMESPACE_END
