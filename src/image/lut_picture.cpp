// SPDX-License-Identifier: Apache-2.0
#include "image/lut_picture.h"

#include <cmath>

namespace tonewright {

OIIO::ImageBuf make_lut_picture(const Lut& lut, LutFormat format) {
    if (!is_picture_format(format)) throw Error("lut: format is no picture");
    const int n = lut.size;
    const int level = static_cast<int>(std::lround(std::sqrt(n)));
    const int width = format == LutFormat::hald ? n * level : n * n;
    const int height = format == LutFormat::hald ? n * level : n;
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::FLOAT);
    // Numbers, not light: no program is to convert them.
    spec.attribute("oiio:ColorSpace", "Raw");
    OIIO::ImageBuf picture(spec);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const int node =
                format == LutFormat::hald ? y * width + x : (x / n * n + y) * n + x % n;
            picture.setpixel(x, y, &lut.values[3 * static_cast<std::size_t>(node)]);
        }
    }
    return picture;
}

}  // namespace tonewright
