// SPDX-License-Identifier: Apache-2.0
//
// Contact sheets: small pictures side by side with their names.
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagebufalgo_util.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/strings.h"
#include "image/canvas.h"
#include "image/contact_sheet.h"
#include "image/source_picture.h"
#include "tonewright/color.h"
#include "tonewright/contact_sheet.h"
#include "tonewright/engine.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ROI;

void check_range(const char* name, int value, int low, int high) {
    if (value >= low && value <= high) return;
    throw Error(fmt::format("contact sheet: {} is {}; expected [{}, {}]", name, value, low, high));
}

/// One run over pixels of interleaved RGB, in place.
void run_in_place(const ReferenceEngine& engine, float* pixels, int count) {
    std::vector<double> result(3 * static_cast<std::size_t>(count));
    engine.run_rgb(pixels, result.data(), static_cast<std::size_t>(count));
    std::transform(result.begin(), result.end(), pixels,
                   [](double v) { return static_cast<float>(v); });
}

/// The picture at its size in the sheet, sRGB code values, float RGB.
///
/// It averages light, not code values, because thin bright lines and fine patterns would otherwise
/// become darker.
ImageBuf shrink(const ImageBuf& picture, const PictureSize& size) {
    static const Expr x = Expr::input();
    static const ReferenceEngine to_light({curve_stage(srgb_decode(x))});
    static const ReferenceEngine to_code({curve_stage(srgb_encode(x))});

    ImageBuf light = shown_rgb(picture);
    const int width = light.spec().width;
    if (size.width == width && size.height == light.spec().height) return light;
    OIIO::ImageBufAlgo::parallel_image(light.roi(), [&](ROI part) {
        for (int y = part.ybegin; y < part.yend; ++y)
            run_in_place(to_light, static_cast<float*>(light.pixeladdr(0, y)), width);
    });
    ImageBuf small = filtered_down(light, size);
    if (small.has_error()) throw Error("contact sheet: " + first_line(small.geterror()));
    run_in_place(to_code, static_cast<float*>(small.localpixels()), size.width * size.height);
    return small;
}

/// Texts above the sheet, patches below it.
class Surround {
  public:
    Surround(const SheetAnnotations& words, int cell_width, int margin, int width)
        : words_(words),
          margin_(margin),
          width_(width - 2 * margin),
          heading_height_(std::clamp(cell_width / 26.0, 8.0, 22.0)),
          remark_height_(std::max(7.0, 0.8 * heading_height_)) {
        is_remark_below_ = text_width(words.heading, heading_height_) +
                               text_width(words.remark, remark_height_) + 2 * heading_height_ >
                           width_;
    }
    [[nodiscard]] int top() const {
        if (words_.heading.empty() && words_.remark.empty()) return 0;
        const double rows = heading_height_ + (is_remark_below_ ? 1.8 * remark_height_ : 0);
        return static_cast<int>(std::lround(rows + 0.4 * heading_height_)) + margin_ / 2;
    }
    [[nodiscard]] int bottom() const {
        if (words_.legend.empty()) return 0;
        return static_cast<int>(std::lround(7.2 * remark_height_)) + margin_ / 2;
    }
    void draw(Canvas& canvas) const {
        draw_heading(canvas);
        if (!words_.legend.empty()) draw_legend(canvas);
    }

  private:
    void draw_heading(Canvas& canvas) const {
        const double baseline = margin_ + heading_height_;
        canvas.text(fit_text(words_.heading, heading_height_, width_), margin_, baseline,
                    heading_height_, gray_of(kSheetText));
        canvas.text(fit_text(words_.remark, remark_height_, width_),
                    is_remark_below_ ? margin_ : margin_ + width_,
                    is_remark_below_ ? baseline + 1.8 * remark_height_ : baseline, remark_height_,
                    gray_of(kSheetDimText),
                    is_remark_below_ ? Canvas::Align::left : Canvas::Align::right);
    }
    void draw_legend(Canvas& canvas) const {
        const double cap = remark_height_;
        const int end = canvas.height() - margin_;
        const double labels = end - 0.2 * cap;
        const int patches_end = static_cast<int>(std::lround(labels - 1.7 * cap));
        const int patches_top = static_cast<int>(std::lround(patches_end - 2.2 * cap));
        canvas.text(fit_text(words_.legend_heading, cap, width_), margin_, patches_top - 0.8 * cap,
                    cap, gray_of(kSheetDimText));
        const auto count = static_cast<int>(words_.legend.size());
        // All labels get the width of the widest; if they do not fit, only every second or third is
        // drawn.
        double widest = 0;
        for (const auto& [label, color] : words_.legend)
            widest = std::max(widest, text_width(label, cap) + cap);
        const int step = std::max(
            1, static_cast<int>(std::ceil(widest / (width_ / static_cast<double>(count)))));
        for (int i = 0; i < count; ++i) {
            const auto& [label, color] = words_.legend[static_cast<std::size_t>(i)];
            const int left = margin_ + i * width_ / count;
            const int right = margin_ + (i + 1) * width_ / count;
            canvas.fill(left, patches_top, right, patches_end, color);
            if ((i - count / 2) % step == 0) {
                canvas.text(label, (left + right) / 2.0, labels, cap, gray_of(kSheetText),
                            Canvas::Align::center);
            }
        }
    }

    const SheetAnnotations& words_;
    int margin_;
    int width_;
    double heading_height_;
    double remark_height_;
    bool is_remark_below_;
};

}  // namespace

ROI shown_window(const ImageBuf& picture) {
    ROI window = picture.roi_full();
    window.zend = window.zbegin + 1;
    window.chbegin = 0;
    window.chend = picture.nchannels();
    return window;
}

PictureSize fitted_size(const ImageBuf& picture, int width) {
    const ROI window = shown_window(picture);
    const double pixel_aspect =
        static_cast<double>(picture.spec().get_float_attribute("PixelAspectRatio", 1));
    const double aspect =
        window.width() * (pixel_aspect > 0 ? pixel_aspect : 1.0) / window.height();
    constexpr double kMost = 1e6;  // more than any sheet has; sums of 10,000 do not overflow
    const double height = std::clamp(width / aspect, 1.0, kMost);
    return {width, static_cast<int>(std::lround(height))};
}

void check_shown_window(const ImageBuf& picture) {
    const ROI window = shown_window(picture);
    const double most =
        std::max(WriteOptions{}.max_pixels, 4 * static_cast<double>(picture.roi().npixels()));
    if (static_cast<double>(window.npixels()) > most) {
        throw PictureError(fmt::format(
            "the display window is {} x {} pixels, the data window {} x {}; expected at most "
            "{:.0f} "
            "pixels of both",
            window.width(), window.height(), picture.spec().width, picture.spec().height, most));
    }
}

ImageBuf shown_rgb(const ImageBuf& picture) {
    check_shown_window(picture);
    const ROI window = shown_window(picture);
    const int channels = picture.nchannels();
    ImageBuf rgb =
        black_picture(OIIO::ImageSpec(window.width(), window.height(), 3, OIIO::TypeDesc::FLOAT));
    OIIO::ImageBufAlgo::parallel_image(rgb.roi(), [&](ROI part) {
        std::vector<float> row(static_cast<std::size_t>(window.width()) *
                               static_cast<std::size_t>(channels));
        for (int y = part.ybegin; y < part.yend; ++y) {
            ROI line = window;
            line.ybegin = window.ybegin + y;
            line.yend = line.ybegin + 1;
            picture.get_pixels(line, OIIO::TypeFloat, row.data());
            auto* to = static_cast<float*>(rgb.pixeladdr(0, y));
            for (int i = 0; i < window.width(); ++i) {
                const float* from = row.data() + static_cast<std::ptrdiff_t>(i) * channels;
                for (int c = 0; c < 3; ++c)
                    to[3 * i + c] = from[channels < 3 ? 0 : c];
            }
        }
    });
    if (picture.has_error()) throw Error("contact sheet: " + first_line(picture.geterror()));
    return rgb;
}

void filter_down(ImageBuf& small, const ImageBuf& picture, const ROI& roi) {
#if OIIO_VERSION >= 30000  // where the other form is deprecated
    OIIO::ImageBufAlgo::resize(small, picture, {{"filtername", "blackman-harris"}}, roi);
#else
    OIIO::ImageBufAlgo::resize(small, picture, "blackman-harris", 0, roi);
#endif
}

ImageBuf filtered_down(const ImageBuf& picture, const PictureSize& size) {
    const ROI roi(0, size.width, 0, size.height, 0, 1, 0, picture.nchannels());
#if OIIO_VERSION >= 30000  // where the other form is deprecated
    return OIIO::ImageBufAlgo::resize(picture, {{"filtername", "blackman-harris"}}, roi);
#else
    return OIIO::ImageBufAlgo::resize(picture, "blackman-harris", 0, roi);
#endif
}

ImageBuf make_contact_sheet(const std::vector<std::pair<std::string, ImageBuf>>& labeled,
                            int columns, int cell_width, const SheetAnnotations& around) {
    check_range("number of pictures", static_cast<int>(labeled.size()), 1, 10000);
    check_range("columns", columns, 1, 10000);
    check_range("cell width", cell_width, 16, 16384);
    columns = std::min(columns, static_cast<int>(labeled.size()));

    std::vector<PictureSize> sizes;
    for (const auto& [label, picture] : labeled) {
        if (!picture.initialized() || picture.deep()) {
            throw Error(fmt::format("contact sheet: picture of {} is {}; expected flat pixels",
                                    label, picture.deep() ? "deep" : "missing"));
        }
        sizes.push_back(fitted_size(picture, cell_width));
    }
    const double cap_height = std::clamp(cell_width / 32.0, 7.0, 20.0);
    const int margin = std::max(4, static_cast<int>(std::lround(cell_width / 20.0)));
    const double second_height = std::max(7.0, 0.8 * cap_height);
    const bool has_second = std::any_of(labeled.begin(), labeled.end(), [](const auto& cell) {
        return cell.first.find('\n') != std::string::npos;
    });
    const int first_height = static_cast<int>(std::lround(2.2 * cap_height));
    const int label_height =
        first_height + (has_second ? static_cast<int>(std::lround(1.8 * second_height)) : 0);
    const int width = margin + columns * (cell_width + margin);
    const Surround surround(around, cell_width, margin, width);

    // Each row is as high as its tallest picture.
    const int rows = (static_cast<int>(labeled.size()) + columns - 1) / columns;
    std::vector<int> row_top;
    std::vector<int> row_height;
    int height = margin + surround.top();
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
    height += surround.bottom();
    constexpr int kLargest = kLargestSheet;
    if (width > kLargest || height > kLargest) {
        throw Error(fmt::format("contact sheet: size is {} x {}; expected at most {} each way",
                                width, height, kLargest));
    }

    Canvas canvas(width, height, gray_of(kSheetBackground));
    for (std::size_t i = 0; i < labeled.size(); ++i) {
        const auto r = i / static_cast<std::size_t>(columns);
        const int left = margin + static_cast<int>(i % static_cast<std::size_t>(columns)) *
                                      (cell_width + margin);
        const PictureSize& size = sizes[i];
        const int top = row_top[r] + (row_height[r] - size.height) / 2;
        const ImageBuf small = shrink(labeled[i].second, size);
        const auto* pixels = static_cast<const float*>(small.localpixels());
        canvas.paint(left, top, left + size.width, top + size.height, [&](double, double) {
            const Rgb color = {pixels[0], pixels[1], pixels[2]};  // row by row, as they come
            pixels += 3;
            return color;
        });
        const double baseline = row_top[r] + row_height[r] + 0.45 * first_height + cap_height / 2;
        const std::string& label = labeled[i].first;
        const std::size_t line_break = std::min(label.find('\n'), label.size());
        canvas.text(fit_text(label.substr(0, line_break), cap_height, cell_width),
                    left + cell_width / 2.0, baseline, cap_height, gray_of(kSheetText),
                    Canvas::Align::center);
        if (line_break < label.size()) {
            canvas.text(fit_text(label.substr(line_break + 1), second_height, cell_width),
                        left + cell_width / 2.0, baseline + 1.8 * second_height, second_height,
                        gray_of(kSheetDimText), Canvas::Align::center);
        }
    }
    surround.draw(canvas);
    ImageBuf sheet = canvas.to_image(OIIO::TypeDesc::UINT8);
    sheet.specmod().attribute("oiio:ColorSpace", "sRGB");
    return sheet;
}

TONEWRIGHT_NAMESPACE_END
