// SPDX-License-Identifier: Apache-2.0
#ifdef _WIN32

#include <fcntl.h>
#include <io.h>
#include <process.h>
#include <sys/stat.h>
#include <sys/utime.h>
// After the others.
#include <windows.h>

#include <cerrno>
#include <csignal>
#include <system_error>

#include "base/system_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace fs = std::filesystem;

std::string machine_and_container() {
    char name[MAX_COMPUTERNAME_LENGTH + 1];
    DWORD size = sizeof name;
    return ::GetComputerNameA(name, &size) ? std::string(name, size) : std::string();
}

int this_process() { return ::_getpid(); }

bool has_ended(int process) {
    const HANDLE handle =
        ::OpenProcess(PROCESS_QUERY_LIMITED_INFORMATION, FALSE, static_cast<DWORD>(process));
    if (!handle) return ::GetLastError() == ERROR_INVALID_PARAMETER;
    DWORD code = STILL_ACTIVE;
    const bool is_known = ::GetExitCodeProcess(handle, &code) != 0;
    ::CloseHandle(handle);
    return is_known && code != STILL_ACTIVE;
}

int check_access(const fs::path& path, bool is_for_writing) {
    return ::_waccess(path.c_str(), is_for_writing ? 2 : 4) == 0 ? 0 : errno;
}

bool is_file_itself(const fs::path& path) {
    std::error_code none;
    return fs::is_regular_file(fs::symlink_status(path, none));
}

// A file has the access control list of its folder.
int create_new(const fs::path& path, bool /*is_private*/) {
    return ::_wopen(path.c_str(), _O_WRONLY | _O_CREAT | _O_EXCL | _O_BINARY | _O_NOINHERIT,
                    _S_IREAD | _S_IWRITE);
}

int open_to_read(const fs::path& path) {
    return ::_wopen(path.c_str(), _O_RDONLY | _O_BINARY | _O_NOINHERIT);
}

// The cache's folder is in the user's profile, which other users cannot write to.
int open_own_file(const fs::path& path) { return is_file_itself(path) ? open_to_read(path) : -1; }

void mark_as_used(int file) { (void)::_futime64(file, nullptr); }

// File numbers of Windows are not in `stat`: names stand for them.
std::optional<std::pair<std::uint64_t, std::uint64_t>> identity_of(const fs::path& path) {
    std::error_code error;
    const fs::path full = fs::canonical(path, error);
    if (error) return std::nullopt;
    return std::pair<std::uint64_t, std::uint64_t>(0, fs::hash_value(full));
}

int replace(const fs::path& target, const fs::path& written, const fs::path& /*like*/) {
    // Windows syncs files that are open for writing only.
    const int file = ::_wopen(written.c_str(), _O_RDWR | _O_BINARY | _O_NOINHERIT);
    if (file < 0) return errno;
    const int error = ::_commit(file) == 0 ? 0 : errno;
    ::_close(file);
    if (error) return error;
    std::error_code failure;
    fs::rename(written, target, failure);
    return failure.default_error_condition().value();
}

// Names are UTF-8, which these functions take for the language of the system: files with other
// letters may stay.
void remove_name(const char* path) noexcept {
    if (::_unlink(path) != 0) (void)::RemoveDirectoryA(path);
}

void set_end_handler(void (*handler)(int signal)) {
    for (const int number : {SIGINT, SIGTERM}) {
        if (std::signal(number, handler) == SIG_IGN) (void)std::signal(number, SIG_IGN);
    }
}

TONEWRIGHT_NAMESPACE_END

#endif
