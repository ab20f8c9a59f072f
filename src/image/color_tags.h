// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imageio.h>

#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Makes the metadata say what a picture holds after `view`: sets `oiio:ColorSpace`, and
/// `chromaticities` where they are not those of Rec.709, and removes whatever described the
/// source's colors.
TONEWRIGHT_API void tag_as_result_of(const View& view, OIIO::ImageSpec& spec);
/// Removes it, and says nothing: nobody knows what the colors are now.
TONEWRIGHT_API void tag_as_unknown(OIIO::ImageSpec& spec);

TONEWRIGHT_NAMESPACE_END
