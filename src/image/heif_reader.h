// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imageio.h>

#include <memory>
#include <string>

#include "tonewright/version.h"

/// HEIF, HEIC and AVIF through libheif: OpenImageIO 2.4 delivers 8 bits of them, and no colors.
TONEWRIGHT_NAMESPACE_BEGIN

/// True for a file of still pictures of these formats, by its contents. False where this build has
/// no libheif.
[[nodiscard]] TONEWRIGHT_API bool is_heif(const std::string& path);

/// Opens one. Its subimages are the pictures of the file, the primary one first.
///
/// Pixels are as stored: of 8 bits uint8, of more bits uint16 (code * 65535 / largest code,
/// rounded), RGB of the file's own matrix and range; one channel for monochrome. Upright: `irot`,
/// `imir` and `clap` are applied, and the orientation in Exif is ignored, as ISO/IEC 23008-12
/// says. Straight alpha has `oiio:UnassociatedAlpha`.
///
/// Attributes: `CICP` (int[4]: color primaries, transfer characteristics, matrix coefficients, full
/// range, as OpenImageIO 3.1 has it), `ICCProfile`, Exif and XMP, `oiio:BitsPerSample`, and facts:
/// - `heif:MaxCLL`, `heif:MaxFALL` (cd/m2), `heif:MasteringLuminance` (float[2]: least, largest)
/// - `heif:GainMap` (its kind), `heif:Auxiliary` (kinds of other auxiliary pictures),
///   `heif:Sequence` (1: it also has tracks of pictures), `heif:ExifOrientation` (other than 1)
///
/// The pixels are decoded when a picture is opened, after its size was checked.
/// @throws FileError  damaged, of a codec that libheif lacks, or with more than `max_pixels`. One
///                    line.
[[nodiscard]] TONEWRIGHT_API std::unique_ptr<OIIO::ImageInput> open_heif(const std::string& path,
                                                                         double max_pixels);

TONEWRIGHT_NAMESPACE_END
