// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/atomic_file.h"
#include "base/input_file.h"
#include "picture/file_reader.h"
#include "picture/file_writer.h"
#include "picture/picture_error.h"
#include "picture/row_pass.h"
#include "tonewright/error.h"
#include "tonewright/image_io.h"
#include "tonewright/tonemap_options.h"
#include "tonewright/view.h"

/// Picture files, a few rows at a time. Reading and writing succeed completely or fail.
TONEWRIGHT_NAMESPACE_BEGIN

/// No limit, for a picture of our own.
inline constexpr double kUnlimited = std::numeric_limits<double>::infinity();

/// Hold it while OpenImageIO reads the header of a file or of a subimage. Its version 2.4 decodes
/// ICC profiles with tables that it changes without a lock of its own, so two threads that open
/// pictures at once would crash. OpenEXR has no profiles: its files open at the same time.
[[nodiscard]] TONEWRIGHT_API std::unique_lock<std::recursive_mutex> lock_header(
    const std::string& path);

/// Opens a picture, or a name that one of OpenImageIO's readers accepts.
/// @throws FileError  missing, unreadable, a folder, a pipe, of unknown format, or of a format
///                    whose reader decodes more pixels than `max_pixels` while it opens. One line.
[[nodiscard]] TONEWRIGHT_API std::unique_ptr<OIIO::ImageInput> open_picture(
    const std::string& path, const OIIO::ImageSpec* config = nullptr,
    double max_pixels = kMaxPixels);

/// Runs `step` on a picture whose options were checked before: its errors are errors of the
/// picture.
/// @throws FileError  "<path>: <reason>"
template <class Step>
decltype(auto) about_picture(const std::string& path, const Step& step) {
    try {
        return with_memory_for(path, step);
    } catch (const PictureError& e) {
        throw FileError(within(path, e.problem()));
    } catch (const FileError&) {
        throw;
    } catch (const Error& e) {
        using Kind = Problem::Kind;
        const Kind kind = e.problem().kind;
        if (kind == Kind::check || kind == Kind::canceled) throw;  // of a callback
        throw FileError(within(path, e.problem()));
    }
}

/// Reads a picture from top to bottom or in any other order of rows. Full resolution, in the pixel
/// type of the file.
///
/// Stricter than ImageBuf: every report of the reader is an error, so a truncated file never gives
/// a half-black picture. Nothing goes through OIIO's cache.
class TONEWRIGHT_API PictureReader {
  public:
    /// Chooses the picture of the file, and describes it to the callbacks of `options`.
    /// @param nthreads  0: OIIO's `threads` attribute.
    /// @throws FileError  missing, unreadable, of unknown format, without that subimage or layer,
    ///                    deep, or with more pixels than the limit. One line.
    explicit PictureReader(const std::string& path, int nthreads = 0,
                           const ReadOptions& options = {});
    ~PictureReader();
    PictureReader(const PictureReader&) = delete;
    PictureReader& operator=(const PictureReader&) = delete;

    /// The spec of an ImageBuf in memory, with the facts of the header (header_tags.h).
    [[nodiscard]] const OIIO::ImageSpec& spec() const { return spec_; }
    /// From now on, delivers float light of pictures whose encoding no Pipeline can hold, and of
    /// those that are resized.
    /// @param options  of tone mapping; a resized picture depends on their input, alpha, exposure,
    ///                 units and white
    /// @throws PictureError, Error  @see describe_picture
    void convert_colors(const TonemapOptions& options);
    /// @see FileReader
    [[nodiscard]] int row_step() const { return std::max(spec_.tile_height, 1); }
    /// Reads rows [ybegin, yend) of all channels, interleaved and packed.
    /// @throws FileError  truncated or damaged.
    void read_rows(int ybegin, int yend, std::byte* to);
    /// Reads the whole picture, also volumes.
    /// @throws FileError  truncated or damaged, or too large for the memory
    [[nodiscard]] OIIO::ImageBuf read_all();

  private:
    class InputRows;
    [[nodiscard]] FileReader open(const std::string& path, int nthreads,
                                  const ReadOptions& options);
    [[nodiscard]] OIIO::ImageBuf read_all_stored();
    /// The resized picture.
    [[nodiscard]] const OIIO::ImageBuf& resized();

    std::string path_;
    InputRows* input_ = nullptr;  // of `file_`; null: a reader of this program
    FileReader file_;
    OIIO::ImageSpec spec_;                    // of what is delivered
    OIIO::ImageSpec stored_;                  // before conversion
    std::optional<SourceColor> color_;        // to convert from; none: no conversion
    std::optional<TonemapOptions> resizing_;  // none: no resizing
    std::optional<OIIO::ImageBuf> resized_;
    int nthreads_ = 0;
};

/// The spec of rows [ybegin, yend) of a picture, untiled.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageSpec spec_of_rows(const OIIO::ImageSpec& picture,
                                                          int ybegin, int yend);

/// Reads a picture to its end and discards it.
/// @throws FileError  it is not complete
TONEWRIGHT_API void check_is_complete(PictureReader& reader);

/// write_image_atomically() of a picture that is made from one of the pixel type `source`.
/// @see PictureWriter::keep_type
TONEWRIGHT_API void write_result_atomically(const OIIO::ImageBuf& image, const std::string& path,
                                            const WriteOptions& options,
                                            const OIIO::TypeDesc& source);

/// FileWriter for pictures of OpenImageIO, in all of its formats.
class TONEWRIGHT_API PictureWriter {
  public:
    /// @param nthreads  0: OIIO's `threads` attribute
    /// @throws FileError, Error  @see FileWriter
    explicit PictureWriter(const std::string& path, WriteOptions options = {}, int nthreads = 0);

    /// @see FileWriter
    void keep_type(const OIIO::TypeDesc& source) { writer_.keep_type(source); }
    /// The size of a picture in a file, and its pixel type if the format can be asked without a
    /// file (else UNKNOWN). Changes nothing.
    /// @throws FileError
    [[nodiscard]] OIIO::ImageSpec file_spec(const OIIO::ImageSpec& picture);
    /// @param picture  the spec of all rows together.
    /// @throws FileError
    void open(const OIIO::ImageSpec& picture);
    /// The next rows of the picture, or the picture.
    /// @throws FileError
    void write_rows(const OIIO::ImageBuf& rows);
    /// @throws FileError
    void finish();
    [[nodiscard]] FileWriter& rows() { return writer_; }
    /// Readers that use OpenImageIO's shared cache get the new file. finish() does it.
    void forget_cached() const;

  private:
    std::string path_;
    FileWriter writer_;
};

TONEWRIGHT_NAMESPACE_END
