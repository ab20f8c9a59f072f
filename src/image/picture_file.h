// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tonewright/error.h"

/// Picture files, read and written some rows at a time, whole or not at all.
namespace tonewright {

/// Reads a picture from top to bottom or in any other order of rows. First subimage, full
/// resolution, in the pixel type of the file.
///
/// Stricter than ImageBuf: whatever the reader reports is an error, so that a truncated file is
/// never a half-black picture. Nothing goes through OIIO's cache.
class PictureReader {
  public:
    /// @param nthreads  0: OIIO's `threads` attribute.
    /// @throws FileError  missing, unreadable, of unknown format, or deep. One line.
    explicit PictureReader(const std::string& path, int nthreads = 0);
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
    std::unique_ptr<OIIO::ImageInput> in_;
    OIIO::ImageSpec spec_;
};

/// Bytes that are read, worked on and written at a time.
inline constexpr std::size_t kBatchBytes = std::size_t{16} << 20;

/// Rows of a batch: at least 64 (formats compress up to 32 rows together, OpenEXR's threads one
/// such block each), and a multiple of `step`.
[[nodiscard]] int rows_of_batch(std::size_t bytes_per_row, int step,
                                std::size_t batch_bytes = kBatchBytes);

/// The spec of rows [ybegin, yend) of a picture.
[[nodiscard]] OIIO::ImageSpec spec_of_rows(const OIIO::ImageSpec& picture, int ybegin, int yend);

/// The numbers of a spec alone: rows have no use for the texts of their picture.
[[nodiscard]] OIIO::ImageSpec without_metadata(OIIO::ImageSpec spec);

/// Reads a picture to its end and keeps nothing of it.
/// @throws FileError  when it is not whole.
void check_is_complete(const std::string& path);

/// Writes a picture from its first row to its last under a temporary name, and gives it its own
/// when it is complete. @see write_image_atomically for what becomes of a picture on the way.
class PictureWriter {
  public:
    /// Touches nothing yet.
    /// @param nthreads  0: OIIO's `threads` attribute.
    /// @throws FileError  unknown extension, or a place for no file.
    PictureWriter(const std::string& path, const OIIO::TypeDesc& type, int nthreads = 0);
    /// Removes what is not finished.
    ~PictureWriter();
    PictureWriter(const PictureWriter&) = delete;
    PictureWriter& operator=(const PictureWriter&) = delete;

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
    class TemporaryFile;
    class FileProxy;

    [[noreturn]] void fail(const std::string& reason) const;
    void check_disk() const;
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
    std::unique_ptr<TemporaryFile> temporary_;
    std::unique_ptr<FileProxy> proxy_;  // null: OIIO opens the file itself
    std::unique_ptr<OIIO::ImageOutput> out_;
};

/// When the program is told to end (SIGINT, SIGTERM, SIGHUP), what PictureWriter has not finished
/// is removed first. For a program to call once.
void remove_unfinished_files_on_signals();

}  // namespace tonewright
