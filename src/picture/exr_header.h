// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenEXR/openexr.h>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "picture/picture_spec.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A channel of a file, in the file's order: by name.
struct ExrChannel {
    std::string name;
    exr_pixel_type_t type = EXR_PIXEL_HALF;
    std::size_t index = 0;                // among the spec's channels
    bool is_perceptually_linear = false;  // B44 packs such channels as they are

    [[nodiscard]] std::size_t bytes() const { return type == EXR_PIXEL_HALF ? 2 : 4; }
};

/// One picture of a file.
struct ExrPart {
    PictureSpec spec;
    std::vector<ExrChannel> channels;
    exr_compression_t compression = EXR_COMPRESSION_NONE;
    bool is_tiled = false;
    /// The file has Y, RY and BY. The spec has the R, G and B that they encode.
    bool is_luminance_chroma = false;
    int rows_of_block = 1;  // of tiles: their height

    /// Bytes of a pixel with the types of the file's channels.
    [[nodiscard]] std::size_t pixel_bytes() const;
};

/// OpenImageIO's name of a compression ("zip"); empty for one that version 3.1 does not know.
[[nodiscard]] std::string_view compression_name(exr_compression_t compression);
/// The compression of such a name.
[[nodiscard]] std::optional<exr_compression_t> compression_of(std::string_view name);
/// OIIO's type of a channel.
[[nodiscard]] OIIO::TypeDesc type_of(exr_pixel_type_t type);

/// The type of a channel in OIIO's type; float for other types than UINT and HALF.
[[nodiscard]] exr_pixel_type_t pixel_type_of(const OIIO::TypeDesc& type);

/// The part's header as OpenImageIO 2.4 gives it.
/// @returns  nothing for a part that this library does not read
[[nodiscard]] std::optional<ExrPart> read_header(exr_const_context_t file, int part,
                                                 int part_count);

TONEWRIGHT_NAMESPACE_END
