// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "picture/picture_spec.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Contents of the marker segments that hold the attributes of a JPEG file.
struct JpegMetadata {
    std::string comment;  // COM; empty: none
    std::string exif;     // APP1: Exif 2.3, 4.5
    std::string iptc;     // APP13: IPTC IIM 4.2 in a Photoshop resource; empty: none
};

/// The segments that OpenImageIO 2.4 writes for the attributes, byte for byte: texts (`Software`,
/// `Artist`, `Copyright`, `ImageDescription`, `DateTime`, `Exif:ImageHistory`), the orientation,
/// resolutions, exposure time, f-number and the tag of sRGB. OpenImageIO writes 1/2, 1/4, ... as
/// 1/0, and an empty text can end its process; here they are right.
/// @returns  nothing if OpenImageIO writes other attributes of the picture, too
[[nodiscard]] std::optional<JpegMetadata> jpeg_metadata(const PictureSpec& picture);

TONEWRIGHT_NAMESPACE_END
