// SPDX-License-Identifier: Apache-2.0
#include "shader_runs/child_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <system_error>

#include "base/strings.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

ChildProcess::ChildProcess(std::vector<std::string> words, int input, int output, int messages) {
    std::vector<char*> arguments(words.size() + 1, nullptr);
    std::transform(words.begin(), words.end(), arguments.begin(),
                   [](std::string& word) { return word.data(); });
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, messages, STDERR_FILENO);
    const int error =
        ::posix_spawnp(&id_, arguments[0], &actions, nullptr, arguments.data(), ::environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) {
        id_ = 0;
        throw Error(words[0] + ": " + std::generic_category().message(error));
    }
}

ChildProcess::~ChildProcess() {
    if (id_ == 0) return;
    ::kill(id_, SIGKILL);
    (void)succeeds();
}

bool ChildProcess::succeeds() {
    int status = -1;
    pid_t ended = -1;
    do {
        ended = ::waitpid(id_, &status, 0);
    } while (ended < 0 && errno == EINTR);
    id_ = 0;
    return ended > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

OwnedDescriptor::OwnedDescriptor(const std::string& path)
    : descriptor_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600)) {
    if (descriptor_ < 0)
        throw FileError("write: " + path + ": " + std::generic_category().message(errno));
}

OwnedDescriptor::~OwnedDescriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

void run_program(const std::vector<std::string>& words, const std::string& log) {
    const OwnedDescriptor nothing(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    const OwnedDescriptor messages(log);
    ChildProcess process(words, nothing.get(), messages.get(), messages.get());
    if (!process.succeeds()) throw Error(words[0] + ": " + first_error(log));
}

std::string first_error(const std::string& log) {
    std::ifstream file(log);
    std::string first;
    for (std::string line; std::getline(file, line);) {
        if (lowercase(line).find("error") != std::string::npos) return one_line(line);
        if (first.empty()) first = one_line(line);
    }
    return first.empty() ? "fails without a message" : first;
}

TONEWRIGHT_NAMESPACE_END
