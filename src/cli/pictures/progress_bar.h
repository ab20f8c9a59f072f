// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Progress of the frames of a shot or of several pictures, on a terminal only, after the first
/// half second.
class ProgressBar {
  public:
    /// @param terminal  a file descriptor, or -1
    /// @param what      is counted: "frames"
    ProgressBar(int terminal, std::size_t count, const char* what = "frames");
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// The count becomes another one: that of the frames to meter.
    void expect(std::size_t count) { count_ = count; }
    /// Counts one frame.
    /// @param took_time  false for a skipped frame, which does not count for the remaining time
    void add(bool took_time);

  private:
    void show(const std::string& text) const;

    static constexpr double kFirst = 0.5;
    int terminal_;
    std::size_t count_;
    const char* what_;
    std::size_t done_ = 0;
    std::size_t made_ = 0;
    double next_ = kFirst;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

TONEWRIGHT_NAMESPACE_END
