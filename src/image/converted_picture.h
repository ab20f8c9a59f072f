// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include "picture/picture_description.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The spec of a picture that OpenImageIO may have read: with the name of its format, by which
/// describe_picture() reads the metadata.
[[nodiscard]] TONEWRIGHT_API PictureSpec described_spec(const OIIO::ImageBuf& picture);

/// Applies SourceColor::convert: the result has float pixels, and its metadata states linear
/// Rec.709 or the primaries of `color`. Associated color is divided by alpha before.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf converted_picture(const OIIO::ImageBuf& picture,
                                                              const SourceColor& color);
/// The picture as viewers show it: turned by its orientation, which becomes 1.
/// @throws std::bad_alloc
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf upright(OIIO::ImageBuf picture);

TONEWRIGHT_NAMESPACE_END
