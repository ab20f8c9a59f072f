// SPDX-License-Identifier: Apache-2.0
#include "image/shipped_pictures.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>

#include <memory>
#include <utility>

#include "base/strings.h"
#include "image/lut_picture.h"
#include "lut/shipped_set.h"
#include "tonewright/chart.h"
#include "tonewright/engine.h"
#include "tonewright/generated_files.h"
#include "tonewright/lut.h"
#include "tonewright/lut_applications.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;

// Small enough for a table of ten columns; hues and stops are still distinct.
constexpr int kThumbnailWidth = 96;
constexpr int kThumbnailHeight = 54;
// The chart is drawn larger and averaged: thin lines and steps keep their light.
constexpr int kOversampling = 4;

std::string encode_png(const ImageBuf& picture, const OIIO::TypeDesc& type) {
    OIIO::Filesystem::IOVecOutput memory;  // before what writes to it until it ends
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create("png");
    if (!out) throw Error(within("PNG", problem_of_library(OIIO::geterror())));
    OIIO::ImageSpec spec = picture.spec();
    spec.set_format(type);
    out->set_ioproxy(&memory);
    std::vector<float> pixels(spec.image_pixels() * 3);
    if (!picture.get_pixels(picture.roi(), OIIO::TypeDesc::FLOAT, pixels.data()) ||
        !out->open("lut.png", spec) || !out->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) ||
        !out->close()) {
        throw Error(within("PNG", problem_of_library(out->geterror())));
    }
    return {memory.buffer().begin(), memory.buffer().end()};
}

/// The chart's light, at the thumbnails' size.
std::vector<float> small_chart() {
    const ImageBuf chart =
        make_chart(kThumbnailWidth * kOversampling, kThumbnailHeight * kOversampling);
    std::vector<float> large(chart.spec().image_pixels() * 3);
    chart.get_pixels(chart.roi(), OIIO::TypeDesc::FLOAT, large.data());
    std::vector<float> small(std::size_t{3} * kThumbnailWidth * kThumbnailHeight);
    constexpr float kShare = 1.0F / (kOversampling * kOversampling);
    constexpr std::size_t kWidth = std::size_t{kThumbnailWidth} * kOversampling;
    for (std::size_t i = 0; i < large.size(); ++i) {
        const std::size_t x = i / 3 % kWidth / kOversampling;
        const std::size_t y = i / 3 / kWidth / kOversampling;
        small[3 * (y * kThumbnailWidth + x) + i % 3] += kShare * large[i];
    }
    return small;
}

/// The chart through the LUT on an sRGB screen, with the interpolation of its application.
ImageBuf make_thumbnail(const ShippedLut& shipped, const std::vector<float>& light) {
    const LutRequest& request = shipped.request;
    const ReferenceEngine encode(
        {MatrixStage{rgb_to_rgb(kRec709, find_input_space(request.view.input).primaries)},
         curve_stage(request.encoding.encode)});
    Pipeline showing;
    if (request.view.display != kLinearOutput) showing = find_display(request.view.display).decode;
    showing.push_back(ClampStage{0, 1});
    const Pipeline to_code = find_display("srgb").encode;
    showing.insert(showing.end(), to_code.begin(), to_code.end());
    const ReferenceEngine show(showing);

    std::vector<double> code(light.size());
    encode.run_rgb(light.data(), code.data(), light.size() / 3);
    std::vector<float> shown(light.size());
    for (std::size_t i = 0; i < light.size(); i += 3) {
        const Vector3 out = show(interpolate(shipped.lut, {code[i], code[i + 1], code[i + 2]},
                                             interpolation_of(shipped.set->host)));
        for (std::size_t c = 0; c < 3; ++c)
            shown[i + c] = static_cast<float>(out[c]);
    }
    OIIO::ImageSpec spec(kThumbnailWidth, kThumbnailHeight, 3, OIIO::TypeDesc::FLOAT);
    spec.attribute("oiio:ColorSpace", "sRGB");
    ImageBuf picture(spec);
    picture.set_pixels(picture.roi(), OIIO::TypeDesc::FLOAT, shown.data());
    return picture;
}

}  // namespace

std::vector<GeneratedFile> make_shipped_files(std::vector<ShippedLut>& luts) {
    const std::vector<float> light = small_chart();
    std::vector<GeneratedFile> files;
    for (ShippedLut& lut : luts) {
        if (is_picture_format(lut.request.format)) {
            lut.contents =
                encode_png(make_lut_picture(lut.lut, lut.request.format),
                           lut.request.bits == 8 ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16);
        }
        files.push_back({lut.path, lut.contents});
        files.push_back(
            {lut.thumbnail, encode_png(make_thumbnail(lut, light), OIIO::TypeDesc::UINT8)});
    }
    return files;
}

TONEWRIGHT_NAMESPACE_END
