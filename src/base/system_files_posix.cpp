// SPDX-License-Identifier: Apache-2.0
#ifndef _WIN32

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <system_error>

#include "base/system_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace fs = std::filesystem;

std::string machine_and_container() {
    std::array<char, 256> host{};
    (void)::gethostname(host.data(), host.size() - 1);
    std::error_code none;
    return host.data() + fs::read_symlink("/proc/self/ns/pid", none).string();
}

int this_process() { return ::getpid(); }
bool has_ended(int process) { return ::kill(process, 0) != 0 && errno == ESRCH; }

int check_access(const fs::path& path, bool is_for_writing) {
    return ::access(path.c_str(), is_for_writing ? W_OK : R_OK) == 0 ? 0 : errno;
}

int create_new(const fs::path& path) {
    return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
}

int open_to_read(const fs::path& path) {
    return ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
}

int replace(const fs::path& target, const fs::path& written) {
    const int file = ::open(written.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
    if (file < 0) return errno;
    struct stat old {};
    if (::stat(target.c_str(), &old) == 0) (void)::fchmod(file, old.st_mode & 07777);
    const int error = ::fsync(file) == 0 ? 0 : errno;
    ::close(file);
    if (error) return error;
    if (::rename(written.c_str(), target.c_str()) != 0) return errno;
    // The new name is on the disk after its directory is synced. Some file systems cannot sync a
    // directory.
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    const int directory = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (directory >= 0) {
        (void)::fsync(directory);
        ::close(directory);
    }
    return 0;
}

void remove_name(const char* path) noexcept {
    if (::unlink(path) != 0) ::rmdir(path);
}

void set_end_handler(void (*handler)(int signal)) {
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        // nohup stays in effect.
        if (::signal(number, handler) == SIG_IGN) ::signal(number, SIG_IGN);
    }
    ::signal(SIGXFSZ, SIG_IGN);
}

TONEWRIGHT_NAMESPACE_END

#endif
