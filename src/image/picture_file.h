// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "tonewright/error.h"

/// Picture files, read and written some rows at a time, whole or not at all.
TONEWRIGHT_NAMESPACE_BEGIN

/// In one line, why a picture could not be opened.
/// @param reported  what OpenImageIO says
[[nodiscard]] TONEWRIGHT_API std::string why_not_open(const std::string& path,
                                                      const std::string& reported);

/// Reads a picture from top to bottom or in any other order of rows. Full resolution, in the pixel
/// type of the file.
///
/// Stricter than ImageBuf: whatever the reader reports is an error, so that a truncated file is
/// never a half-black picture. Nothing goes through OIIO's cache.
class TONEWRIGHT_API PictureReader {
  public:
    /// @param nthreads  0: OIIO's `threads` attribute.
    /// @throws FileError  missing, unreadable, of unknown format, without that subimage, or deep.
    /// One
    ///                    line.
    explicit PictureReader(const std::string& path, int nthreads = 0, int subimage = 0);
    ~PictureReader();
    PictureReader(const PictureReader&) = delete;
    PictureReader& operator=(const PictureReader&) = delete;

    /// Of the picture as an ImageBuf in memory has it.
    [[nodiscard]] const OIIO::ImageSpec& spec() const { return spec_; }
    /// Rows are read in multiples of this, from the first one on: the height of a tile, or 1.
    [[nodiscard]] int row_step() const;
    /// Reads rows [ybegin, yend) of all channels, interleaved and packed.
    /// @throws FileError  truncated or damaged.
    void read_rows(int ybegin, int yend, std::byte* to);
    /// All of it, volumes too.
    /// @throws FileError  truncated or damaged, or too large for the memory.
    [[nodiscard]] OIIO::ImageBuf read_all();

  private:
    void check(bool was_read) const;

    std::string path_;
    int subimage_;
    std::unique_ptr<OIIO::ImageInput> in_;
    OIIO::ImageSpec spec_;
};

/// Bytes that are read, worked on and written at a time.
inline constexpr std::size_t kBatchBytes = std::size_t{16} << 20;

/// Rows of a batch: at least 64 (formats compress up to 32 rows together, OpenEXR's threads one
/// such block each), and a multiple of `step`.
[[nodiscard]] TONEWRIGHT_API int rows_of_batch(std::size_t bytes_per_row, int step,
                                               std::size_t batch_bytes = kBatchBytes);

/// The spec of rows [ybegin, yend) of a picture, untiled.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageSpec spec_of_rows(const OIIO::ImageSpec& picture,
                                                          int ybegin, int yend);

/// Reads a picture to its end and keeps nothing of it.
/// @throws FileError  when it is not whole.
TONEWRIGHT_API void check_is_complete(PictureReader& reader);

/// Writes a picture from its first row to its last under a temporary name, and gives it its own
/// when it is complete. @see write_image_atomically for what becomes of a picture on the way.
class TONEWRIGHT_API PictureWriter {
  public:
    /// Touches nothing yet.
    /// @param nthreads  0: OIIO's `threads` attribute.
    /// @throws FileError  unknown extension, or a place for no file.
    PictureWriter(const std::string& path, const OIIO::TypeDesc& type, int nthreads = 0);
    /// Removes what is not finished.
    ~PictureWriter();
    PictureWriter(const PictureWriter&) = delete;
    PictureWriter& operator=(const PictureWriter&) = delete;

    /// What the file says of a picture: its size, and its pixel type where the format can be asked
    /// without a file (else UNKNOWN). Touches nothing.
    /// @throws FileError
    [[nodiscard]] OIIO::ImageSpec file_spec(const OIIO::ImageSpec& picture);
    /// @param picture  the spec of all rows together.
    /// @throws FileError
    void open(const OIIO::ImageSpec& picture);
    /// Once open: the pixel type that rows are best handed over in, half or float. Both give the
    /// same file.
    [[nodiscard]] OIIO::TypeDesc row_type() const;
    /// Once open: the format wants the last row first.
    [[nodiscard]] bool is_bottom_up() const;
    /// The next rows of the picture, or the picture.
    /// @throws FileError
    void write_rows(const OIIO::ImageBuf& rows);
    /// @throws FileError
    void finish();

  private:
    class FileProxy;

    [[noreturn]] void fail(const std::string& reason) const;
    void check_disk() const;
    [[nodiscard]] OIIO::ImageSpec plan(const OIIO::ImageSpec& picture);
    [[nodiscard]] OIIO::ImageBuf checked(OIIO::ImageBuf&& changed) const;
    void write_fitted(const OIIO::ImageBuf& rows);

    std::string path_;
    OIIO::TypeDesc type_;
    std::vector<int> channels_;        // to write; empty: all
    std::optional<OIIO::ROI> window_;  // to write; none: all of the picture
    bool divides_by_alpha_ = false;
    int last_row_ = 0;  // of the picture, exclusive
    int next_row_ = 0;  // of the window, or of the picture
    // In this order: the writer, when it ends, writes to the proxy, which writes to the file.
    std::unique_ptr<AtomicFile> temporary_;
    std::unique_ptr<FileProxy> proxy_;  // null: OIIO opens the file itself
    std::unique_ptr<OIIO::ImageOutput> out_;
};

TONEWRIGHT_NAMESPACE_END
