// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace tonewright {

/// What a caller did wrong, in one line:
/// `<operation>: <parameter> is <value>; expected <interval or choices>[; did you mean
/// <nearest>?]`.
///
/// The core throws it; image functions turn it into an error on the destination image; the command
/// prints it and exits with 2 (usage).
class Error : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A file could not be read or written. The command exits with 3.
class FileError : public Error {
  public:
    using Error::Error;
};

/// The candidate with the smallest edit distance to `name`, or empty when none is near enough to be
/// a likely slip of the fingers (more than a third of the letters wrong).
[[nodiscard]] std::string nearest_name(std::string_view name,
                                       const std::vector<std::string>& candidates);

/// `; did you mean <nearest>?`, or empty.
[[nodiscard]] std::string did_you_mean(std::string_view name,
                                       const std::vector<std::string>& candidates);

/// `a, b or c`.
[[nodiscard]] std::string join_choices(const std::vector<std::string>& choices);

/// Shortest decimal text that reads back as the same double ("0.1", "1e-10", "inf").
[[nodiscard]] std::string shortest(double value);

}  // namespace tonewright
