// SPDX-License-Identifier: Apache-2.0
#include "cli/elapsed_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <system_error>

#include "cli/messages.h"

TONEWRIGHT_NAMESPACE_BEGIN

ElapsedLine::ElapsedLine(const std::string& what, int terminal,
                         std::chrono::steady_clock::time_point start) {
    if (message_options().is_quiet || terminal < 0 || ::isatty(terminal) == 0) return;
    try {
        thread_ = std::thread([this, what, terminal, start] { run(what, terminal, start); });
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

void ElapsedLine::run(const std::string& what, int terminal,
                      std::chrono::steady_clock::time_point start) {
    using std::chrono::duration_cast, std::chrono::seconds, std::chrono::steady_clock;
    constexpr int kFirst = 2;
    const auto passed =
        static_cast<int>(duration_cast<seconds>(steady_clock::now() - start).count());
    bool is_shown = false;
    std::unique_lock lock(mutex_);
    for (int second = std::max(kFirst, passed + 1); !is_ended_; ++second) {
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
