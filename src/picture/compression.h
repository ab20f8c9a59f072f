// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "picture/picture_spec.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// @see WriteOptions, whose fields these are.
struct CompressionOptions {
    std::string compression = {};
    int quality = 0;
    std::string subsampling = {};
};

/// @param path   begins the message
/// @param codec  the format, or `avif`
/// @throws Error  a compression, a quality or a subsampling that the format does not have
void check_compression(const std::string& path, std::string_view codec,
                       const CompressionOptions& options);

/// Replaces the compression of the source by that of the options.
/// @param codec  the format, or `avif`
void set_compression(PictureSpec& spec, std::string_view codec, const CompressionOptions& options);

/// The quality in the name of a compression ("dwaa:100"), else that of "CompressionQuality".
/// @param otherwise  without either
[[nodiscard]] int quality_of(const PictureSpec& spec, int otherwise);

/// Rows of the blocks that a compression of OpenEXR makes (ImfCompressor.cpp); 0 for other names.
[[nodiscard]] int rows_of_block(std::string_view compression);

TONEWRIGHT_NAMESPACE_END
