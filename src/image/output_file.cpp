// SPDX-License-Identifier: Apache-2.0
#include "image/output_file.h"

#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

TONEWRIGHT_NAMESPACE_BEGIN

OutputFile::OutputFile(int file, const std::string& name)
    : IOProxy(name, Write), file_(::fdopen(file, "wb")) {
    if (!file_) {
        errno_ = errno;
        ::close(file);
        return;
    }
    std::setvbuf(file_, nullptr, _IOFBF, std::size_t{1} << 20);  // some write byte by byte
}

OutputFile::~OutputFile() {
    if (file_) std::fclose(file_);
}

bool OutputFile::seek(int64_t offset) {
    if (offset == m_pos) return true;
    if (!errno_ && ::fseeko(file_, offset + shift_, SEEK_SET) != 0) errno_ = errno;
    m_pos = offset;
    return true;
}

std::size_t OutputFile::write(const void* bytes, std::size_t size) {
    const auto* from = static_cast<const char*>(bytes);
    std::size_t before = 0;
    if (!inserted_.empty() && m_pos <= place_ && m_pos + static_cast<int64_t>(size) > place_) {
        before = static_cast<std::size_t>(place_ - m_pos);
        put(from, before);
        put(inserted_.data(), inserted_.size());
        shift_ = static_cast<int64_t>(inserted_.size());
        inserted_.clear();
    }
    put(from + before, size - before);
    if (next_block_ >= 0) count_blocks(from, size);
    m_pos += static_cast<int64_t>(size);
    size_ = std::max(size_, m_pos);
    return size;
}

std::size_t OutputFile::pwrite(const void* bytes, std::size_t size, int64_t offset) {
    const int64_t here = m_pos;
    seek(offset);
    write(bytes, size);
    seek(here);
    return size;
}

int OutputFile::finish() {
    if (!file_) return errno_;
    if (std::fclose(std::exchange(file_, nullptr)) != 0 && !errno_) errno_ = errno;
    return errno_;
}

void OutputFile::put(const char* bytes, std::size_t size) {
    if (errno_ || size == 0) return;
    if (std::fwrite(bytes, 1, size, file_) != size) errno_ = errno ? errno : EIO;
}

void OutputFile::count_blocks(const char* bytes, std::size_t size) {
    const int64_t end = m_pos + static_cast<int64_t>(size);
    for (int64_t at = std::max(m_pos, next_block_); at < end && at < next_block_ + 8; ++at) {
        block_[static_cast<std::size_t>(at - next_block_)] =
            static_cast<unsigned char>(bytes[at - m_pos]);
        if (at - next_block_ < 7) continue;
        ++blocks_;
        std::uint32_t rest = 0;
        for (std::size_t i = 8; i-- > 4;)
            rest = rest << 8U | block_[i];
        next_block_ = at + 1 + rest;
        at = next_block_ - 1;
    }
}

TONEWRIGHT_NAMESPACE_END
