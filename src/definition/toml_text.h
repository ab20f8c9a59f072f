// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formula/formula.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A value of a TOML file, with its place.
struct TomlValue {
    enum class Kind : unsigned char { boolean, number, text, date, array, table };
    Kind kind = Kind::table;
    TextPosition at;
    bool boolean = false;
    double number = 0;
    std::string text = {};
    std::vector<TomlValue> items = {};
    std::vector<TomlValue> members = {};  // of a table, in the order of the file
    // For a member:
    std::string key = {};
    TextPosition key_at = {};
};

/// An error of a file, with its position.
class TomlError : public Error {
  public:
    TomlError(TextPosition where, const std::string& message) : Error(message), at(where) {}
    TextPosition at;
};

/// @throws TomlError
[[nodiscard]] TomlValue parse_toml(std::string_view text);

TONEWRIGHT_NAMESPACE_END
