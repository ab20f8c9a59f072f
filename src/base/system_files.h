// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "tonewright/error.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

// The functions of the operating system that this folder uses: system_files_posix.cpp,
// system_files_windows.cpp. An int that is no descriptor is 0 or an errno; a descriptor of -1 comes
// with one in `errno`.

/// The message of an errno.
[[nodiscard]] inline std::string reason_of(int error_number) {
    return std::generic_category().message(error_number);
}
/// The system's error as the problem of a file, which within() adds.
[[nodiscard]] inline Problem problem_of_system(int error_number) {
    return {.kind = Problem::Kind::file,
            .value = reason_of(error_number),
            .error_number = error_number};
}

/// Names the machine and the container, within which a process id means one process.
[[nodiscard]] std::string machine_and_container();
[[nodiscard]] int this_process();
/// False where the system does not say.
[[nodiscard]] bool has_ended(int process);

[[nodiscard]] int check_access(const std::filesystem::path& path, bool is_for_writing);
/// True for a file, also one without access; false for a link.
[[nodiscard]] bool is_file_itself(const std::filesystem::path& path);
/// Fails where anything has the name, and follows no link.
/// @param is_private  only this user has access; else what the umask and the folder say
[[nodiscard]] int create_new(const std::filesystem::path& path, bool is_private);
/// A pipe cannot block this.
[[nodiscard]] int open_to_read(const std::filesystem::path& path);
/// Opens only a file that no other user can have written: no link, owned by this user or root, and
/// not writable by others. Else -1, without an errno.
[[nodiscard]] int open_own_file(const std::filesystem::path& path);
/// Sets the time of the last change to now.
void mark_as_used(int file);
/// Gives a written file the access that `like` has, if that is a file: owner and group as far as
/// the user may, permissions without setuid and setgid, and access control list. Then gives it the
/// name of the target. Both survive a loss of power.
[[nodiscard]] int replace(const std::filesystem::path& target, const std::filesystem::path& written,
                          const std::filesystem::path& like);
/// The device and the number of what is there, after links; nothing if nothing is.
[[nodiscard]] std::optional<std::pair<std::uint64_t, std::uint64_t>> identity_of(
    const std::filesystem::path& path);
/// Bytes that one call reads or writes: Windows counts in 32 bits.
[[nodiscard]] inline unsigned piece_of(std::size_t bytes) {
    return static_cast<unsigned>(std::min<std::size_t>(bytes, std::size_t{1} << 30));
}
/// A file or an empty folder. For signal handlers, too.
void remove_name(const char* path) noexcept;

/// Calls the handler on SIGINT, SIGTERM, and SIGHUP where the system has it, unless they are
/// ignored already. A file that becomes too large (SIGXFSZ) is an error of writing it from then on.
void set_end_handler(void (*handler)(int signal));

TONEWRIGHT_NAMESPACE_END
