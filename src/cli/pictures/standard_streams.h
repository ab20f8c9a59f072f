// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/picture_options.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The names `-` of `apply`: standard input and output. Both are files of a private folder while
/// the command runs, because headers such as cLLI are known last, and readers seek.
class StandardStreams {
  public:
    /// Reads standard input, and replaces the names in `options`.
    /// @throws Error      standard output is a terminal or has no --format; several inputs
    /// @throws FileError  nothing, more than the limit of the pixels allows, or an unknown format
    explicit StandardStreams(ApplyOptions& options);
    /// Removes the folder.
    ~StandardStreams();
    StandardStreams(const StandardStreams&) = delete;
    StandardStreams& operator=(const StandardStreams&) = delete;

    /// Copies the complete output.
    /// @throws FileError
    void finish() const;
    /// A message with `-` instead of the names of the files.
    [[nodiscard]] std::string with_dashes(std::string text) const;

  private:
    void make_folder();
    void remove_folder() noexcept;
    void read_input(ApplyOptions& options);

    std::string folder_;
    std::string in_;
    std::string out_;
};

TONEWRIGHT_NAMESPACE_END
