// SPDX-License-Identifier: Apache-2.0
//
// Progress of a command: a line on a terminal, or lines for programs on standard output.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "cli/messages.h"
#include "tasks/listener.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// After a command that succeeded: the line of 100 %, if it has written lines.
void finish_progress();

/// A part of a command's work.
struct ProgressFacts {
    /// The counted things in the plural: "frames". Empty: only their share is shown.
    std::string unit = {};
    /// Number of things. 0: not known (yet).
    std::size_t total = 0;
    /// File descriptor of the terminal, or -1. Another file gets nothing.
    int terminal = 2;
    /// The part's place in the whole command, in percent.
    double from = 0;
    double to = 100;
};

/// The progress of work while it lives.
///
/// `--progress bar`: a line on a terminal after the first second, which the destructor clears:
/// "config: 12 s", "apply: 42 %, 3 s, 4 s left", "[####      ] 84/200 frames, 42 %, 6.9 per second,
/// 17 s left". With --quiet there is none.
///
/// `--progress json` and `openjd`: at most one line a per cent on standard output, in increasing
/// order from 0, also with --quiet. 100 comes from finish_progress(), so a failed command has none.
class Progress {
  public:
    explicit Progress(std::string task, ProgressFacts facts = {});
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// From any thread.
    void set(std::size_t done, std::size_t total);
    /// Counts one thing, from any thread.
    /// @param took_time  false for a skipped thing, which does not count for the remaining time
    void add(bool took_time);
    /// Runs `print` while the line is off the terminal.
    void print_over(const std::function<void()>& print);
    /// For a task: warnings are printed over the line.
    [[nodiscard]] Listener listener();

  private:
    using Clock = std::chrono::steady_clock;
    void run();
    void clear();
    void report() const;
    [[nodiscard]] double share() const;
    [[nodiscard]] std::string text(double seconds) const;

    std::string task_;
    ProgressFacts facts_;
    std::size_t done_ = 0;
    std::size_t made_ = 0;  // of these, took time
    Clock::time_point start_ = Clock::now();
    std::mutex mutex_;
    std::condition_variable end_;
    bool is_ended_ = false;
    bool is_shown_ = false;
    std::thread thread_;  // none where there is no terminal
};

/// Runs a task that takes a Listener. Its warnings are printed.
template <class Task>
auto with_progress(const std::string& name, const Task& task) {
    Progress progress(name);
    return task(progress.listener());
}

TONEWRIGHT_NAMESPACE_END
