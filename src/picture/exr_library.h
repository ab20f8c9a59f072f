// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenEXR/openexr.h>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <new>
#include <vector>

#include "base/strings.h"
#include "picture/exr_header.h"
#include "tonewright/error.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Runs a step of OpenEXR's C++ library.
template <class Step>
decltype(auto) by_openexr(const Step& step) {
    try {
        return step();
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        throw FileError(problem_of_library(e.what()));
    }
}

/// Blocks of rows by OpenEXR's C++ library, for the compressions that its core lacks (DWAA, DWAB)
/// or does not check (B44, B44A) in version 3.1. The library reads and writes files only, so each
/// block is a file in memory.
class ExrLibrary {
  public:
    /// @param channels   by name, of full resolution
    /// @param dwa_level  of DWAA and DWAB: larger loses more; 45 is OpenEXR's default
    ExrLibrary(std::vector<ExrChannel> channels, std::size_t width, exr_compression_t compression,
               float dwa_level = 45);

    [[nodiscard]] static bool knows(exr_compression_t compression);

    /// @param planes  rows of planes of channels
    /// @returns  what a file holds; as large as the planes if it is not smaller
    [[nodiscard]] std::vector<std::uint8_t> pack(std::vector<std::uint8_t> planes) const;
    /// @param packed_bytes  at least 1
    /// @throws FileError  damaged
    void unpack(const std::uint8_t* packed, std::size_t packed_bytes, int row_count,
                std::uint8_t* planes) const;

  private:
    std::vector<ExrChannel> channels_;
    std::size_t width_;
    std::size_t row_bytes_ = 0;
    exr_compression_t compression_;
    float dwa_level_;
};

TONEWRIGHT_NAMESPACE_END
