// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include "tonewright/engine.h"
#include "tonewright/image.h"
#include "tonewright/local.h"

namespace tonewright {

/// The data window of a picture for a local operator, which runs on `nthreads` threads.
///
/// @param src       @see check_source
/// @param to_light  scene-linear of the source -> Rec.709 light, not negative.
/// @throws Error    more than one slice; no color; the picture cannot be read.
[[nodiscard]] LightPicture read_light(const OIIO::ImageBuf& src, const SimdEngine& to_light,
                                      TonemapOptions::Unpremult unpremult, int nthreads);

}  // namespace tonewright
