// SPDX-License-Identifier: Apache-2.0
//
// Comparisons of pictures of the same scene: small scenes, splits, differences.
#include "image/comparison.h"

#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagebufalgo_util.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include "base/strings.h"
#include "image/canvas.h"
#include "image/contact_sheet.h"
#include "image/source_picture.h"
#include "image/spec_conversion.h"
#include "picture/picture_error.h"
#include "tonewright/engine.h"
#include "tonewright/error.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;

/// The color channels of a picture, and alpha after them.
std::vector<int> color_and_alpha(const ImageSpec& spec) {
    std::vector<int> channels(static_cast<std::size_t>(std::min(spec.nchannels, 4)));
    for (std::size_t c = 0; c < channels.size(); ++c)
        channels[c] = static_cast<int>(c);
    if (spec.nchannels <= 4) return channels;
    channels.resize(3);
    if (spec.alpha_channel >= 3) channels.push_back(spec.alpha_channel);
    return channels;
}

/// Part of the display window in memory, after the first step of the engines. The window begins at
/// 0, 0.
ImageBuf shown_scene(const ImageBuf& picture, const ROI& part) {
    const ROI window = shown_window(picture);
    const std::vector<int> channels = color_and_alpha(picture.spec());
    const auto count = static_cast<int>(channels.size());
    ImageSpec spec(part.width(), part.height(), count, OIIO::TypeDesc::FLOAT);
    spec.x = part.xbegin - window.xbegin;
    spec.y = part.ybegin - window.ybegin;
    spec.full_width = window.width();
    spec.full_height = window.height();
    spec.extra_attribs = picture.spec().extra_attribs;
    erase_attribute(spec, "PixelAspectRatio");
    spec.alpha_channel = -1;
    for (int c = 0; c < count; ++c) {
        const int from = channels[static_cast<std::size_t>(c)];
        spec.channelnames[static_cast<std::size_t>(c)] = picture.spec().channel_name(from);
        if (from == picture.spec().alpha_channel) spec.alpha_channel = c;
    }
    ImageBuf scene = black_picture(spec);
    OIIO::ImageBufAlgo::parallel_image(scene.roi(), [&](ROI rows) {
        const auto all = static_cast<std::size_t>(picture.nchannels());
        std::vector<float> row(static_cast<std::size_t>(part.width()) * all);
        for (int y = rows.ybegin; y < rows.yend; ++y) {
            ROI line = part;
            line.ybegin = window.ybegin + y;
            line.yend = line.ybegin + 1;
            picture.get_pixels(line, OIIO::TypeFloat, row.data());
            auto* to = static_cast<float*>(scene.pixeladdr(spec.x, y));
            for (std::size_t x = 0; x < static_cast<std::size_t>(part.width()); ++x) {
                for (const int c : channels) {
                    // So large that the sums of the filter are finite.
                    constexpr float kMax = 0x1p100F;
                    const float value = row[x * all + static_cast<std::size_t>(c)];
                    *to++ = std::isinf(value)
                                ? static_cast<float>(sanitize(static_cast<double>(value)))
                                : std::clamp(std::isnan(value) ? 0 : value, -kMax, kMax);
                }
            }
        }
    });
    if (picture.has_error()) throw Error(problem_of_library(picture.geterror()));
    return scene;
}

/// The part of the window that has pixels, so that a small picture in a large window needs little
/// memory.
ImageBuf shrink(const ImageBuf& picture, const PictureSize& size) {
    const ROI window = shown_window(picture);
    ROI part = OIIO::roi_intersection(window, picture.roi());
    part.zend = part.zbegin + 1;
    const bool is_empty = part.width() <= 0 || part.height() <= 0;
    if (is_empty) {
        part = window;
        part.xend = part.xbegin + 1;
        part.yend = part.ybegin + 1;
    }
    const ImageBuf scene = shown_scene(picture, part);
    ImageSpec spec = scene.spec();
    spec.x = spec.y = 0;
    spec.width = spec.full_width = size.width;
    spec.height = spec.full_height = size.height;
    ImageBuf small = black_picture(spec);
    if (is_empty) return small;
    // The pixels that the filter, three pixels of the result wide, needs for the part.
    const auto reach = [](int from, int to, int window_length, int length) {
        const double scale = static_cast<double>(length) / window_length;
        return std::pair(std::max(static_cast<int>(std::floor(from * scale)) - 2, 0),
                         std::min(static_cast<int>(std::ceil(to * scale)) + 2, length));
    };
    const ROI from = scene.roi();
    const auto [left, right] = reach(from.xbegin, from.xend, window.width(), size.width);
    const auto [top, bottom] = reach(from.ybegin, from.yend, window.height(), size.height);
    // For a whole picture, the filter reads each pixel nine times. For a few pixels of a large
    // window, it would read black for minutes.
    const double taps = 9.0 * (right - left) * (bottom - top) * window.width() / size.width *
                        window.height() / size.height;
    if (taps > 2e8 + 40 * static_cast<double>(from.npixels())) {
        throw PictureError(
            fmt::format("the display window is {} x {} pixels, the data window {} x {}; expected "
                        "smaller windows",
                        window.width(), window.height(), from.width(), from.height()));
    }
    filter_down(small, scene, ROI(left, right, top, bottom, 0, 1, 0, spec.nchannels));
    if (small.has_error()) throw Error(problem_of_library(small.geterror()));
    return small;
}

/// Repeats every pixel as often as it fits.
ImageBuf enlarge(const ImageBuf& scene, const PictureSize& size) {
    ImageSpec spec = scene.spec();
    spec.width = spec.full_width = size.width;
    spec.height = spec.full_height = size.height;
    ImageBuf large = black_picture(spec);
    const auto bytes = static_cast<std::size_t>(spec.nchannels) * sizeof(float);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            const void* from =
                scene.pixeladdr(static_cast<int>((x + 0.5) * scene.spec().width / size.width),
                                static_cast<int>((y + 0.5) * scene.spec().height / size.height));
            std::copy_n(static_cast<const char*>(from), bytes,
                        static_cast<char*>(large.pixeladdr(x, y)));
        }
    }
    return large;
}

void require_same_size(const ImageBuf& a, const ImageBuf& b) {
    const ROI x = shown_window(a);
    const ROI y = shown_window(b);
    if (x.width() == y.width() && x.height() == y.height()) return;
    throw Error(Problem{.value = fmt::format("picture is {} x {}", y.width(), y.height()),
                        .expected = fmt::format("{} x {}, as the first", x.width(), x.height())});
}

std::span<const Rgb> pixels_of(const ImageBuf& rgb) {
    return {static_cast<const Rgb*>(rgb.localpixels()),
            static_cast<std::size_t>(rgb.spec().image_pixels())};
}

/// Title and detail of a side, and their size.
struct Caption {
    const SplitLabel& label;
    double cap;
    double room;

    [[nodiscard]] double width() const {
        return std::max(text_width(title(), cap), text_width(detail(), detail_cap()));
    }
    void draw(Canvas& canvas, double x, double top, Canvas::Align align) const {
        canvas.text(title(), x, top + 1.9 * cap, cap, gray_of(kSheetText), align);
        canvas.text(detail(), x, top + 1.9 * cap + 1.8 * detail_cap(), detail_cap(),
                    gray_of(kSheetDimText), align);
    }
    [[nodiscard]] double detail_cap() const { return std::max(7.0, 0.8 * cap); }

  private:
    [[nodiscard]] std::string title() const { return fit_text(label.title, cap, room); }
    [[nodiscard]] std::string detail() const { return fit_text(label.detail, detail_cap(), room); }
};

}  // namespace

ImageBuf resize_scene(const ImageBuf& picture, int width) {
    if (picture.deep()) throw Error(Problem{.value = "picture is deep", .expected = "flat pixels"});
    const PictureSize size = fitted_size(picture, width);
    const ROI window = shown_window(picture);
    if (size.height > kLargestSheet) {
        throw PictureError(
            fmt::format("a picture of {} x {} pixels, {} wide, is {} high; expected at most {}",
                        window.width(), window.height(), size.width, size.height, kLargestSheet));
    }
    if (size.width < window.width()) return shrink(picture, size);
    ImageBuf scene = shown_scene(picture, window);
    if (size.width == window.width() && size.height == window.height()) return scene;
    if (size.width > window.width()) return enlarge(scene, size);
    ImageBuf small = filtered_down(scene, size);
    if (small.has_error()) throw Error(problem_of_library(small.geterror()));
    return small;
}

int choose_columns(int count, int cell_width, int cell_height) {
    constexpr double kScreen = 16.0 / 10;
    const double width = 1.05 * cell_width;  // with margins, and a label
    const double height = cell_height + 0.16 * cell_width;
    int best = 1;
    double least = 1e9;
    for (int columns = 1; columns <= count; ++columns) {
        const int rows = (count + columns - 1) / columns;
        const double aspect = columns * width / (rows * height);
        const double gaps = static_cast<double>(columns * rows - count) / count;
        const double badness = std::fabs(std::log(aspect / kScreen)) + 2 * gaps;
        if (badness < least) {
            least = badness;
            best = columns;
        }
    }
    return best;
}

int split_at(int length, double position) {
    if (!(position >= 0 && position <= 1))
        throw Error(
            {.parameter = "split", .value = fmt::to_string(position), .expected = "[0, 1]"});
    return static_cast<int>(std::lround(position * length));
}

ImageBuf make_split(const ImageBuf& before, const ImageBuf& after, const SplitOptions& options) {
    require_same_size(before, after);
    const ImageBuf a = shown_rgb(before);
    const ImageBuf b = shown_rgb(after);
    const int width = a.spec().width;
    const int height = a.spec().height;
    const bool is_horizontal = options.is_horizontal;
    const int edge = split_at(is_horizontal ? height : width, options.position);

    constexpr int kNarrowest = 320;  // for the words
    const double cap = std::clamp(width / 72.0, 9.0, 26.0);
    const int band = options.has_labels ? static_cast<int>(std::lround(4.6 * cap)) : 0;
    const int top = is_horizontal ? band : 0;
    const int full_width = options.has_labels ? std::max(width, kNarrowest) : width;
    const int left = (full_width - width) / 2;
    Canvas canvas(full_width, top + height + band, gray_of(kSheetBackground));

    const std::span<const Rgb> first = pixels_of(a);
    const std::span<const Rgb> second = pixels_of(b);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                           static_cast<std::size_t>(x);
            canvas.at(left + x, top + y) = (is_horizontal ? y : x) < edge ? first[i] : second[i];
        }
    }
    if (options.has_labels) {
        // A light line between dark edges, visible on everything. None if only one picture is
        // shown.
        const int thickness =
            std::max(1, static_cast<int>(std::lround(std::min(width, height) / 700.0)));
        if (edge > 0 && edge < (is_horizontal ? height : width)) {
            const auto bar = [&](int from, int to, double gray) {
                if (is_horizontal) {
                    canvas.fill(left, top + std::max(from, 0), left + width,
                                top + std::min(to, height), gray_of(gray));
                } else {
                    canvas.fill(left + std::max(from, 0), top, left + std::min(to, width),
                                top + height, gray_of(gray));
                }
            };
            const int from = edge - (3 * thickness) / 2;
            bar(from, from + 3 * thickness, 0.05);
            bar(from + thickness, from + 2 * thickness, 0.95);
        }
        const double room = is_horizontal ? full_width - 2 * cap : full_width / 2.0 - 2 * cap;
        const Caption one = {options.before, cap, room};
        const Caption two = {options.after, cap, room};
        const double below = top + height;
        const double right = full_width - cap;
        one.draw(canvas, cap, is_horizontal ? 0 : below, Canvas::Align::left);
        two.draw(canvas, is_horizontal ? cap : right, below,
                 is_horizontal ? Canvas::Align::left : Canvas::Align::right);
        const double remark_cap = one.detail_cap();
        const double remark_width = text_width(options.remark, remark_cap);
        if (is_horizontal) {
            if (cap + one.width() + 2 * cap + remark_width < right) {
                canvas.text(options.remark, right, 1.9 * cap, remark_cap, gray_of(kSheetDimText),
                            Canvas::Align::right);
            }
        } else if (std::max(one.width(), two.width()) + 3 * cap + remark_width / 2 <
                   full_width / 2.0) {
            canvas.text(options.remark, full_width / 2.0, below + 1.9 * cap, remark_cap,
                        gray_of(kSheetDimText), Canvas::Align::center);
        }
    }
    ImageBuf split = canvas.to_image(OIIO::TypeDesc::FLOAT);
    split.specmod().attribute("oiio:ColorSpace", "sRGB");
    return split;
}

PictureDifference difference_of(const ImageBuf& a, const ImageBuf& b, double gain) {
    require_same_size(a, b);
    const ImageBuf x = shown_rgb(a);
    const ImageBuf y = shown_rgb(b);
    PictureDifference result;
    result.picture = black_picture(x.spec());
    const std::span<const Rgb> first = pixels_of(x);
    const std::span<const Rgb> second = pixels_of(y);
    auto* to = static_cast<Rgb*>(result.picture.localpixels());
    double sum = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double difference =
                std::fabs(static_cast<double>(first[i][c]) - static_cast<double>(second[i][c]));
            result.largest = std::max(result.largest, difference);
            sum += difference;
            to[i][c] = static_cast<float>(std::min(gain * difference, 1.0));
        }
    }
    result.mean = sum / (3 * static_cast<double>(first.size()));
    return result;
}

TONEWRIGHT_NAMESPACE_END
