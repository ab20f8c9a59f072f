// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imageio.h>

#include "tonewright/view.h"

namespace tonewright {

/// Makes the metadata say what a picture holds after `view`: sets `oiio:ColorSpace` (with
/// `oiio:Gamma` and `chromaticities` where they belong to it), and removes whatever described the
/// source's colors.
void tag_as_result_of(const View& view, OIIO::ImageSpec& spec);

}  // namespace tonewright
