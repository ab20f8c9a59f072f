// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>

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
#include "picture/picture_error.h"
#include "picture/row_pass.h"
#include "tonewright/error.h"
#include "tonewright/image_io.h"
#include "tonewright/tonemap_options.h"
#include "tonewright/view.h"

/// Picture files, a few rows at a time. Reading and writing succeed completely or fail.
TONEWRIGHT_NAMESPACE_BEGIN

class LightLevelMeter;
class RowWriter;
class OpenFile;
class OutputFile;
struct FormatLimits;

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
    /// Rows are read in multiples of this, from the first one on: the height of a tile, or 1.
    [[nodiscard]] int row_step() const;
    /// Reads rows [ybegin, yend) of all channels, interleaved and packed.
    /// @throws FileError  truncated or damaged.
    void read_rows(int ybegin, int yend, std::byte* to);
    /// Reads the whole picture, also volumes.
    /// @throws FileError  truncated or damaged, or too large for the memory
    [[nodiscard]] OIIO::ImageBuf read_all();

  private:
    void check(bool was_read) const;
    void choose_subimage(const ReadOptions& options);
    void choose_layer(const ReadOptions& options);
    void deliver(const std::vector<int>& channels, bool has_alpha);
    void check_size(double max_pixels) const;
    [[nodiscard]] OIIO::ImageBuf read_all_stored();
    /// The resized picture.
    [[nodiscard]] const OIIO::ImageBuf& resized();
    /// Rows as the file has them, in the delivered order of channels.
    void read_stored(int ybegin, int yend, std::byte* to);

    std::string path_;
    int subimage_ = 0;
    std::string bytes_;                                  // of a file that is read from memory
    std::unique_ptr<OIIO::Filesystem::IOProxy> memory_;  // outlives the reader
    std::unique_ptr<OIIO::ImageInput> in_;
    OIIO::ImageSpec spec_;              // of what is delivered
    OIIO::ImageSpec stored_;            // before conversion
    int stored_channels_ = 0;           // of the file
    std::vector<int> channels_;         // of the file that are delivered; empty: all in their order
    std::vector<std::byte> scratch_;    // rows with all channels
    std::optional<SourceColor> color_;  // to convert from; none: no conversion
    std::optional<TonemapOptions> resizing_;  // none: no resizing
    std::optional<OIIO::ImageBuf> resized_;
    int nthreads_ = 0;
};

/// The spec of rows [ybegin, yend) of a picture, untiled.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageSpec spec_of_rows(const OIIO::ImageSpec& picture,
                                                          int ybegin, int yend);

/// The note and the warnings about what a header says go to the callbacks of `options`.
TONEWRIGHT_API void report_header(const OIIO::ImageSpec& spec, std::string_view input,
                                  const ReadOptions& options);

/// Reads a picture to its end and discards it.
/// @throws FileError  it is not complete
TONEWRIGHT_API void check_is_complete(PictureReader& reader);

/// Pixel type of an OpenEXR file for a picture of another type: half for half and for 8 bits, whose
/// codes the 11 significant bits of half tell apart, else float.
[[nodiscard]] TONEWRIGHT_API OIIO::TypeDesc openexr_type(const OIIO::TypeDesc& source);

/// write_image_atomically() of a picture that is made from one of the pixel type `source`.
/// @see PictureWriter::keep_type
TONEWRIGHT_API void write_result_atomically(const OIIO::ImageBuf& image, const std::string& path,
                                            const WriteOptions& options,
                                            const OIIO::TypeDesc& source);

/// Writes a picture from its first row to its last under a temporary name, and renames it when it
/// is complete. @see write_image_atomically
class TONEWRIGHT_API PictureWriter {
  public:
    /// Changes nothing yet.
    /// @param nthreads  0: OIIO's `threads` attribute
    /// @throws FileError  unknown extension, or a path where no file can be
    /// @throws Error      compression or quality that the format does not have
    explicit PictureWriter(const std::string& path, WriteOptions options = {}, int nthreads = 0);
    /// Removes an unfinished file.
    ~PictureWriter();
    PictureWriter(const PictureWriter&) = delete;
    PictureWriter& operator=(const PictureWriter&) = delete;

    /// Before opening: the picture is made from one of this pixel type. If the options state none,
    /// an OpenEXR file has openexr_type(). Other formats keep their own defaults.
    /// @param source  UNKNOWN: changes nothing
    void keep_type(const OIIO::TypeDesc& source);
    /// The size of a picture in a file, and its pixel type if the format can be asked without a
    /// file (else UNKNOWN). Changes nothing.
    /// @throws FileError
    [[nodiscard]] OIIO::ImageSpec file_spec(const OIIO::ImageSpec& picture);
    /// @param picture  the spec of all rows together.
    /// @throws FileError
    void open(const OIIO::ImageSpec& picture);
    /// After opening: the better pixel type for the rows, half or float. Both give the same file.
    [[nodiscard]] OIIO::TypeDesc row_type() const;
    /// True if files of the format store Exif's orientation and programs follow it. Others need
    /// upright pixels.
    [[nodiscard]] bool keeps_orientation() const;
    /// After opening: true if the format takes the last row first.
    [[nodiscard]] bool is_bottom_up() const;
    /// The next rows of the picture, or the picture.
    /// @throws FileError
    void write_rows(const OIIO::ImageBuf& rows);
    /// @throws FileError
    void finish();

  private:
    [[noreturn]] void fail(const std::string& reason) const;
    [[noreturn]] void fail(const Problem& why) const;
    void check_disk() const;
    /// OpenEXR 3.1 forgets that it could not compress a block of rows, such as without memory: it
    /// writes no more of this call, and takes later rows from before the given ones.
    void check_blocks() const;
    [[nodiscard]] OIIO::ImageSpec plan(const OIIO::ImageSpec& picture);
    /// Opens the writer of our own for a new, empty file, if there is one for the picture.
    /// @param chunks  of a PNG file, after its header
    [[nodiscard]] std::unique_ptr<RowWriter> own_writer(int file, const OIIO::ImageSpec& spec,
                                                        const std::string& chunks) const;
    void open_by_openimageio(const OIIO::ImageSpec& spec, const std::string& chunks);
    void plan_alpha(OIIO::ImageSpec& spec);
    void plan_channels(OIIO::ImageSpec& spec, const FormatLimits& limits);
    void plan_window(OIIO::ImageSpec& spec, const OIIO::ImageSpec& picture,
                     const FormatLimits& limits);
    void plan_cover(OIIO::ImageSpec& spec, const OIIO::ImageSpec& picture,
                    const FormatLimits& limits);
    void plan_type(OIIO::ImageSpec& spec, const OIIO::ImageSpec& picture,
                   const FormatLimits& limits) const;
    [[nodiscard]] OIIO::ImageBuf select_channels(const OIIO::ImageBuf& picture) const;
    [[nodiscard]] OIIO::ImageBuf checked(OIIO::ImageBuf&& changed) const;
    [[nodiscard]] std::string_view format() const;
    /// The format, or `avif`.
    [[nodiscard]] std::string_view codec() const;
    /// Limitations of the file, in one warning.
    void warn_of_limits(const OIIO::ImageSpec& requested, const std::string& missing) const;
    [[nodiscard]] std::string cut_off(const OIIO::ImageSpec& picture) const;
    void watch_cover(const OIIO::ImageBuf& rows);
    void warn_of_cover() const;
    [[nodiscard]] OIIO::ImageBuf over_background(const OIIO::ImageBuf& rows) const;
    /// Counts pixels whose color is beyond the range of half.
    void watch_range(const OIIO::ImageBuf& rows);
    void warn_of_range() const;
    void write_part(const OIIO::ImageBuf& rows);
    void write_fitted(const OIIO::ImageBuf& rows);

    std::string path_;
    WriteOptions options_;
    unsigned threads_ = 1;              // of a writer of ours
    std::vector<int> channels_;         // to write; empty: all
    int alpha_ = -1;                    // of those that are written
    bool watches_cover_ = false;        // warns if alpha is 0 everywhere
    bool has_cover_ = false;            // alpha is not 0 everywhere
    float surface_light_ = 1;           // the most of an opaque surface
    bool becomes_straight_ = false;     // the file divides color by alpha
    bool multiplies_by_alpha_ = false;  // the picture has straight alpha, and the file has not
    double pixel_count_ = 0;            // of what is written
    double lost_count_ = 0;             // pixels whose light straight alpha cannot hold
    double beyond_half_count_ = 0;      // pixels whose color is infinite as half
    std::optional<OIIO::ROI> window_;   // to write; none: all of the picture
    bool divides_by_alpha_ = false;
    std::vector<float> kept_;  // what was written, for WriteOptions::verifies
    int last_row_ = 0;         // of the picture, exclusive
    int next_row_ = 0;         // of the window, or of the picture
    int rows_written_ = 0;
    int rows_of_block_ = 0;                          // of an OpenEXR file, else 0
    std::unique_ptr<LightLevelMeter> light_levels_;  // of a PNG file in PQ or HLG, else null
    std::size_t light_levels_place_ = 0;             // of their chunk in the file
    // The order matters: at its end, the writer writes to the file.
    std::unique_ptr<AtomicFile> temporary_;
    std::unique_ptr<OutputFile>
        proxy_;                       // of OpenImageIO's writers that do not open files themselves
    std::unique_ptr<OpenFile> file_;  // of a writer of ours, else null
    std::unique_ptr<OIIO::ImageOutput> out_;
};

TONEWRIGHT_NAMESPACE_END
