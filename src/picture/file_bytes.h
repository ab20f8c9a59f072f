// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>
#include <utility>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A file that is open for writing.
class OpenFile {
  public:
    explicit OpenFile(int file) : file_(file) {}
    ~OpenFile() { (void)close(); }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;

    /// Replaces bytes that were written.
    /// @returns  0 or an errno
    [[nodiscard]] int patch(std::size_t place, std::string_view bytes) const;
    /// Lets the system begin to write to the disk what the file has, where it has a call for it. So
    /// the file that is complete waits less for its disk, which reports what fails.
    void begin_sync() const;
    /// @returns  0 or an errno
    [[nodiscard]] int close();
    /// Gives the descriptor to another owner.
    [[nodiscard]] int release() { return std::exchange(file_, -1); }
    [[nodiscard]] int descriptor() const { return file_; }

  private:
    int file_;
};

/// Passes all bytes to the system.
/// @throws FileError  with the system's reason and its number
void write_all(int file, const void* bytes, std::size_t count);

TONEWRIGHT_NAMESPACE_END
