// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "cli/messages.h"
#include "tasks/listener.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// On a terminal, shows the seconds of work that takes longer than two: "config: 12 s". The
/// destructor clears the line. With --quiet there is none.
class ElapsedLine {
  public:
    /// @param what      the work in progress
    /// @param terminal  a file descriptor, or -1
    /// @param start     of the work
    explicit ElapsedLine(
        const std::string& what, int terminal = 2,
        std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now());
    ~ElapsedLine();
    ElapsedLine(const ElapsedLine&) = delete;
    ElapsedLine& operator=(const ElapsedLine&) = delete;

  private:
    void run(const std::string& what, int terminal, std::chrono::steady_clock::time_point start);

    std::mutex mutex_;
    std::condition_variable end_;
    bool is_ended_ = false;
    std::thread thread_;  // none where there is no terminal
};

/// Runs a task that takes a Listener, with such a line. Its warnings are printed.
template <class Task>
auto with_elapsed_line(const std::string& what, const Task& task) {
    const auto start = std::chrono::steady_clock::now();
    std::optional<ElapsedLine> line(std::in_place, what);
    return task(Listener{.warn = [&](const std::string& text) {
        line.reset();
        warn(text);
        line.emplace(what, 2, start);
    }});
}

TONEWRIGHT_NAMESPACE_END
