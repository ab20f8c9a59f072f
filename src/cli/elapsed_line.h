// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// On a terminal, shows the seconds of work that takes longer than two: "config: 12 s". The
/// destructor clears the line. With --quiet there is none.
class ElapsedLine {
  public:
    /// @param what      the work in progress
    /// @param terminal  a file descriptor, or -1
    explicit ElapsedLine(const std::string& what, int terminal = 2);
    ~ElapsedLine();
    ElapsedLine(const ElapsedLine&) = delete;
    ElapsedLine& operator=(const ElapsedLine&) = delete;

  private:
    void run(const std::string& what, int terminal);

    std::mutex mutex_;
    std::condition_variable end_;
    bool is_ended_ = false;
    std::thread thread_;  // none where there is no terminal
};

TONEWRIGHT_NAMESPACE_END
