// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

// What this folder asks of the operating system: system_files_posix.cpp, system_files_windows.cpp.
// An int that is no descriptor is 0 or an errno; a descriptor of -1 comes with one in `errno`.

/// Names the machine and the container, within which a process id means one process.
[[nodiscard]] std::string machine_and_container();
[[nodiscard]] int this_process();
/// False where the system does not say.
[[nodiscard]] bool has_ended(int process);

[[nodiscard]] int check_access(const std::filesystem::path& path, bool is_for_writing);
/// Fails where anything has the name, and follows no link.
[[nodiscard]] int create_new(const std::filesystem::path& path);
/// A pipe cannot block this.
[[nodiscard]] int open_to_read(const std::filesystem::path& path);
/// Gives a written file the permissions of the target, if there is one, and then its name.
/// Both survive a loss of power.
[[nodiscard]] int replace(const std::filesystem::path& target,
                          const std::filesystem::path& written);
/// What one call reads or writes: Windows counts in 32 bits.
[[nodiscard]] inline unsigned piece_of(std::size_t bytes) {
    return static_cast<unsigned>(std::min<std::size_t>(bytes, std::size_t{1} << 30));
}
/// A file or an empty folder. For signal handlers, too.
void remove_name(const char* path) noexcept;

/// Calls the handler on SIGINT, SIGTERM, and SIGHUP where the system has it, unless they are
/// ignored already. A file that becomes too large (SIGXFSZ) is an error of writing it from then on.
void set_end_handler(void (*handler)(int signal));

TONEWRIGHT_NAMESPACE_END
