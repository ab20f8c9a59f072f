// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

// sRGB code values around pictures. Neutral, and dark enough not to light up the pictures.
inline constexpr double kSheetBackground = 0.125;
inline constexpr double kSheetText = 0.82;
inline constexpr double kSheetDimText = 0.58;

/// Most pixels of a sheet each way.
inline constexpr int kLargestSheet = 65535;

struct PictureSize {
    int width;
    int height;
};

/// The display window, all channels: what a viewer shows. Pixels outside the data window are black.
[[nodiscard]] TONEWRIGHT_API OIIO::ROI shown_window(const OIIO::ImageBuf& picture);

/// The size of a picture of that width with the picture's shape.
[[nodiscard]] TONEWRIGHT_API PictureSize fitted_size(const OIIO::ImageBuf& picture, int width);

/// @throws PictureError  a display window of over 10^8 pixels that is over 4 times the data window
TONEWRIGHT_API void check_shown_window(const OIIO::ImageBuf& picture);

/// The shown part of a picture without changes: float RGB, gray in all three. Alpha is not used.
/// @throws Error         a picture that cannot be read
/// @throws PictureError  @see check_shown_window
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf shown_rgb(const OIIO::ImageBuf& picture);

/// All channels of a picture, made smaller by a filter without negative lobes: no dark rims around
/// lights. Errors are those of the result.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf filtered_down(const OIIO::ImageBuf& picture,
                                                          const PictureSize& size);
/// The same for a part `roi` of a small picture that exists. Windows are mapped to windows.
TONEWRIGHT_API void filter_down(OIIO::ImageBuf& small, const OIIO::ImageBuf& picture,
                                const OIIO::ROI& roi);

TONEWRIGHT_NAMESPACE_END
