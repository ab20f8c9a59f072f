// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <string>
#include <string_view>

#include "tonewright/tonemap.h"
#include "tonewright/view.h"

/// Pictures of another size, in scene-linear light. @see ReadOptions::resize
TONEWRIGHT_NAMESPACE_BEGIN

/// The size that a text names.
struct ResizeSize {
    int width = 0;       // 0: `percent` counts
    int height = 0;      // 0: by the picture's shape
    double percent = 0;  // of width and height
};
/// `1920x1080`, `1920` (the width) or `50%`.
/// @throws Error  any other text
[[nodiscard]] TONEWRIGHT_API ResizeSize parse_resize(std::string_view text);

/// The spec of a picture whose display window gets the size. The data window covers at least the
/// same part of it as before. An explicit width and height change the pixel aspect ratio of a
/// picture whose pixels are not square, so that its shape stays. The size counts for the upright
/// picture.
/// @throws PictureError  more than `max_pixels` pixels, or a volume
[[nodiscard]] TONEWRIGHT_API OIIO::ImageSpec resized_spec(const OIIO::ImageSpec& picture,
                                                          std::string_view size, double max_pixels);

/// The spec of resized_light(): floats whose metadata states the light of `color`. Straight alpha
/// becomes associated, unless alpha does not count.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageSpec light_spec(const OIIO::ImageSpec& resized,
                                                        const SourceColor& color,
                                                        TonemapOptions::Unpremult unpremult);

/// Decodes a picture to light and resizes it. Color is multiplied by alpha before.
///
/// The filter is OpenImageIO's `lanczos3`, whose negative lobes draw dark and bright rings around
/// lamps. Light above the operator's 1 therefore takes OpenImageIO's `triangle`, which has none.
/// Both filters keep the mean, so the picture keeps its light. Alpha is limited to [0, 1], if it
/// was before. Channels beyond color and alpha (depth, ids) take the nearest pixel. NaN becomes 0,
/// and infinities become +-65504.
///
/// @param options  of tone mapping: exposure, units and reference white give the light that the
///                 operator gets as 1
/// @param target   of light_spec()
/// @throws PictureError  a picture without color
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf resized_light(const OIIO::ImageBuf& picture,
                                                          const SourceColor& color,
                                                          const TonemapOptions& options,
                                                          const OIIO::ImageSpec& target,
                                                          int nthreads);

/// The light of a picture in memory at another size, for tonemap() with the same options.
/// @param size  text of parse_resize()
/// @throws PictureError  as resized_spec() and resized_light(). Error: the text, an unknown input
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf resized_picture(const OIIO::ImageBuf& picture,
                                                            std::string_view size,
                                                            const TonemapOptions& options,
                                                            double max_pixels = kMaxPixels,
                                                            int nthreads = 0);

TONEWRIGHT_NAMESPACE_END
