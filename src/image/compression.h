// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imageio.h>

#include <string>
#include <string_view>

#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// @param path   begins the message
/// @param codec  the format, or `avif`
/// @throws Error  a compression, a quality or a subsampling that the format does not have
void check_compression(const std::string& path, std::string_view codec,
                       const WriteOptions& options);

/// Replaces the compression of the source by that of the options.
/// @param codec  the format, or `avif`
void set_compression(OIIO::ImageSpec& spec, std::string_view codec, const WriteOptions& options);

/// Rows of the blocks that a compression of OpenEXR makes (ImfCompressor.cpp); 0 for other names.
[[nodiscard]] int rows_of_block(std::string_view compression);

TONEWRIGHT_NAMESPACE_END
