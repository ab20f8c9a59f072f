// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/typedesc.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "picture/file_bytes.h"
#include "picture/picture_spec.h"
#include "picture/row_files.h"
#include "picture/row_fitter.h"
#include "tonewright/error.h"
#include "tonewright/picture_options.h"

/// Picture files, a few rows at a time. Writing succeeds completely or fails.
TONEWRIGHT_NAMESPACE_BEGIN

class AtomicFile;
class LightLevelMeter;

/// A file that was written, as its writer knows it.
struct WrittenFile {
    std::string path;
    PictureSpec spec;
    std::string format;
    std::string codec = {};          // the format, or `avif`
    bool is_opened_by_name = false;  // nothing has told of a full disk
    int bits = 0;                    // of integers; 0: those of the type
    /// That were to be written; null: they are not compared.
    const std::vector<float>* pixels = nullptr;
};

/// A new file of a picture.
struct NewFile {
    std::string path;         // temporary, with the extension of the target
    std::string target;       // for its extension
    OpenFile& file;           // empty; whoever writes it takes it
    std::string_view chunks;  // of a PNG file, after its header
    unsigned threads = 1;
};

/// The writers of all formats. Those of own_writers() need no other library than the format's.
struct FormatWriters {
    /// OpenImageIO's name of the format of a file.
    /// @throws FileError  the reason why there is none
    std::function<std::string(const std::string& path)> format_of;
    /// @throws FileError  the reason, without the name of the file
    std::function<std::unique_ptr<RowWriter>(const std::string& format, const PictureSpec& spec,
                                             const NewFile& to)>
        create;
    /// Opens a complete file again.
    /// @returns  the difference from what was to be written; empty if there is none
    std::function<std::string(const WrittenFile& written)> fault_of;
};

/// Writers of this program for PNG, JPEG and OpenEXR. `create` gives null for pictures that
/// OpenImageIO's writers change (create_png(), create_jpeg(), create_exr()). `format_of` throws for
/// names of other formats.
[[nodiscard]] TONEWRIGHT_API const FormatWriters& own_writers();

/// Writes a picture from its first row to its last under a temporary name, and renames it when it
/// is complete. @see write_image_atomically
class TONEWRIGHT_API FileWriter {
  public:
    /// Changes nothing yet.
    /// @param threads  that compress, 1 or more
    /// @throws FileError  unknown extension, or a path where no file can be
    /// @throws Error      compression or quality that the format does not have
    FileWriter(const std::string& path, WriteOptions options, unsigned threads,
               const FormatWriters& writers);
    /// Removes an unfinished file.
    ~FileWriter();
    FileWriter(const FileWriter&) = delete;
    FileWriter& operator=(const FileWriter&) = delete;

    /// Before opening: the picture is made from one of this pixel type. If the options state none,
    /// an OpenEXR file has openexr_type(). Other formats keep their own defaults.
    /// @param source  UNKNOWN: changes nothing
    void keep_type(const OIIO::TypeDesc& source) { fitter_.keep_type(source); }
    /// OpenImageIO's name.
    [[nodiscard]] const std::string& format() const { return format_; }
    /// The spec that a writer will be asked for. Changes nothing.
    /// @throws FileError
    [[nodiscard]] PictureSpec planned(const PictureSpec& picture);
    /// @param picture  the spec of all rows together.
    /// @throws FileError
    void open(const PictureSpec& picture);
    /// After opening: the better pixel type for the rows, half or float. Both give the same file.
    [[nodiscard]] OIIO::TypeDesc row_type() const;
    /// True if files of the format store Exif's orientation and programs follow it. Others need
    /// upright pixels.
    [[nodiscard]] bool keeps_orientation() const;
    /// After opening: true if the format takes the last row first.
    [[nodiscard]] bool is_bottom_up() const;
    /// The next rows of the picture, or the picture.
    /// @throws FileError
    void write_rows(const RowFitter::Rows& rows);
    /// @throws FileError
    void finish();
    [[noreturn]] void fail(const Problem& why) const;

  private:
    [[noreturn]] void fail(const std::string& reason) const;
    template <class Step>
    decltype(auto) naming_file(const Step& step) const;
    /// Limitations of the file, in one warning.
    void warn_of_limits(const PictureSpec& requested, const std::string& missing) const;
    void warn(const std::string& text) const;
    void write_fitted(const RowFitter::Rows& rows);
    /// Counts pixels whose color is beyond the range of half.
    void watch_range(const RowFitter::Rows& rows, std::size_t count);
    void warn_of_range() const;
    void patch_light_levels() const;

    std::string path_;
    WriteOptions options_;
    unsigned threads_ = 1;
    const FormatWriters& writers_;
    std::string format_;
    std::string codec_;  // the format, or `avif`
    RowFitter fitter_;
    double beyond_half_count_ = 0;  // pixels whose color is infinite as half
    std::vector<float> kept_;       // what was written, for WriteOptions::verifies
    int rows_written_ = 0;
    std::unique_ptr<LightLevelMeter> light_levels_;  // of a PNG file in PQ or HLG, else null
    std::size_t light_levels_place_ = 0;             // of their chunk in the file
    // The order matters: at its end, the writer writes to the file.
    std::unique_ptr<AtomicFile> temporary_;
    std::unique_ptr<RowWriter> out_;
};

TONEWRIGHT_NAMESPACE_END
