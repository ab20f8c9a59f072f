// SPDX-License-Identifier: Apache-2.0
#include "base/input_file.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <utility>

#include "base/system_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string why_no_file(bool is_folder, bool is_regular) {
    if (is_folder) return "is a folder";
    return is_regular ? "" : "is no regular file (a pipe or a device); expected a file";
}

struct Descriptor {
    int number = -1;
    ~Descriptor() {
        if (number >= 0) ::close(number);
    }
};

Problem reason(std::string text) { return {.kind = Problem::Kind::file, .value = std::move(text)}; }

/// @param why  the reason, where it cannot be read
std::string contents_of(const Descriptor& file, std::size_t longest, std::optional<Problem>& why) {
    std::string bytes;
    struct stat status {};
    if (file.number < 0 || ::fstat(file.number, &status) != 0) {
        why = problem_of_system(errno);
        return bytes;
    }
    const auto size = static_cast<std::size_t>(status.st_size);
    const std::string no_file = why_no_file(S_ISDIR(status.st_mode), S_ISREG(status.st_mode));
    if (!no_file.empty()) {
        why = reason(no_file);
    } else if (size > longest) {
        why = reason(fmt::format("it has {} bytes; expected at most {}", size, longest));
    } else {
        bytes.resize(size);
    }
    std::size_t count = 0;
    while (!why && count < size) {
        const auto n = ::read(file.number, bytes.data() + count, piece_of(size - count));
        if (n > 0) {
            count += static_cast<std::size_t>(n);
        } else if (n == 0 || errno != EINTR) {
            why = n == 0 ? reason(fmt::format("ends early, after {} of {} bytes", count, size))
                         : problem_of_system(errno);
        }
    }
    return bytes;
}

}  // namespace

std::string why_no_file(const std::string& path) {
    std::error_code none;
    const auto status = std::filesystem::status(path, none);
    if (!std::filesystem::exists(status)) return "";
    return why_no_file(is_directory(status), is_regular_file(status));
}

void require_regular_file(const std::string& path) {
    if (const std::string why = why_no_file(path); !why.empty())
        throw FileError("read: " + path + ": " + why);
}

std::optional<Problem> why_not_readable(const std::string& path) {
    if (const std::string why = why_no_file(path); !why.empty()) return reason(why);
    if (const int error = check_access(path, false)) return problem_of_system(error);
    return {};
}

std::string read_file(const std::string& path, std::size_t longest,
                      const std::function<void(const Problem&)>& fail) {
    // Opens regular files only, because opening a device may have side effects.
    std::optional<Problem> why = why_not_readable(path);
    std::string bytes;
    if (!why) bytes = contents_of({open_to_read(path)}, longest, why);
    if (why) fail(*why);
    return bytes;
}

std::optional<std::string> read_own_file(const std::string& path, std::size_t longest) {
    const Descriptor file = {open_own_file(path)};
    if (file.number < 0) return std::nullopt;
    std::optional<Problem> why;
    std::string bytes = contents_of(file, longest, why);
    if (why) return std::nullopt;
    mark_as_used(file.number);
    return bytes;
}

TONEWRIGHT_NAMESPACE_END
