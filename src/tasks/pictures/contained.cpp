// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/contained.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <exception>
#include <optional>
#include <string_view>

#include "base/problem.h"
#include "base/system_files.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Clock = std::chrono::steady_clock;

/// Message of a process: this byte and the value, or the digit of a problem's kind, its texts and
/// its error number, each with a zero byte behind it.
constexpr char kNoProblem = '-';

template <class AnyProblem>
auto texts_of(AnyProblem& problem) {
    return std::array{&problem.what, &problem.parameter, &problem.value, &problem.expected,
                      &problem.suggestion};
}

std::string message(const Problem& problem) {
    std::string bytes(1, static_cast<char>('0' + static_cast<int>(problem.kind)));
    for (const std::string* text : texts_of(problem)) {
        bytes += text->substr(0, text->find('\0'));
        bytes += '\0';
    }
    return bytes + fmt::to_string(problem.error_number);
}

Problem problem_in(std::string_view bytes) {
    Problem problem{.kind = static_cast<Problem::Kind>(bytes.front() - '0')};
    bytes.remove_prefix(1);
    for (std::string* text : texts_of(problem)) {
        const std::size_t end = std::min(bytes.find('\0'), bytes.size());
        *text = bytes.substr(0, end);
        bytes.remove_prefix(std::min(end + 1, bytes.size()));
    }
    (void)std::from_chars(bytes.data(), bytes.data() + bytes.size(), problem.error_number);
    return problem;
}

ContainedResult file_failure(const std::string& name, const std::string& reason) {
    return {.problem =
                Problem{.kind = Problem::Kind::file, .what = fmt::format("{}: {}", name, reason)}};
}

/// The work of the new process. It ends without destructors and exit handlers, which would wait for
/// threads that exist in the old process only.
[[noreturn]] void run_child(const std::function<std::string(std::size_t)>& work, std::size_t item,
                            int pipe, pid_t parent) {
    // SIGTERM removes unfinished files, as in the program itself.
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(1);
    std::string text;
    try {
        text = kNoProblem + work(item);
    } catch (const std::exception& e) {
        text = message(problem_of(e));
    }
    std::string_view left = text;
    while (!left.empty()) {
        const ssize_t count = ::write(pipe, left.data(), left.size());
        if (count < 0 && errno != EINTR) ::_exit(1);
        if (count > 0) left.remove_prefix(static_cast<std::size_t>(count));
    }
    ::_exit(0);
}

struct Process {
    std::size_t item;
    pid_t id;
    int pipe;
    Clock::time_point deadline;
    std::string text = {};
};

/// @returns  nothing if no process can be made; then errno has the reason
std::optional<Process> start(std::size_t item, double seconds,
                             const std::function<std::string(std::size_t)>& work) {
    std::array<int, 2> ends{};
    if (::pipe(ends.data()) != 0) return {};
    const pid_t parent = ::getpid();
    const pid_t id = ::fork();
    if (id == 0) {
        ::close(ends[0]);
        run_child(work, item, ends[1], parent);
    }
    const int error = errno;
    ::close(ends[1]);
    if (id < 0) {
        ::close(ends[0]);
        errno = error;
        return {};
    }
    const auto limit =
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    return Process{item, id, ends[0], Clock::now() + limit};
}

/// Reads the available bytes.
/// @returns  true at the end
bool read_more(Process& process) {
    std::array<char, 65536> bytes;
    const ssize_t count = ::read(process.pipe, bytes.data(), bytes.size());
    if (count < 0) return errno != EINTR;
    process.text.append(bytes.data(), static_cast<std::size_t>(count));
    return count == 0;
}

/// The result of a process that has closed its pipe.
ContainedResult result_of(const Process& process, const std::string& name) {
    int status = 0;
    while (::waitpid(process.id, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFSIGNALED(status)) {
        const int number = WTERMSIG(status);
        return file_failure(
            name, fmt::format("the process crashed (signal {}, {})", number, ::strsignal(number)));
    }
    if (process.text.empty() || WEXITSTATUS(status) != 0) {
        return file_failure(
            name, fmt::format("the process ended early (exit code {})", WEXITSTATUS(status)));
    }
    if (process.text.front() == kNoProblem) return {.value = process.text.substr(1)};
    return {.problem = problem_in(process.text)};
}

/// A process that waits for a device may outlive even this; then it is abandoned.
void kill_process(const Process& process) {
    constexpr int kMostWaits = 200;
    ::kill(process.id, SIGKILL);
    for (int wait = 0; wait < kMostWaits && ::waitpid(process.id, nullptr, WNOHANG) == 0; ++wait)
        ::usleep(10000);
}

}  // namespace

void set_picture_threads(int count) {
    OIIO::attribute("threads", count);
    // OpenEXR has threads of its own; there, 0 is all cores and less is none.
    OIIO::attribute("exr_threads", count == 1 ? -1 : count);
}

void run_contained(const std::vector<std::string>& names, std::size_t jobs, double seconds,
                   const std::function<std::string(std::size_t)>& work,
                   const std::function<void(std::size_t, const ContainedResult&)>& done) {
    std::vector<Process> running;
    std::size_t next = 0;
    while (next < names.size() || !running.empty()) {
        while (next < names.size() && running.size() < std::max<std::size_t>(jobs, 1)) {
            const std::size_t item = next++;
            if (const std::optional<Process> process = start(item, seconds, work)) {
                running.push_back(*process);
            } else {
                done(item,
                     file_failure(names[item], "cannot start a process: " + reason_of(errno)));
            }
        }
        std::vector<pollfd> pipes;
        Clock::time_point first = Clock::time_point::max();
        for (const Process& process : running) {
            pipes.push_back({process.pipe, POLLIN, 0});
            first = std::min(first, process.deadline);
        }
        constexpr double kMostMilliseconds = 60000;
        const std::chrono::duration<double, std::milli> left = first - Clock::now();
        (void)::poll(pipes.data(), pipes.size(),
                     static_cast<int>(std::clamp(std::ceil(left.count()), 0.0, kMostMilliseconds)));
        std::vector<Process> others;
        for (std::size_t i = 0; i < running.size(); ++i) {
            Process& process = running[i];
            const bool is_ended = pipes[i].revents != 0 && read_more(process);
            const bool is_late = !is_ended && Clock::now() >= process.deadline;
            if (!is_ended && !is_late) {
                others.push_back(std::move(process));
                continue;
            }
            if (is_late) kill_process(process);
            ::close(process.pipe);
            const std::string& name = names[process.item];
            done(process.item, is_ended ? result_of(process, name)
                                        : file_failure(name, fmt::format("no result after {} s "
                                                                         "(<<timeout>>)",
                                                                         seconds)));
        }
        running = std::move(others);
    }
}

TONEWRIGHT_NAMESPACE_END
