// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/filesystem.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The file of OIIO's writers. They do not check whether their last bytes reached the disk (PNG:
/// none of them), and libjpeg ends the process after a failed write. This file therefore accepts
/// everything, and remembers the first error.
class OutputFile final : public OIIO::Filesystem::IOProxy {
  public:
    /// @param file  a descriptor, which it closes
    OutputFile(int file, const std::string& name);
    ~OutputFile() override;
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// Inserts `bytes` at `place`, which the writer passes once.
    void insert(std::size_t place, std::string bytes) {
        place_ = static_cast<int64_t>(place);
        inserted_ = std::move(bytes);
    }

    /// Begins to count the blocks of an OpenEXR file, each of which begins with its first row and
    /// its size in bytes, four bytes each.
    void begin_blocks() { next_block_ = m_pos; }
    [[nodiscard]] int blocks() const { return blocks_; }

    [[nodiscard]] const char* proxytype() const override { return "tonewright"; }
    bool seek(int64_t offset) override;
    std::size_t write(const void* bytes, std::size_t size) override;
    std::size_t pwrite(const void* bytes, std::size_t size, int64_t offset) override;
    [[nodiscard]] std::size_t size() const override { return static_cast<std::size_t>(size_); }

    /// The first error: an errno, or 0.
    [[nodiscard]] int error_number() const { return errno_; }
    /// Passes everything to the system.
    /// @returns  0 or an errno
    [[nodiscard]] int finish();

  private:
    void put(const char* bytes, std::size_t size);

    void count_blocks(const char* bytes, std::size_t size);

    std::FILE* file_ = nullptr;
    int errno_ = 0;
    int64_t size_ = 0;
    int64_t next_block_ = -1;  // where one begins
    std::array<unsigned char, 8> block_{};
    int blocks_ = 0;
    std::string inserted_;  // not yet
    int64_t place_ = 0;
    int64_t shift_ = 0;  // of what follows it
};

TONEWRIGHT_NAMESPACE_END
