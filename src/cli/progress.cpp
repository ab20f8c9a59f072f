// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string_view>
#include <system_error>
#include <utility>

#include "tasks/json.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr double kAll = 100;  // percent

void write_to(int terminal, std::string_view text) {
    (void)!::write(terminal, text.data(), text.size());
}

/// A line on standard output, at once, because its reader is another program. The end of the
/// program reports errors of writing: this may be a thread of the work.
void print_line(const std::string& text) {
    std::fputs((text + "\n").c_str(), stdout);
    std::fflush(stdout);
}

/// Prints a line if the per cent is a new one.
/// @param facts  null: without numbers of things
void report_percent(int percent, const ProgressFacts* facts, std::size_t done) {
    const MessageOptions& messages = message_options();
    if (!messages.reports_progress() || percent <= *messages.percent) return;
    *messages.percent = percent;
    if (messages.progress == "openjd") {
        print_line(fmt::format("openjd_progress: {}", percent));
        return;
    }
    Json line = {{"progress", percent}, {"task", messages.command}};
    if (facts && facts->total > 0) {
        line.add("done", std::uint64_t{done});
        line.add("total", std::uint64_t{facts->total});
        if (!facts->unit.empty()) line.add("unit", facts->unit);
    }
    print_line(line.dump());
}

}  // namespace

void finish_progress() {
    for (const int percent : {0, 100})
        report_percent(percent, nullptr, 0);
}

Progress::Progress(std::string task, ProgressFacts facts)
    : task_(std::move(task)), facts_(std::move(facts)) {
    const MessageOptions& messages = message_options();
    if (messages.progress == "openjd" && facts_.total > 0) {
        // Farms show the status beside the progress.
        print_line(fmt::format("openjd_status: {}: {} {}", task_, facts_.total, facts_.unit));
    }
    report_percent(0, &facts_, 0);  // also if another part begins elsewhere
    report();
    if (messages.is_quiet || messages.progress != "bar" || facts_.terminal < 0 ||
        ::isatty(facts_.terminal) == 0)
        return;
    try {
        thread_ = std::thread([this] { run(); });
    } catch (const std::system_error&) {
        // If there are no more threads, the work continues without the line.
    }
}

Progress::~Progress() {
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        is_ended_ = true;
        clear();
    }
    end_.notify_all();
    thread_.join();
}

void Progress::set(std::size_t done, std::size_t total) {
    const std::lock_guard lock(mutex_);
    facts_.total = total;
    done_ = made_ = done;
    report();
}

void Progress::add(bool took_time) {
    const std::lock_guard lock(mutex_);
    ++done_;
    made_ += took_time ? 1 : 0;
    report();
}

void Progress::print_over(const std::function<void()>& print) {
    const std::lock_guard lock(mutex_);
    clear();
    print();
}

Listener Progress::listener() {
    return {.warn = [this](const std::string& text) { print_over([&] { warn(text); }); },
            .progress = [this](std::size_t done, std::size_t total) { set(done, total); }};
}

void Progress::clear() {
    if (is_shown_) write_to(facts_.terminal, "\r\033[K");
    is_shown_ = false;
}

double Progress::share() const {
    return facts_.total == 0
               ? 0
               : std::min(static_cast<double>(done_) / static_cast<double>(facts_.total), 1.0);
}

void Progress::report() const {
    const double percent = facts_.from + (facts_.to - facts_.from) * share();
    // The whole is done when the command has succeeded.
    report_percent(std::min(static_cast<int>(percent), 99), &facts_, done_);
}

std::string Progress::text(double seconds) const {
    if (facts_.total == 0) return fmt::format("{}: {:.0f} s", task_, std::floor(seconds));
    const std::string left =
        made_ == 0 ? ""
                   : fmt::format(", {:.0f} s left", static_cast<double>(facts_.total - done_) *
                                                        seconds / static_cast<double>(made_));
    if (facts_.unit.empty()) {
        return fmt::format("{}: {:.0f} %, {:.0f} s{}", task_, std::floor(kAll * share()),
                           std::floor(seconds), left);
    }
    constexpr std::size_t kWidth = 40;
    const auto filled = static_cast<std::size_t>(kWidth * share());
    const std::string rate =
        made_ == 0 ? "" : fmt::format(", {:.1f} per second", static_cast<double>(made_) / seconds);
    return fmt::format("[{}{}] {}/{} {}, {:.0f} %{}{}", std::string(filled, '#'),
                       std::string(kWidth - filled, ' '), done_, facts_.total, facts_.unit,
                       std::floor(kAll * share()), rate, left);
}

void Progress::run() {
    using std::chrono::milliseconds;
    constexpr milliseconds kFirst(1000);
    constexpr milliseconds kInterval(500);
    std::unique_lock lock(mutex_);
    for (Clock::time_point next = start_ + kFirst;
         !end_.wait_until(lock, next, [this] { return is_ended_; }); next += kInterval) {
        const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
        write_to(facts_.terminal, "\r" + text(seconds) + "\033[K");
        is_shown_ = true;
    }
}

TONEWRIGHT_NAMESPACE_END
