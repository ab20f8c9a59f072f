// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Another program, started without a shell. The destructor ends it.
class ChildProcess {
  public:
    /// @param words   program, which is looked for on the PATH, and its arguments
    /// @param input   file descriptors of its standard streams
    /// @throws Error  the program cannot be started
    ChildProcess(std::vector<std::string> words, int input, int output, int messages);
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// Waits until it ends; true if it succeeded.
    bool succeeds();

  private:
    pid_t id_ = 0;  // 0: has ended
};

/// A file descriptor that is closed in the end, and before another program starts.
class OwnedDescriptor {
  public:
    explicit OwnedDescriptor(int descriptor = -1) : descriptor_(descriptor) {}
    /// A file that is written, from its beginning.
    explicit OwnedDescriptor(const std::string& path);
    ~OwnedDescriptor();
    OwnedDescriptor(const OwnedDescriptor&) = delete;
    OwnedDescriptor& operator=(const OwnedDescriptor&) = delete;
    [[nodiscard]] int get() const { return descriptor_; }

  private:
    int descriptor_;
};

/// Runs a program to its end.
/// @param log  a file for its output
/// @throws Error  it cannot be started, or fails: with its first error message
void run_program(const std::vector<std::string>& words, const std::string& log);

/// The first line of a file of messages that is about an error, else the first line.
[[nodiscard]] std::string first_error(const std::string& log);

TONEWRIGHT_NAMESPACE_END
