// SPDX-License-Identifier: Apache-2.0
#include "cli/picture_output.h"

#include "image/lut_picture.h"
#include "tonewright/image.h"

namespace tonewright {

void write_lut_picture(const Lut& lut, LutFormat format, const std::string& path, int bits) {
    OIIO::TypeDesc type = OIIO::TypeDesc::FLOAT;
    if (bits == 8) type = OIIO::TypeDesc::UINT8;
    if (bits == 16) type = OIIO::TypeDesc::UINT16;
    write_image_atomically(make_lut_picture(lut, format), path, type);
}

}  // namespace tonewright
