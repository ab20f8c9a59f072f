// SPDX-License-Identifier: Apache-2.0
#include "cli/pictures/progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include "cli/messages.h"

TONEWRIGHT_NAMESPACE_BEGIN

ProgressBar::ProgressBar(int terminal, std::size_t count, const char* what)
    : terminal_(!message_options().is_quiet && terminal >= 0 && ::isatty(terminal) ? terminal : -1),
      count_(count),
      what_(what) {}

ProgressBar::~ProgressBar() { show("\r\033[K"); }

void ProgressBar::add(bool took_time) {
    ++done_;
    made_ += took_time ? 1 : 0;
    constexpr double kInterval = 0.1;
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (terminal_ < 0 || seconds < next_ || done_ > count_) return;
    next_ = seconds + kInterval;
    constexpr std::size_t kWidth = 40;
    const std::size_t filled = kWidth * done_ / count_;
    std::string text = fmt::format("\r[{}{}] {}/{} {}", std::string(filled, '#'),
                                   std::string(kWidth - filled, ' '), done_, count_, what_);
    if (made_ > 0) {
        const double rate = static_cast<double>(made_) / seconds;
        text += fmt::format(", {:.1f} per second, {:.0f} s left", rate,
                            static_cast<double>(count_ - done_) / rate);
    }
    show(text + "\033[K");
}

void ProgressBar::show(const std::string& text) const {
    if (terminal_ >= 0 && next_ > kFirst) (void)!::write(terminal_, text.data(), text.size());
}

TONEWRIGHT_NAMESPACE_END
