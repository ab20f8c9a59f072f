// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Limits of OpenColorIO.
inline constexpr int kLargestCube = 129;
inline constexpr int kLargestTable = 1048576;
/// OpenColorIO 2.1 copies a depth into a buffer of 16 without a look at its length.
inline constexpr std::size_t kLongestDepth = 15;

inline constexpr std::string_view kBlank = " \t\r\v\f";

/// Parses the whole text; overflow is infinite, underflow is 0.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);
/// True if a float can hold it: it is finite, too.
[[nodiscard]] bool is_float(double value);
[[nodiscard]] bool begins_keyword(std::string_view word);
[[nodiscard]] bool begins_number(std::string_view word);
/// Nodes of a 3D LUT with this many a side.
[[nodiscard]] std::size_t cubed(int n);

/// The file, word by word or line by line.
class TextLines {
  public:
    TextLines(const std::string& path, std::string_view text)
        : path_(path), all_(text), rest_(text) {}

    /// The whole file.
    [[nodiscard]] std::string_view all() const { return all_; }

    /// @return false at the end
    bool next_line();
    /// The next word of the line; empty at its end.
    std::string_view word();
    /// Before any of its words is taken.
    void rewind() { words_ = line_; }
    /// Moves to the first line that has a word and is no comment, before its first word.
    bool next_filled(bool has_comments = true);
    /// For formats that OpenColorIO reads by line into a buffer of 4096.
    void check_length() const;
    [[nodiscard]] std::string_view line() const { return line_; }

    /// Skips the line, whose first word is a keyword of an application. It may change the meaning
    /// of the table, so the user must know.
    void ignore_keyword(std::string_view keyword);
    /// One line about what was ignored; empty if nothing was.
    [[nodiscard]] const std::string& note() const { return note_; }

    [[nodiscard]] int line_number() const { return number_; }

    [[noreturn]] void fail(const std::string& reason) const { fail_at(number_, reason); }
    [[noreturn]] void fail_at(int line, const std::string& reason) const;
    /// "line 3: 0 0 x; expected three numbers".
    [[noreturn]] void refuse(const std::string& expected) const;
    /// "line 2: LUT_3D_SIZE is 1000; expected [2, 129]".
    [[noreturn]] void refuse(std::string_view name, std::string_view value,
                             const std::string& expected) const;
    /// At the end of the file: "line 9: the file ends; expected 9 rows".
    [[noreturn]] void end(const std::string& expected) const {
        fail("the file ends; expected " + expected);
    }
    [[noreturn]] void end_early(std::size_t found, std::size_t expected) const;
    [[noreturn]] void too_many_rows(std::size_t expected) const;

    double number(std::string_view name, std::string_view text) const;
    int size(std::string_view name, std::string_view text, int lo, int hi) const;
    /// Reads three equal sizes of a 3D LUT.
    int edge();
    /// Reads the rest of the line as this many finite numbers.
    std::array<float, 3> numbers(int count);

  private:
    const std::string& path_;
    std::string_view all_;
    std::string_view rest_;
    std::string_view line_;
    std::string_view words_;
    std::string note_;
    int number_ = 0;
};

/// Rows of three numbers, as many as declared.
class TableRows {
  public:
    void expect(std::size_t count) { expected_ += count; }
    [[nodiscard]] std::size_t found() const { return found_; }
    std::array<float, 3> add(TextLines& text);
    void finish(const TextLines& text) const;

  private:
    std::size_t expected_ = 0;
    std::size_t found_ = 0;
};

TONEWRIGHT_NAMESPACE_END
