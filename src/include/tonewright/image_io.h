// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <string>

#include "tonewright/picture_options.h"

/// Picture files. Reading and writing succeed completely or fail.
TONEWRIGHT_NAMESPACE_BEGIN

/// Reads a whole picture into memory, in the pixel type of the file, at full resolution. The
/// picture keeps its orientation in `Orientation`.
///
/// Stricter than ImageBuf::read(): every report of the reader is an error, so a truncated file
/// never gives a half-black picture (ImageBuf accepts truncated TIFF and JPEG files). Nothing stays
/// in OIIO's cache, so a changed file is read again.
///
/// Facts of the header that OpenImageIO drops become attributes `tonewright:file:*`, by which
/// tonemap() knows the color (cICP of PNG, PRIMARIES of Radiance, ...).
///
/// Straight alpha, as of PNG and TGA, stays straight: the attribute `oiio:UnassociatedAlpha` is 1.
/// OpenImageIO would multiply color by alpha in the file's pixel type.
///
/// @throws FileError  missing, truncated, unreadable, of unknown format, deep, without the layer or
///                    the subimage, or with more pixels than the limit (checked before memory is
///                    allocated). One line.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf read_image(const std::string& path,
                                                       const ReadOptions& options);
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf read_image(const std::string& path,
                                                       double max_pixels = kMaxPixels);

/// Writes a picture under a temporary name beside `path`
/// (`.<stem>.<machine>.<pid>.<n>.tmp.<extension>`; machine: eight digits that identify this machine
/// and container), syncs it to the disk and renames it. `path` is always the complete old file or
/// the complete new one.
///
/// Leaves out what the format cannot store: alpha, channels beyond color and alpha, and pixels
/// outside the display window (which is padded with black). A replaced file keeps its permissions.
/// A symbolic link stays, and its target is replaced. A file without write permission is not
/// replaced.
///
/// The file states its color, from `oiio:ColorSpace` and `chromaticities`: PNG, JPEG and TIFF files
/// get an ICC profile (sRGB in PNG: the chunk sRGB), PNG files in PQ or HLG the chunks cICP and
/// cLLI (largest channel of a pixel, and mean over pixels of each pixel's largest channel, in
/// cd/m2). A build without Little CMS writes no profiles. OpenEXR files get `chromaticities` and
/// the attribute `colorInteropID`, or `tonewright:display` for colors that the Color Interop Forum
/// has no identifier of, as tonemap() sets them; `oiio:ColorSpace` is not stored there. If a format
/// cannot state the color, `warn` is called.
///
/// @throws Error      compression or quality that the format does not have
/// @throws FileError  unknown extension, folder missing or not writable, disk full, ... One line;
///                    no file is left behind.
TONEWRIGHT_API void write_image_atomically(const OIIO::ImageBuf& image, const std::string& path,
                                           const WriteOptions& options);
TONEWRIGHT_API void write_image_atomically(const OIIO::ImageBuf& image, const std::string& path,
                                           const OIIO::TypeDesc& type = OIIO::TypeUnknown);

/// The same picture with associated alpha: if `oiio:UnassociatedAlpha` is set, as floats whose
/// color is multiplied by alpha.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf with_associated_alpha(const OIIO::ImageBuf& image);

TONEWRIGHT_NAMESPACE_END
