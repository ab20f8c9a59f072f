// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <functional>
#include <string>
#include <string_view>

#include "tonewright/error.h"

/// Picture files, read and written whole or not at all.
TONEWRIGHT_NAMESPACE_BEGIN

/// Pixels (width x height x depth) that a picture may declare unless the caller says otherwise: 12
/// GB as three floats each. A file of a kilobyte can declare more than any memory holds.
inline constexpr double kMaxPixels = 1e9;

/// Reads a whole picture into memory, in the pixel type of the file: first subimage, full
/// resolution.
///
/// Stricter than ImageBuf::read(): whatever the reader reports is an error, so that a truncated
/// file is never a half-black picture (ImageBuf passes over truncated TIFF and JPEG files). Nothing
/// stays in OIIO's cache: a file that was rewritten is read anew.
///
/// @throws FileError  missing, truncated, unreadable, of unknown format, deep, or with more pixels
///                    than `max_pixels`, before there is memory for them. One line.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf read_image(const std::string& path,
                                                       double max_pixels = kMaxPixels);

/// How a picture file is written.
struct WriteOptions {
    /// Pixel type of the file; UNKNOWN: the buffer's, or what OIIO takes for it in this format (8
    /// bits for a float picture as PNG or JPEG, but 16 for PNG in PQ or HLG).
    OIIO::TypeDesc type = OIIO::TypeUnknown;
    /// What becomes of the alpha channel.
    enum class Alpha : unsigned char {
        keep,
        /// It is left out.
        ignore,
        /// It is 1 everywhere.
        opaque,
    };
    Alpha alpha = Alpha::keep;
    /// As oiiotool's `--compression`: a method of the format, with `:quality` where it has one.
    /// Empty: the source's where the format has it, else the format's default.
    std::string compression = {};
    /// As oiiotool's `--quality`, [1, 100]. 0: the format's default.
    int quality = 0;
    /// A format without display window holds the display window, filled up with black: at most
    /// this many pixels, or four times those of the data window.
    double max_pixels = 1e8;
    /// tonemap_file() says in the file how it was made: `Software` is the version, operator,
    /// parameters, exposure and display; OpenEXR and PNG files also have the attributes
    /// `tonewright:operator`, `tonewright:exposure` and `tonewright:display`.
    bool says_how = false;
    /// Hears, before the file gets its name, why the file is not what a user may expect, in one
    /// line without its name. What it throws stops the writing.
    std::function<void(const std::string&)> warn = {};
};

/// Writes a picture under a temporary name beside `path`
/// (`.<stem>.<machine>.<pid>.<n>.tmp.<extension>`; machine: eight digits that are those of this
/// machine and container), syncs it to the disk and renames it: `path` holds the old file or the
/// new one, never a part.
///
/// What the format cannot hold is left out: alpha, channels beyond color and alpha, and pixels
/// outside the display window (which is filled up with black). The permissions of a file that is
/// replaced stay; a symbolic link stays and its target is replaced. A file that may not be written
/// is not replaced.
///
/// The file says what its colors are, from `oiio:ColorSpace` and `chromaticities`: PNG, JPEG and
/// TIFF files get an ICC profile (PNG: the chunk sRGB for sRGB), PNG files in PQ or HLG the chunk
/// cICP. A build without Little CMS writes no profiles. Where a format cannot say it, `warn` hears
/// so.
///
/// @throws Error      compression or quality that the format does not have
/// @throws FileError  unknown extension, directory missing or not writable, disk full, ... In one
///                    line; nothing is left behind.
TONEWRIGHT_API void write_image_atomically(const OIIO::ImageBuf& image, const std::string& path,
                                           const WriteOptions& options);
TONEWRIGHT_API void write_image_atomically(const OIIO::ImageBuf& image, const std::string& path,
                                           const OIIO::TypeDesc& type = OIIO::TypeUnknown);

/// `uint8`, `uint16`, `half` or `float`, as oiiotool's `-d` has them.
/// @throws Error  for any other text, with the nearest name.
[[nodiscard]] TONEWRIGHT_API OIIO::TypeDesc parse_pixel_type(std::string_view text);

TONEWRIGHT_NAMESPACE_END
