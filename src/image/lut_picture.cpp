// SPDX-License-Identifier: Apache-2.0
#include "image/lut_picture.h"
#include "image/converted_picture.h"
#include "image/picture_file.h"
#include "tonewright/image_io.h"
#include "tonewright/lut.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The node of a pixel, for a 3D LUT of n points a side; red fastest.
std::size_t node_of(LutFormat format, int n, int width, int x, int y) {
    const int green = format == LutFormat::strip_up ? n - 1 - y : y;
    const int node = format == LutFormat::hald ? y * width + x : (x / n * n + green) * n + x % n;
    return static_cast<std::size_t>(node);
}

/// Nothing else in the file distinguishes a strip from an upside-down one.
constexpr const char* kGreenUp = "3D LUT as a strip, green from the bottom up";

constexpr int kLargestLevel = 16;
constexpr int kLargestStrip = 64;

struct Layout {
    LutFormat format;
    int n;
};

Layout layout_of(const std::string& path, int width, int height) {
    for (int level = 2; level <= kLargestLevel && width == height; ++level) {
        if (level * level * level == width) return {LutFormat::hald, level * level};
    }
    if (height >= 2 && height <= kLargestStrip && width == height * height)
        return {LutFormat::strip, height};
    throw FileError(fmt::format(
        "read: {}: has {} x {} pixels; expected L^3 x L^3 with L in [2, {}], a Hald CLUT, or N*N x "
        "N with N in [2, {}], a strip",
        path, width, height, kLargestLevel, kLargestStrip));
}

}  // namespace

void write_lut_picture(const Lut& lut, LutFormat format, const std::string& path, int bits) {
    OIIO::TypeDesc type = OIIO::TypeDesc::FLOAT;
    if (bits == 8) type = OIIO::TypeDesc::UINT8;
    if (bits == 16) type = OIIO::TypeDesc::UINT16;
    write_image_atomically(make_lut_picture(lut, format), path, type);
}

Lut read_lut_picture(const std::string& path) {
    {
        const auto in = open_picture(path);
        // Checked before memory is allocated for its pixels.
        (void)layout_of(path, in->spec().width, in->spec().height);
    }
    return lut_of_picture(upright(read_image(path)), path);
}

Lut lut_of_picture(const OIIO::ImageBuf& picture, const std::string& path) {
    const OIIO::ImageSpec& spec = picture.spec();
    Layout layout = layout_of(path, spec.width, spec.height);
    if (spec.nchannels < 3 || spec.nchannels > 4) {
        throw FileError(fmt::format("read: {}: has {} channels; expected 3", path, spec.nchannels));
    }
    if (layout.format == LutFormat::strip && spec["ImageDescription"].get() == kGreenUp)
        layout.format = LutFormat::strip_up;
    Lut lut;
    lut.size = layout.n;
    lut.values.resize(3 * static_cast<std::size_t>(spec.width) *
                      static_cast<std::size_t>(spec.height));
    for (int y = 0; y < spec.height; ++y) {
        for (int x = 0; x < spec.width; ++x) {
            std::array<float, 4> pixel = {0, 0, 0, 1};
            picture.getpixel(spec.x + x, spec.y + y, pixel.data(), spec.nchannels);
            if (pixel[3] != 1) {
                throw FileError(fmt::format("read: {}: pixel {}, {} has alpha {}; expected 1", path,
                                            x, y, pixel[3]));
            }
            for (std::size_t c = 0; c < 3; ++c) {
                if (!std::isfinite(pixel[c])) {
                    throw FileError(
                        fmt::format("read: {}: pixel {}, {} is {}; expected finite numbers", path,
                                    x, y, pixel[c]));
                }
            }
            std::copy_n(
                pixel.begin(), 3,
                lut.values.begin() + static_cast<std::ptrdiff_t>(
                                         3 * node_of(layout.format, layout.n, spec.width, x, y)));
        }
    }
    return lut;
}

OIIO::ImageBuf make_lut_picture(const Lut& lut, LutFormat format) {
    if (!is_picture_format(format))
        throw Error({.parameter = "format", .value = name_of(format), .expected = "a picture"});
    const int n = lut.size;
    const int level = static_cast<int>(std::lround(std::sqrt(n)));
    const int width = format == LutFormat::hald ? n * level : n * n;
    const int height = format == LutFormat::hald ? n * level : n;
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::FLOAT);
    // Numbers, not light, so that no program converts them.
    spec.attribute("oiio:ColorSpace", "Raw");
    if (format == LutFormat::strip_up) spec.attribute("ImageDescription", kGreenUp);
    OIIO::ImageBuf picture(spec);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            picture.setpixel(x, y, &lut.values[3 * node_of(format, n, width, x, y)]);
        }
    }
    return picture;
}

TableReader picture_table_reader(TableReader next) {
    return [next = std::move(next)](const std::string& path) {
        if (!is_lut_picture(path) && next) return next(path);
        return table_file_of(read_lut_picture(path), path);
    };
}

TONEWRIGHT_NAMESPACE_END
