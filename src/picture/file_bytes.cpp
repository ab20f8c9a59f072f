// SPDX-License-Identifier: Apache-2.0
#include "picture/file_bytes.h"

#include <unistd.h>

#include <cerrno>

#include "base/system_files.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

void write_all(int file, const void* bytes, std::size_t count) {
    const auto* from = static_cast<const char*>(bytes);
    while (count > 0) {
        const ::ssize_t written = ::write(file, from, piece_of(count));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) throw FileError(problem_of_system(written < 0 ? errno : EIO));
        from += written;
        count -= static_cast<std::size_t>(written);
    }
}

TONEWRIGHT_NAMESPACE_END
