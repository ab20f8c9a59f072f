// SPDX-License-Identifier: Apache-2.0
//
// Contact sheets: small pictures side by side with their names.
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagebufalgo_util.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "image/canvas.h"
#include "image/message.h"
#include "tonewright/color.h"
#include "tonewright/engine.h"
#include "tonewright/image.h"

namespace tonewright {
namespace {

using OIIO::ImageBuf;
using OIIO::ROI;

// sRGB code values. Neutral, and dark enough not to light up the pictures.
constexpr double kBackground = 0.125;
constexpr double kText = 0.82;

struct Size {
    int width;
    int height;
};

/// The display window: what a viewer shows. Pixels outside the data window are black.
ROI shown_window(const ImageBuf& picture) {
    ROI window = picture.roi_full();
    window.chbegin = 0;
    window.chend = picture.nchannels();
    return window;
}

/// The largest size that fits the width, with the picture's shape.
Size fitted_size(const ImageBuf& picture, int cell_width) {
    const ROI window = shown_window(picture);
    const double pixel_aspect =
        static_cast<double>(picture.spec().get_float_attribute("PixelAspectRatio", 1));
    const double aspect =
        window.width() * (pixel_aspect > 0 ? pixel_aspect : 1.0) / window.height();
    return {cell_width, std::max(1, static_cast<int>(std::lround(cell_width / aspect)))};
}

/// The picture at its size in the sheet, sRGB code values, float RGB.
///
/// Averages of light are wanted, not of code values: else thin bright lines and fine patterns
/// become darker when the picture shrinks.
ImageBuf shrink(const ImageBuf& picture, const Size& size) {
    static const Expr x = Expr::input();
    static const ReferenceEngine to_light({curve_stage(srgb_decode(x))});
    static const ReferenceEngine to_code({curve_stage(srgb_encode(x))});

    const ROI window = shown_window(picture);
    ImageBuf light(OIIO::ImageSpec(window.width(), window.height(), 3, OIIO::TypeDesc::FLOAT));
    const auto run = [](const ReferenceEngine& engine, float* pixels, int count) {
        std::vector<double> result(3 * static_cast<std::size_t>(count));
        engine.run_rgb(pixels, result.data(), static_cast<std::size_t>(count));
        std::transform(result.begin(), result.end(), pixels,
                       [](double v) { return static_cast<float>(v); });
    };
    const int channels = picture.nchannels();
    OIIO::ImageBufAlgo::parallel_image(light.roi(), [&](ROI part) {
        std::vector<float> row(static_cast<std::size_t>(window.width()) *
                               static_cast<std::size_t>(channels));
        for (int y = part.ybegin; y < part.yend; ++y) {
            ROI line = window;
            line.ybegin = window.ybegin + y;
            line.yend = line.ybegin + 1;
            line.zend = line.zbegin + 1;
            picture.get_pixels(line, OIIO::TypeFloat, row.data());
            auto* to = static_cast<float*>(light.pixeladdr(0, y));
            for (int i = 0; i < window.width(); ++i) {
                const float* from = row.data() + static_cast<std::ptrdiff_t>(i) * channels;
                for (int c = 0; c < 3; ++c)
                    to[3 * i + c] = from[channels < 3 ? 0 : c];
            }
            run(to_light, to, window.width());
        }
    });
    if (picture.has_error()) throw Error("contact sheet: " + first_line(picture.geterror()));

    ImageBuf small = light;
    if (size.width != window.width() || size.height != window.height()) {
        // A filter without negative lobes: no dark rims around lights.
        small = OIIO::ImageBufAlgo::resize(light, "blackman-harris", 0,
                                           ROI(0, size.width, 0, size.height, 0, 1, 0, 3));
        if (small.has_error()) throw Error("contact sheet: " + first_line(small.geterror()));
    }
    run(to_code, static_cast<float*>(small.localpixels()), size.width * size.height);
    return small;
}

void check_range(const char* name, int value, int low, int high) {
    if (value >= low && value <= high) return;
    throw Error(fmt::format("contact sheet: {} is {}; expected [{}, {}]", name, value, low, high));
}

}  // namespace

ImageBuf make_contact_sheet(const std::vector<std::pair<std::string, ImageBuf>>& labelled,
                            int columns, int cell_width) {
    check_range("number of pictures", static_cast<int>(labelled.size()), 1, 10000);
    check_range("columns", columns, 1, 10000);
    check_range("cell width", cell_width, 16, 16384);
    columns = std::min(columns, static_cast<int>(labelled.size()));

    std::vector<Size> sizes;
    for (const auto& [label, picture] : labelled) {
        if (!picture.initialized() || picture.deep()) {
            throw Error(fmt::format("contact sheet: picture of {} is {}; expected flat pixels",
                                    label, picture.deep() ? "deep" : "missing"));
        }
        sizes.push_back(fitted_size(picture, cell_width));
    }
    const double cap_height = std::clamp(cell_width / 32.0, 7.0, 20.0);
    const int margin = std::max(4, static_cast<int>(std::lround(cell_width / 20.0)));
    const int label_height = static_cast<int>(std::lround(2.2 * cap_height));

    // Each row is as high as its tallest picture.
    const int rows = (static_cast<int>(labelled.size()) + columns - 1) / columns;
    std::vector<int> row_top;
    std::vector<int> row_height;
    int height = margin;
    for (int r = 0; r < rows; ++r) {
        int tallest = 1;
        const int end = std::min((r + 1) * columns, static_cast<int>(sizes.size()));
        for (int i = r * columns; i < end; ++i) {
            tallest = std::max(tallest, sizes[static_cast<std::size_t>(i)].height);
        }
        row_top.push_back(height);
        row_height.push_back(tallest);
        height += tallest + label_height + margin;
    }
    const int width = margin + columns * (cell_width + margin);
    constexpr int kLargest = 65535;
    if (width > kLargest || height > kLargest) {
        throw Error(fmt::format("contact sheet: size is {} x {}; expected at most {} each way",
                                width, height, kLargest));
    }

    Canvas canvas(width, height, grey_of(kBackground));
    for (std::size_t i = 0; i < labelled.size(); ++i) {
        const auto r = i / static_cast<std::size_t>(columns);
        const int left = margin + static_cast<int>(i % static_cast<std::size_t>(columns)) *
                                      (cell_width + margin);
        const Size& size = sizes[i];
        const int top = row_top[r] + (row_height[r] - size.height) / 2;
        const ImageBuf small = shrink(labelled[i].second, size);
        const auto* pixels = static_cast<const float*>(small.localpixels());
        canvas.paint(left, top, left + size.width, top + size.height, [&](double, double) {
            const Rgb color = {pixels[0], pixels[1], pixels[2]};  // row by row, as they come
            pixels += 3;
            return color;
        });
        const double baseline = row_top[r] + row_height[r] + 0.45 * label_height + cap_height / 2;
        canvas.text(fit_text(labelled[i].first, cap_height, cell_width), left + cell_width / 2.0,
                    baseline, cap_height, grey_of(kText), Canvas::Align::center);
    }
    ImageBuf sheet = canvas.to_image(OIIO::TypeDesc::UINT8);
    sheet.specmod().attribute("oiio:ColorSpace", "sRGB");
    return sheet;
}

}  // namespace tonewright
