// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "picture/picture_spec.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The bytes of a PNG file before its pixels: signature, IHDR and the chunks that OpenImageIO 2.4
/// writes for the attributes, in its order.
/// @param spec  of 1 to 4 channels and 8 or 16 bits
/// @returns  nothing where OpenImageIO converts an attribute, or libpng refuses one
[[nodiscard]] std::optional<std::string> png_header(const PictureSpec& spec);

TONEWRIGHT_NAMESPACE_END
