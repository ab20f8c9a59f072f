// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The synthetic HDR test chart: scene-linear Rec.709 (wide-gamut patches have negatives), float
/// RGB.
///
/// Ramp of stops -12..+12 around 0.18, in steps and continuous; hue over exposure, saturated and
/// half-saturated; lit and emissive spheres; reflectances of a ColorChecker; primaries of Rec.709,
/// P3 and Rec.2020; near-black; smooth gradients that show banding and kinks. The labels use a
/// built-in font, so every machine draws the same chart.
///
/// @param width   at least 320
/// @param height  at least 180. The layout scales; it was designed for 1536 x 864. Labels that
///                would be too small are left out.
/// @throws Error  size out of range
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf make_chart(int width = 1536, int height = 864);

TONEWRIGHT_NAMESPACE_END
