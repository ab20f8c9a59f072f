// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A problem as a record. Applications that have names of their own for the parameters of a
/// request render it with them.
///
/// Its texts may refer to parameters: `<<size>>`, or `<<size=65>>` with a value that helps. So may
/// warnings of the libraries. `<<list=operators>>` refers to a list of choices (`operators`,
/// `inputs`), `<<task=apply>>` to something that the application can do.
struct TONEWRIGHT_API Problem {
    enum class Kind {
        usage,     ///< a wrong request
        file,      ///< a file cannot be read or written, or is damaged
        memory,    ///< not enough memory, or no thread
        canceled,  ///< the caller stopped the work
        check,     ///< a check failed
        internal,  ///< of this library, or of another one
    };
    Kind kind = Kind::usage;
    /// A file, an operator, ..., which `parameter` belongs to. Empty: the request itself. A problem
    /// in words of its own has them all here.
    std::string what = {};
    /// The request's field, `size`, or a name within `what`. Empty: `value` says it all.
    std::string parameter = {};
    std::string value = {};
    /// An interval, choices, or a remedy.
    std::string expected = {};
    /// A value that is probably meant.
    std::string suggestion = {};
    /// The system's, for a file; 0: none.
    int error_number = 0;
};

/// Style in which an application writes a parameter of a request. Default: `size is 3`, and
/// `size=65`.
struct MessageStyle {
    /// Before "is" and a value.
    std::string (*name)(std::string_view parameter) = nullptr;
    /// In a remedy. An empty value: the parameter alone.
    std::string (*setting)(std::string_view parameter, std::string_view value) = nullptr;
};

/// `<what>: <parameter> is <value>; expected <expected>; did you mean <suggestion>?`, without the
/// parts that are empty.
[[nodiscard]] TONEWRIGHT_API std::string render(const Problem& problem,
                                                const MessageStyle& style = {});
/// A text with its references written in a style.
[[nodiscard]] TONEWRIGHT_API std::string render(std::string_view text,
                                                const MessageStyle& style = {});
/// render() without replacing references: for a message that contains this one.
[[nodiscard]] TONEWRIGHT_API std::string unrendered(const Problem& problem);
/// The same problem in a larger thing, such as a file.
[[nodiscard]] TONEWRIGHT_API Problem within(std::string_view what, Problem problem);

/// An error of the caller. what() is the problem in one line.
///
/// The core throws it. Image functions put it on the destination image. The command prints it and
/// exits with 2 (usage).
class TONEWRIGHT_API Error : public std::runtime_error {
  public:
    explicit Error(const std::string& text) : Error(Problem{Problem::Kind::usage, text}) {}
    explicit Error(Problem problem);

    [[nodiscard]] const Problem& problem() const noexcept { return *problem_; }
    /// For a message that has this one in it; @see unrendered
    [[nodiscard]] std::string text() const { return unrendered(*problem_); }

  private:
    std::shared_ptr<const Problem> problem_;  // copies of exceptions must not throw
};

/// A file could not be read or written, or there was no memory for it. The command exits with 3.
class TONEWRIGHT_API FileError : public Error {
  public:
    explicit FileError(const std::string& text) : FileError(Problem{Problem::Kind::file, text}) {}
    /// A problem of kind `usage` becomes one of kind `file`.
    explicit FileError(Problem problem);
};

TONEWRIGHT_NAMESPACE_END
