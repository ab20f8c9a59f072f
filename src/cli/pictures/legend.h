// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include "tonewright/contact_sheet.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The legend of the operator false_color: a patch for every stop.
void add_legend(SheetAnnotations& around);

/// A picture in false color, sRGB code values, with the legend below it.
/// @throws Error  wider than 16384 pixels, or narrower than 16
[[nodiscard]] OIIO::ImageBuf with_legend(const OIIO::ImageBuf& picture);

TONEWRIGHT_NAMESPACE_END
