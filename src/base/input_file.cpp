// SPDX-License-Identifier: Apache-2.0
#include "base/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "base/atomic_file.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string why_no_file(const struct stat& status) {
    if (S_ISDIR(status.st_mode)) return "is a folder";
    if (S_ISREG(status.st_mode)) return "";
    return "is no regular file (a pipe or a device); expected a file";
}

}  // namespace

std::string why_no_file(const std::string& path) {
    struct stat status {};
    return ::stat(path.c_str(), &status) == 0 ? why_no_file(status) : "";
}

void require_regular_file(const std::string& path) {
    if (const std::string why = why_no_file(path); !why.empty())
        throw FileError("read: " + path + ": " + why);
}

std::string why_not_readable(const std::string& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return reason_of(errno);
    if (std::string why = why_no_file(status); !why.empty()) return why;
    return ::access(path.c_str(), R_OK) == 0 ? "" : reason_of(errno);
}

std::string read_file(const std::string& path, std::size_t longest,
                      const std::function<void(const std::string&)>& fail) {
    struct Descriptor {
        int number = -1;
        ~Descriptor() {
            if (number >= 0) ::close(number);
        }
    };
    std::string bytes;
    // Opens regular files only, because opening a device may have side effects.
    if (const std::string why = why_not_readable(path); !why.empty()) {
        fail(why);
        return bytes;
    }
    const Descriptor file = {::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
    struct stat status {};
    if (file.number < 0 || ::fstat(file.number, &status) != 0) {
        fail(reason_of(errno));
        return bytes;
    }
    const auto size = static_cast<std::size_t>(status.st_size);
    std::string why = why_no_file(status);
    if (why.empty() && size > longest)
        why = fmt::format("it has {} bytes; expected at most {}", size, longest);
    if (why.empty()) bytes.resize(size);
    std::size_t count = 0;
    while (why.empty() && count < size) {
        const ssize_t n = ::read(file.number, bytes.data() + count, size - count);
        if (n > 0) {
            count += static_cast<std::size_t>(n);
        } else if (n == 0 || errno != EINTR) {
            why = n == 0 ? fmt::format("ends early, after {} of {} bytes", count, size)
                         : reason_of(errno);
        }
    }
    if (!why.empty()) fail(why);
    return bytes;
}

TONEWRIGHT_NAMESPACE_END
