// SPDX-License-Identifier: Apache-2.0
#include "cli/picture_commands.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// Binding functions at their first call saves an eighth of the time.
constexpr int kBinding = RTLD_LAZY | RTLD_LOCAL;

/// The limit of `ulimit -v`, in MB.
std::optional<double> address_limit() {
    struct rlimit limit {};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return {};
    return static_cast<double>(limit.rlim_cur) / 1e6;
}

/// Static objects of the libraries below OpenImageIO start threads and allocate without checks. If
/// the address space is limited, loading can therefore abort the process, crash or wait forever,
/// with all signals blocked. A separate process tries it first.
bool survives_loading(const std::string& path) {
    // Loading takes 0.2 s of processor time, and other programs may delay it.
    constexpr std::chrono::seconds kLongest{60};
    // Additional memory of a second process: stacks and arenas of its threads.
    constexpr rlim_t kHeadroom = rlim_t{32} << 20U;
    const pid_t parent = ::getpid();
    const pid_t child = ::fork();
    if (child == 0) {
        (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (::getppid() != parent) ::_exit(0);
        const struct rlimit none {};
        (void)::setrlimit(RLIMIT_CORE, &none);
        struct rlimit addresses {};
        (void)::getrlimit(RLIMIT_AS, &addresses);
        addresses.rlim_cur -= std::min(addresses.rlim_cur, kHeadroom);
        (void)::setrlimit(RLIMIT_AS, &addresses);
        if (const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC); nowhere >= 0)
            (void)::dup2(nowhere, STDERR_FILENO);
        ::_exit(::dlopen(path.c_str(), kBinding) ? 0 : 1);
    }
    if (child < 0) return false;
    const auto end = std::chrono::steady_clock::now() + kLongest;
    int status = 0;  // remains if the caller ignores the exit of children
    while (::waitpid(child, &status, WNOHANG) == 0) {
        if (std::chrono::steady_clock::now() > end) (void)::kill(child, SIGKILL);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// The module stays loaded until the process ends.
const PictureCommands& load() {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::path self = fs::read_symlink("/proc/self/exe", error);
    if (error) throw FileError("start: /proc/self/exe: " + error.message());
    const std::string path =
        (self.parent_path() / TONEWRIGHT_LIBEXEC / "picture_commands.so").lexically_normal();
    const auto fail = [&](const std::string& reason) {
        throw FileError("start: cannot load the picture commands: " + reason);
    };
    const std::optional<double> limit = address_limit();
    // Each further arena of malloc reserves 64 to 128 MB of addresses for a thread.
    if (limit) (void)::mallopt(M_ARENA_MAX, 1);
    const auto fail_for_memory = [&] {
        fail(
            fmt::format("not enough memory; expected more addresses than the limit of {:.0f} MB "
                        "(ulimit -v)",
                        *limit));
    };
    // A module that is there does not load for lack of addresses, where they are limited.
    const bool is_limited = limit && ::access(path.c_str(), R_OK) == 0;
    if (is_limited && !survives_loading(path)) fail_for_memory();
    void* module = ::dlopen(path.c_str(), kBinding);
    if (!module && is_limited) fail_for_memory();
    if (!module) fail(::dlerror());
    using Entry = decltype(&tonewright_picture_commands);
    const auto entry = reinterpret_cast<Entry>(::dlsym(module, kPictureCommandsEntry));
    const PictureCommands* commands = entry ? entry(kPictureCommandsBuild) : nullptr;
    if (!commands)
        fail(path + ": belongs to another build; expected " + std::string(kPictureCommandsBuild));
    commands->use_messages(message_options());
    return *commands;
}

}  // namespace

const PictureCommands& picture_commands() {
    static const PictureCommands& commands = load();
    return commands;
}

TONEWRIGHT_NAMESPACE_END
