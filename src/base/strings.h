// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Folds ASCII letters, whatever the locale.
[[nodiscard]] TONEWRIGHT_API std::string lowercase(std::string_view text);
/// Compares without regard to the case of ASCII letters.
[[nodiscard]] TONEWRIGHT_API bool equal_ignoring_case(std::string_view a, std::string_view b);
/// The extension of a path in lower case, with its dot; empty if there is none.
[[nodiscard]] TONEWRIGHT_API std::string extension_of(const std::string& path);
/// Without the blanks (space, tab, line ends) at both ends.
[[nodiscard]] TONEWRIGHT_API std::string_view trimmed(std::string_view text);
/// The first line of a message that may have several; "unknown error" for an empty one.
[[nodiscard]] TONEWRIGHT_API std::string first_line(std::string_view text);
/// Untrusted text, fit for a message of one line: every other byte than printable ASCII becomes
/// `?`, and a long text ends in `...`.
[[nodiscard]] TONEWRIGHT_API std::string printable(std::string_view text, std::size_t longest = 60);
/// Text as XML character data or attribute value.
[[nodiscard]] TONEWRIGHT_API std::string xml_escape(std::string_view text);
/// FNV-1a, 32 bits, as 8 hexadecimal digits.
[[nodiscard]] TONEWRIGHT_API std::string content_hash(std::string_view contents);

/// The candidate with the smallest edit distance to `name`, or empty when none is near enough to be
/// a likely typing mistake (more than a third of the letters wrong).
[[nodiscard]] TONEWRIGHT_API std::string nearest_name(std::string_view name,
                                                      const std::vector<std::string>& candidates);
/// `; did you mean <nearest>?`, or empty.
[[nodiscard]] TONEWRIGHT_API std::string did_you_mean(std::string_view name,
                                                      const std::vector<std::string>& candidates);
/// `a, b or c`.
[[nodiscard]] TONEWRIGHT_API std::string join_choices(const std::vector<std::string>& choices);

TONEWRIGHT_NAMESPACE_END
