// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/error.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Folds ASCII letters, in every locale.
[[nodiscard]] TONEWRIGHT_API std::string lowercase(std::string_view text);
/// The extension of a path in lower case, with its dot; empty if there is none.
[[nodiscard]] TONEWRIGHT_API std::string extension_of(const std::string& path);
/// Without the blanks (space, tab, line ends) at both ends.
[[nodiscard]] TONEWRIGHT_API std::string_view trimmed(std::string_view text);
/// The problem in a library's message, as first_line() has it. Libraries say in words only that
/// memory ran out, so this is the one place that looks for such words.
[[nodiscard]] TONEWRIGHT_API Problem problem_of_library(std::string_view text);
/// The first line of a library's message; "unknown error" for an empty one. A message about
/// memory becomes "not enough memory".
[[nodiscard]] TONEWRIGHT_API std::string first_line(std::string_view text);
/// A library's message as one line, with "not enough memory" as in first_line(). Runs of blanks and
/// line ends become one space; other control characters, and bytes that are not UTF-8, become `?`.
/// Text beyond `longest` bytes becomes `...`.
[[nodiscard]] TONEWRIGHT_API std::string one_line(std::string_view text,
                                                  std::size_t longest = 2000);
/// The text, if it is UTF-8. Else with `\xe9` for every byte that is not, as Python's
/// `backslashreplace` has it: the text can be shown, and names that differ stay different.
[[nodiscard]] TONEWRIGHT_API std::string utf8_text(std::string_view text);
/// Untrusted text, fit for a message of one line: every other byte than printable ASCII becomes
/// `?`, and a long text ends in `...`.
[[nodiscard]] TONEWRIGHT_API std::string printable(std::string_view text, std::size_t longest = 60);
/// Text as XML character data or attribute value.
[[nodiscard]] TONEWRIGHT_API std::string xml_escape(std::string_view text);
/// FNV-1a, 32 bits, as 8 hexadecimal digits.
[[nodiscard]] TONEWRIGHT_API std::string content_hash(std::string_view contents);

/// A name as names are compared: in lower case, and runs of blanks, `-` and `_` are one `_`.
[[nodiscard]] TONEWRIGHT_API std::string folded_name(std::string_view name);
/// True if both names are the same after folding.
[[nodiscard]] TONEWRIGHT_API bool is_same_name(std::string_view a, std::string_view b);

/// Something that a user can name: its id, and its other names.
struct NamedChoice {
    std::string id;
    std::vector<std::string> names = {};
};
/// The choices that `name` probably means, at most three, the best first: those that contain it as
/// a word ("p3" in display_p3), else those that begin with it, else the nearest typing error. In a
/// typing error, at most a third of the letters are wrong, and digits count twice: rec709 and
/// rec2020 are different things.
[[nodiscard]] TONEWRIGHT_API std::vector<std::string> likely_names(
    std::string_view name, const std::vector<NamedChoice>& choices);
/// `a, b or c` of them, or empty.
[[nodiscard]] TONEWRIGHT_API std::string suggested_names(
    std::string_view name, const std::vector<std::string>& candidates);
[[nodiscard]] TONEWRIGHT_API std::string suggested_names(std::string_view name,
                                                         const std::vector<NamedChoice>& choices);
/// The first of them, or empty.
[[nodiscard]] TONEWRIGHT_API std::string nearest_name(std::string_view name,
                                                      const std::vector<std::string>& candidates);
/// `; did you mean <nearest>?`, or empty.
[[nodiscard]] TONEWRIGHT_API std::string did_you_mean(std::string_view name,
                                                      const std::vector<std::string>& candidates);
[[nodiscard]] TONEWRIGHT_API std::string did_you_mean(std::string_view name,
                                                      const std::vector<NamedChoice>& choices);
/// The index of the choice that `text` names, once folded.
/// @param parameter  of `what`; empty: of the request
/// @throws Error  a Problem of this parameter
[[nodiscard]] TONEWRIGHT_API std::size_t find_choice(std::string_view parameter,
                                                     std::string_view text,
                                                     const std::vector<std::string>& choices,
                                                     std::string_view what = {});
/// `a, b or c`.
[[nodiscard]] TONEWRIGHT_API std::string join_choices(const std::vector<std::string>& choices);

TONEWRIGHT_NAMESPACE_END
