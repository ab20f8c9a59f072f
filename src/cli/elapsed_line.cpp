// SPDX-License-Identifier: Apache-2.0
#include "cli/elapsed_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <system_error>

#include "cli/messages.h"

TONEWRIGHT_NAMESPACE_BEGIN

ElapsedLine::ElapsedLine(const std::string& what, int terminal) {
    if (message_options().is_quiet || terminal < 0 || ::isatty(terminal) == 0) return;
    try {
        thread_ = std::thread([this, what, terminal] { run(what, terminal); });
    } catch (const std::system_error&) {
        // If there are no more threads, the work continues without the line.
    }
}

ElapsedLine::~ElapsedLine() {
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        is_ended_ = true;
    }
    end_.notify_all();
    thread_.join();
}

void ElapsedLine::run(const std::string& what, int terminal) {
    constexpr int kFirst = 2;
    const auto start = std::chrono::steady_clock::now();
    bool is_shown = false;
    std::unique_lock lock(mutex_);
    for (int second = kFirst; !is_ended_; ++second) {
        if (end_.wait_until(lock, start + std::chrono::seconds(second),
                            [this] { return is_ended_; }))
            break;
        const std::string text = fmt::format("\r{}: {} s\033[K", what, second);
        (void)!::write(terminal, text.data(), text.size());
        is_shown = true;
    }
    constexpr std::string_view kClear = "\r\033[K";
    if (is_shown) (void)!::write(terminal, kClear.data(), kClear.size());
}

TONEWRIGHT_NAMESPACE_END
