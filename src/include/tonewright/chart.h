// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The synthetic HDR test chart: scene-linear Rec.709 (wide-gamut patches have negatives), float
/// RGB.
///
/// Stop ramp -12..+12 about 0.18 in steps and continuous; hue over exposure, saturated and half
/// saturated; lit and emissive spheres; reflectances of a ColorChecker; primaries of Rec.709, P3
/// and Rec.2020; near-black; smooth gradients that show banding and kinks. Labelled in the picture,
/// with a font of our own: every machine draws the same chart.
///
/// @param width   at least 320; @param height  at least 180. The layout scales; 1536 x 864 is
///                what it was drawn for. Labels are left out where they could not be read.
/// @throws Error  size out of range.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf make_chart(int width = 1536, int height = 864);

TONEWRIGHT_NAMESPACE_END
