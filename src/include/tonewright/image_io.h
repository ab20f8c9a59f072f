// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <string>
#include <string_view>

#include "tonewright/error.h"

/// Picture files, read and written whole or not at all.
TONEWRIGHT_NAMESPACE_BEGIN

/// Reads a whole picture into memory, in the pixel type of the file: first subimage, full
/// resolution.
///
/// Stricter than ImageBuf::read(): whatever the reader reports is an error, so that a truncated
/// file is never a half-black picture (ImageBuf passes over truncated TIFF and JPEG files). Nothing
/// stays in OIIO's cache: a file that was rewritten is read anew.
///
/// @throws FileError  missing, truncated, unreadable, of unknown format, or deep. One line.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf read_image(const std::string& path);

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
/// @param type        pixel type of the file; UNKNOWN: the buffer's, or what OIIO
///                    takes for it in this format (8 bits for a float picture as PNG or JPEG).
/// @throws FileError  unknown extension, directory missing or not writable, disk full, ... In one
///                    line; nothing is left behind.
TONEWRIGHT_API void write_image_atomically(const OIIO::ImageBuf& image, const std::string& path,
                                           const OIIO::TypeDesc& type = OIIO::TypeUnknown);

/// `uint8`, `uint16`, `half` or `float`, as oiiotool's `-d` has them.
/// @throws Error  for any other text, with the nearest name.
[[nodiscard]] TONEWRIGHT_API OIIO::TypeDesc parse_pixel_type(std::string_view text);

TONEWRIGHT_NAMESPACE_END
