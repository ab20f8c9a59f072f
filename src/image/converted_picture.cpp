// SPDX-License-Identifier: Apache-2.0
#include "image/converted_picture.h"

#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagebufalgo_util.h>

#include <cstddef>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "base/strings.h"
#include "image/spec_conversion.h"
#include "picture/source_pixels.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// ImageBufAlgo::transpose() with the pixel type of its source.
OIIO::ImageBuf transposed(const OIIO::ImageBuf& picture) {
    OIIO::ImageSpec spec = picture.spec();
    std::swap(spec.x, spec.y);
    std::swap(spec.width, spec.height);
    std::swap(spec.full_x, spec.full_y);
    std::swap(spec.full_width, spec.full_height);
    OIIO::ImageBuf result(spec);
    OIIO::ImageBufAlgo::transpose(result, picture);
    return result;
}

/// ImageBufAlgo::reorient() of OpenImageIO 2.4 turns 5 and 7 by 180 degrees too much.
OIIO::ImageBuf turned_by(int orientation, const OIIO::ImageBuf& picture) {
    namespace iba = OIIO::ImageBufAlgo;
    switch (orientation) {  // JEITA CP-3451, 4.6.4: where the first row and column are
        case 2:
            return iba::flop(picture);
        case 3:
            return iba::rotate180(picture);
        case 4:
            return iba::flip(picture);
        case 5:
            return transposed(picture);
        case 6:
            return iba::rotate90(picture);
        case 7:
            return iba::rotate180(transposed(picture));
        case 8:
            return iba::rotate270(picture);
        default:
            return picture;
    }
}

}  // namespace

PictureSpec described_spec(const OIIO::ImageBuf& picture) {
    return described_spec(picture_spec(picture.spec()), std::string(picture.file_format_name()));
}

OIIO::ImageBuf converted_picture(const OIIO::ImageBuf& picture, const SourceColor& color) {
    const PictureSpec spec = picture_spec(picture.spec());
    const bool is_gray = channel_layout(spec).is_gray;
    const bool divides =
        spec.alpha_channel >= 0 && divides_by_alpha(spec, TonemapOptions::Unpremult::automatic);
    OIIO::ImageBuf result = picture.copy(OIIO::TypeFloat);
    if (!result.localpixels()) throw PictureError(first_line(result.geterror()));
    if (divides) OIIO::ImageBufAlgo::unpremult(result, result);
    const auto channels = static_cast<std::size_t>(result.nchannels());
    OIIO::ImageBufAlgo::parallel_image(result.roi(), [&](OIIO::ROI part) {
        std::vector<float> rgb(3 * static_cast<std::size_t>(part.width()));
        for (int z = part.zbegin; z < part.zend; ++z) {
            for (int y = part.ybegin; y < part.yend; ++y) {
                auto* row = static_cast<float*>(result.pixeladdr(part.xbegin, y, z));
                const std::size_t n = rgb.size() / 3;
                for (std::size_t i = 0; i < n; ++i) {
                    for (std::size_t c = 0; c < 3; ++c)
                        rgb[3 * i + c] = row[i * channels + (is_gray ? 0 : c)];
                }
                color.convert(rgb.data(), rgb.data(), n);
                for (std::size_t i = 0; i < n; ++i) {
                    for (std::size_t c = 0; c < (is_gray ? 1U : 3U); ++c)
                        row[i * channels + c] = rgb[3 * i + (is_gray ? 1 : c)];
                }
            }
        }
    });
    if (divides) OIIO::ImageBufAlgo::premult(result, result);
    result.specmod().extra_attribs = image_spec(converted_spec(spec, color)).extra_attribs;
    return result;
}

OIIO::ImageBuf upright(OIIO::ImageBuf picture) {
    const int orientation = orientation_of(picture_spec(picture.spec()));
    if (orientation == 1) return picture;
    OIIO::ImageBuf turned = turned_by(orientation, picture);
    if (turned.has_error() || !turned.localpixels()) {
        (void)turned.geterror();
        throw std::bad_alloc();
    }
    // Some of these functions drop metadata, names and alpha.
    const OIIO::ImageSpec& stored = picture.spec();
    OIIO::ImageSpec& spec = turned.specmod();
    spec.extra_attribs = stored.extra_attribs;
    spec.channelnames = stored.channelnames;
    spec.alpha_channel = stored.alpha_channel;
    spec.z_channel = stored.z_channel;
    spec.attribute("Orientation", 1);
    return turned;
}

TONEWRIGHT_NAMESPACE_END
