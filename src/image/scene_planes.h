// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include "tonewright/engine.h"
#include "tonewright/local.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The data window of a picture for a local operator, which runs on `nthreads` threads.
///
/// @param src       @see check_source
/// @param to_light  scene-linear of the source -> Rec.709 light, not negative.
/// @param exposure_stops  of the operator; the light itself is before exposure.
/// @throws Error    more than one slice; no color; the picture cannot be read.
[[nodiscard]] ScenePlanes read_light(const OIIO::ImageBuf& src, const SimdEngine& to_light,
                                     TonemapOptions::Unpremult unpremult, double exposure_stops,
                                     int nthreads);

TONEWRIGHT_NAMESPACE_END
