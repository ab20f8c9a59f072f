// SPDX-License-Identifier: Apache-2.0
#include "picture/file_bytes.h"

#include <fcntl.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>

#include "base/system_files.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

int OpenFile::patch(std::size_t place, std::string_view bytes) const {
    while (!bytes.empty()) {
        const ::ssize_t written =
            ::pwrite(file_, bytes.data(), bytes.size(), static_cast<::off_t>(place));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return written < 0 ? errno : EIO;
        bytes.remove_prefix(static_cast<std::size_t>(written));
        place += static_cast<std::size_t>(written);
    }
    return 0;
}

void OpenFile::begin_sync() const {
#ifdef SYNC_FILE_RANGE_WRITE
    (void)::sync_file_range(file_, 0, 0, SYNC_FILE_RANGE_WRITE);
#endif
}

int OpenFile::close() {
    if (file_ < 0) return 0;
    return ::close(std::exchange(file_, -1)) == 0 ? 0 : errno;
}

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
