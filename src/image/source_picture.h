// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <cstddef>
#include <vector>

#include "picture/source_pixels.h"

/// Pictures that are read span by span, in memory or in OIIO's cache.
TONEWRIGHT_NAMESPACE_BEGIN

/// Reads the header of a picture that is not open yet. OpenImageIO 3 reads its pixels, too, unless
/// the picture is cached.
/// @throws Error  no picture, or one that cannot be read, or deep, or of a type without pixels.
TONEWRIGHT_API void check_source(const OIIO::ImageBuf& source);

/// Call it after a pass: a cached picture is read during the pass, and its cache reports errors
/// through the picture.
/// @throws Error  with the reader's message
TONEWRIGHT_API void check_was_read(const OIIO::ImageBuf& source, bool is_complete);

/// In memory. OpenImageIO 3.1 ends the process where it clears what it could not allocate.
/// @throws std::bad_alloc
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf black_picture(const OIIO::ImageSpec& spec);

/// Finds the spans of a picture. One for each thread.
class TONEWRIGHT_API SpanReader {
  public:
    /// @throws std::bad_alloc
    explicit SpanReader(const OIIO::ImageBuf& picture)
        : picture_(picture), type_(picture.spec().format) {
        if (!picture.localpixels()) {
            fetched_.resize(kSpan * static_cast<std::size_t>(picture.nchannels()) * type_.size());
        }
    }

    /// Uses pixels in memory directly; fetches those of a cached picture.
    /// @param n  at most kSpan pixels, all inside the data window
    /// @returns  false if the picture could not be read
    bool locate(int x, int y, int z, std::size_t n, SpanSource& source) {
        if (picture_.localpixels()) {
            source = {static_cast<const std::byte*>(picture_.pixeladdr(x, y, z)),
                      picture_.pixel_stride()};
            return true;
        }
        const int channels = picture_.nchannels();
        const OIIO::ROI roi(x, x + static_cast<int>(n), y, y + 1, z, z + 1, 0, channels);
        source = {fetched_.data(), channels * static_cast<std::ptrdiff_t>(type_.size())};
        return picture_.get_pixels(roi, type_, fetched_.data());
    }

  private:
    const OIIO::ImageBuf& picture_;
    OIIO::TypeDesc type_;
    std::vector<std::byte> fetched_;
};

TONEWRIGHT_NAMESPACE_END
