// SPDX-License-Identifier: Apache-2.0
#include "image/resize.h"

#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagebufalgo_util.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <exception>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "base/strings.h"
#include "image/source_picture.h"
#include "image/spec_conversion.h"
#include "picture/color_tags.h"
#include "picture/header_tags.h"
#include "picture/picture_description.h"
#include "picture/source_pixels.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;

/// Half the width of the filter, in pixels of the smaller picture. @see OIIO::Filter2D
constexpr int kRadius = 3;
constexpr const char* kFilter = "lanczos3";
constexpr const char* kFilterOfLamps = "triangle";

[[noreturn]] void refuse_text(std::string_view text) {
    throw Error({.parameter = "resize",
                 .value = printable(text),
                 .expected = "WxH, W or P%, such as 1920x1080, 1920 or 50%"});
}

/// A whole number from 1 to the largest `int`.
int parse_side(std::string_view side, std::string_view text) {
    int number = 0;
    const char* const end = side.data() + side.size();
    const auto [stop, error] = std::from_chars(side.data(), end, number);
    if (error != std::errc() || stop != end || number < 1) refuse_text(text);
    return number;
}

/// The display window, or the data window of a picture that has no other.
ROI display_window(const ImageSpec& spec) {
    if (spec.full_width < 1 || spec.full_height < 1)
        return {spec.x, spec.x + spec.width, spec.y, spec.y + spec.height};
    return {spec.full_x, spec.full_x + spec.full_width, spec.full_y,
            spec.full_y + spec.full_height};
}

/// One axis of a picture.
struct Axis {
    int begin, end;            // of the display window
    int data_begin, data_end;  // of the data window
};
Axis axis_x(const ImageSpec& spec) {
    const ROI full = display_window(spec);
    return {full.xbegin, full.xend, spec.x, spec.x + spec.width};
}
Axis axis_y(const ImageSpec& spec) {
    const ROI full = display_window(spec);
    return {full.ybegin, full.yend, spec.y, spec.y + spec.height};
}

/// Pixels of the source that the filter takes on either side.
int reach_of(double factor) {
    return static_cast<int>(std::ceil(kRadius * std::max(1.0, 1 / factor))) + 1;
}

/// Extends the data window if it ends inside of the display window: the picture goes on in black
/// there, and the filter takes some of it.
Axis with_black(const Axis& axis, double factor) {
    const int reach = reach_of(factor);
    Axis wide = axis;
    wide.data_begin -= std::clamp(axis.data_begin - axis.begin, 0, reach);
    wide.data_end += std::clamp(axis.end - axis.data_end, 0, reach);
    return wide;
}

/// Elsewhere it repeats its last pixel. ImageBufAlgo::resize() does so at the edges of the display
/// window only, so overscan needs more pixels.
Axis with_margin(const Axis& axis, double factor) {
    const int reach = reach_of(factor);
    Axis wide = with_black(axis, factor);
    if (axis.data_begin < axis.begin) wide.data_begin -= reach;
    if (axis.data_end > axis.end) wide.data_end += reach;
    return wide;
}

/// @param size  of the new display window
Axis resized(const Axis& axis, int size) {
    constexpr double kRounding = 1e-6;  // of a pixel
    const double factor = static_cast<double>(size) / (axis.end - axis.begin);
    const Axis wide = with_black(axis, factor);
    const auto place = [&](int at) { return (static_cast<double>(at) - axis.begin) * factor; };
    constexpr double kFarthest = 1 << 30;
    for (const double at : {axis.begin * factor, place(wide.data_begin), place(wide.data_end)}) {
        if (!(std::fabs(at) < kFarthest)) {
            throw PictureError(
                fmt::format("the window would begin at {:.0f}; expected less than {:.0f} pixels "
                            "from 0",
                            at, kFarthest));
        }
    }
    const auto begin = static_cast<int>(std::lround(axis.begin * factor));
    return {begin, begin + size,
            begin + static_cast<int>(std::floor(place(wide.data_begin) + kRounding)),
            begin + static_cast<int>(std::ceil(place(wide.data_end) - kRounding))};
}

/// The pixels are not square, and the new ones have another shape.
void keep_shape(ImageSpec& spec, double factor_x, double factor_y) {
    const float aspect = spec.get_float_attribute("PixelAspectRatio", 1);
    if (!(aspect > 0) || aspect == 1) return;
    spec.attribute("PixelAspectRatio",
                   static_cast<float>(static_cast<double>(aspect) * factor_y / factor_x));
    // OpenImageIO's writers of JPEG and TIFF take the ratio of these two instead.
    for (const char* name : {"XResolution", "YResolution", "ResolutionUnit"})
        erase_attribute(spec, name);
}

bool is_straight(const ImageSpec& spec) {
    return spec.get_int_attribute("oiio:UnassociatedAlpha", 0) != 0;
}

float finite(float value) {
    if (std::isnan(value)) return 0;
    if (std::isinf(value)) return std::copysign(static_cast<float>(kHalfMax), value);
    return value;
}

/// Light of a picture, multiplied by alpha, row by row.
class LightRows {
  public:
    LightRows(const ImageBuf& picture, const SourceColor& color, const TonemapOptions& options)
        : picture_(picture),
          color_(color),
          layout_(channel_layout(picture_spec(picture.spec()))),
          has_alpha_(layout_.alpha >= 0),
          counts_(has_alpha_ && options.unpremult != TonemapOptions::Unpremult::no),
          is_straight_(is_straight(picture.spec()) &&
                       options.unpremult != TonemapOptions::Unpremult::yes),
          limit_(static_cast<float>(surface_limit(options.unpremult, options.exposure_stops))) {
        if (!color.decode.empty()) engine_.emplace(color.decode);
    }

    [[nodiscard]] int colors() const { return layout_.is_gray ? 1 : 3; }
    [[nodiscard]] int channels() const { return colors() + (has_alpha_ ? 1 : 0); }
    [[nodiscard]] int alpha() const { return layout_.alpha; }

    /// @param to  `channels()` numbers for each pixel of the row
    void read(int y, float* to) const {
        const ROI window = picture_.roi();
        const auto n = static_cast<std::size_t>(window.width());
        const auto all = static_cast<std::size_t>(picture_.nchannels());
        std::vector<float> row(n * all);
        std::vector<float> rgb(3 * n);
        std::vector<float> alpha(n, 1.0F);
        ROI line = window;
        line.ybegin = y;
        line.yend = y + 1;
        picture_.get_pixels(line, OIIO::TypeFloat, row.data());
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t c = 0; c < 3; ++c)
                rgb[3 * i + c] = row[i * all + (layout_.is_gray ? 0 : c)];
            if (has_alpha_) alpha[i] = row[i * all + static_cast<std::size_t>(layout_.alpha)];
        }
        decode(rgb.data(), alpha.data(), n);
        const auto width = static_cast<std::size_t>(channels());
        for (std::size_t i = 0; i < n; ++i) {
            const float a = std::isfinite(alpha[i]) ? alpha[i] : 0;
            const bool multiplies = counts_ && is_straight_;
            for (std::size_t c = 0; c < static_cast<std::size_t>(colors()); ++c) {
                const float light = finite(rgb[3 * i + (layout_.is_gray ? 1 : c)]);
                to[i * width + c] = multiplies ? light * a : light;
            }
            if (has_alpha_) to[i * width + width - 1] = a;
        }
    }

  private:
    void decode(float* rgb, const float* alpha, std::size_t n) const {
        if (!color_.convert && !engine_) return;
        const bool divides = counts_ && !is_straight_;
        std::vector<float> divisors(n, 1.0F);
        for (std::size_t i = 0; divides && i < n; ++i) {
            float* pixel = rgb + 3 * i;
            divisors[i] = divisor_of(alpha[i], largest_of(pixel[0], pixel[1], pixel[2]), limit_);
            for (std::size_t c = 0; c < 3; ++c)
                pixel[c] /= divisors[i];
        }
        if (color_.convert) color_.convert(rgb, rgb, n);
        if (engine_) engine_->run_rgb(rgb, rgb, n);
        for (std::size_t i = 0; divides && i < n; ++i) {
            for (std::size_t c = 0; c < 3; ++c)
                rgb[3 * i + c] *= divisors[i];
        }
    }

    const ImageBuf& picture_;
    const SourceColor& color_;
    ChannelLayout layout_;
    bool has_alpha_;
    bool counts_;
    bool is_straight_;
    float limit_;
    std::optional<SimdEngine> engine_;
};

/// ImageBufAlgo::parallel_image() for functions that may throw.
void for_rows(const ROI& rows, int nthreads, const std::function<void(int)>& row) {
    std::exception_ptr error;
    std::mutex mutex;
    OIIO::ImageBufAlgo::parallel_image(rows, OIIO::paropt(nthreads), [&](ROI part) {
        try {
            for (int y = part.ybegin; y < part.yend; ++y)
                row(y);
        } catch (...) {
            const std::lock_guard lock(mutex);
            error = std::current_exception();
        }
    });
    if (error) std::rethrow_exception(error);
}

/// parallel_image() divides the longest side; a row is one unit.
ROI rows_of(const ROI& window) { return {0, 1, window.ybegin, window.yend, 0, 1, 0, 1}; }

float* row_of(ImageBuf& picture, int y) {
    return static_cast<float*>(picture.pixeladdr(picture.xbegin(), y));
}

ImageSpec spec_of(const ROI& window, const ROI& full, int channels) {
    ImageSpec spec(window.width(), window.height(), channels, OIIO::TypeDesc::FLOAT);
    spec.x = window.xbegin;
    spec.y = window.ybegin;
    spec.full_x = full.xbegin;
    spec.full_y = full.ybegin;
    spec.full_width = full.width();
    spec.full_height = full.height();
    return spec;
}

/// Repeats the last pixels of overscan in the margin.
void repeat_edges(ImageBuf& light, const Axis& x, const Axis& y) {
    const auto channels = static_cast<std::size_t>(light.nchannels());
    const ROI all = light.roi();
    const auto pixel = [&](int at, int row) {
        return static_cast<float*>(light.pixeladdr(at, row));
    };
    for (int row = y.data_begin; row < y.data_end; ++row) {
        for (int at = all.xbegin; x.data_begin < x.begin && at < x.data_begin; ++at)
            std::copy_n(pixel(x.data_begin, row), channels, pixel(at, row));
        for (int at = x.data_end; x.data_end > x.end && at < all.xend; ++at)
            std::copy_n(pixel(x.data_end - 1, row), channels, pixel(at, row));
    }
    const std::size_t width = channels * static_cast<std::size_t>(all.width());
    for (int row = all.ybegin; y.data_begin < y.begin && row < y.data_begin; ++row)
        std::copy_n(pixel(all.xbegin, y.data_begin), width, pixel(all.xbegin, row));
    for (int row = y.data_end; y.data_end > y.end && row < all.yend; ++row)
        std::copy_n(pixel(all.xbegin, y.data_end - 1), width, pixel(all.xbegin, row));
}

/// Light of a picture, with the pixels around it that the filter takes.
ImageBuf light_of(const ImageBuf& picture, const LightRows& rows, const ImageSpec& target,
                  int nthreads) {
    const ImageSpec& spec = picture.spec();
    const ROI full = display_window(spec);
    const ROI to = display_window(target);
    const Axis x = with_margin(axis_x(spec), static_cast<double>(to.width()) / full.width());
    const Axis y = with_margin(axis_y(spec), static_cast<double>(to.height()) / full.height());
    ImageBuf light = black_picture(
        spec_of(ROI(x.data_begin, x.data_end, y.data_begin, y.data_end), full, rows.channels()));
    for_rows(rows_of(picture.roi()), nthreads,
             [&](int row) { rows.read(row, static_cast<float*>(light.pixeladdr(spec.x, row))); });
    repeat_edges(light, axis_x(spec), axis_y(spec));
    return light;
}

/// Moves what exceeds `white` to another picture; none if nothing does.
std::optional<ImageBuf> take_lamps(ImageBuf& light, int colors, float white, int nthreads) {
    const auto channels = static_cast<std::size_t>(light.nchannels());
    const std::size_t n = static_cast<std::size_t>(light.roi().width());
    std::atomic<bool> has_lamps = false;
    for_rows(rows_of(light.roi()), nthreads, [&](int y) {
        const float* row = row_of(light, y);
        for (std::size_t i = 0; i < n * channels && !has_lamps; ++i) {
            if (static_cast<int>(i % channels) < colors && row[i] > white) has_lamps = true;
        }
    });
    if (!has_lamps) return {};
    ImageBuf lamps = black_picture(spec_of(light.roi(), light.roi_full(), colors));
    for_rows(rows_of(light.roi()), nthreads, [&](int y) {
        float* from = row_of(light, y);
        float* to = row_of(lamps, y);
        const auto count = static_cast<std::size_t>(colors);
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t c = 0; c < count; ++c) {
                float& value = from[i * channels + c];
                to[i * count + c] = std::max(value - white, 0.0F);
                value = std::min(value, white);
            }
        }
    });
    return lamps;
}

ImageBuf filtered(const ImageBuf& picture, const char* filter, const ImageSpec& target,
                  int nthreads) {
    ImageBuf result = black_picture(
        spec_of(ROI(target.x, target.x + target.width, target.y, target.y + target.height),
                display_window(target), picture.nchannels()));
#if OIIO_VERSION >= 30000  // where the other form is deprecated
    const bool is_done = OIIO::ImageBufAlgo::resize(result, picture, {{"filtername", filter}},
                                                    result.roi(), nthreads);
#else
    const bool is_done =
        OIIO::ImageBufAlgo::resize(result, picture, filter, 0, result.roi(), nthreads);
#endif
    if (!is_done) throw PictureError("resize: " + first_line(result.geterror()));
    return result;
}

/// Lanczos gives alpha below 0 and above 1 at the edges of opaque things. Where it exceeds 1, color
/// is scaled with it. Where it is below 0, only emission is left.
void limit_alpha(float* pixel, int colors, float most) {
    float& alpha = pixel[colors];
    if (alpha > most) {
        for (int c = 0; c < colors; ++c)
            pixel[c] *= most / alpha;
        alpha = most;
    } else if (alpha < 0) {
        for (int c = 0; c < colors; ++c)
            pixel[c] = std::max(pixel[c], 0.0F);
        alpha = 0;
    }
}

/// Smallest and largest alpha.
std::pair<float, float> alpha_range(const ImageBuf& light, int alpha) {
    std::pair<float, float> range = {0, 1};
    for (OIIO::ImageBuf::ConstIterator<float> p(light); !p.done(); ++p) {
        range.first = std::min(range.first, static_cast<float>(p[alpha]));
        range.second = std::max(range.second, static_cast<float>(p[alpha]));
    }
    return range;
}

/// Channels of the nearest pixel.
class NearestPixel {
  public:
    NearestPixel(const ImageBuf& picture, const ImageSpec& target)
        : picture_(picture),
          from_x_(axis_x(picture.spec())),
          from_y_(axis_y(picture.spec())),
          to_x_(axis_x(target)),
          to_y_(axis_y(target)) {}
    /// Black outside of the data window.
    void read(int x, int y, float* to) const {
        picture_.getpixel(place(x, to_x_, from_x_), place(y, to_y_, from_y_), to,
                          picture_.nchannels());
    }

  private:
    static int place(int at, const Axis& to, const Axis& from) {
        const double share = (at + 0.5 - to.begin) / (to.end - to.begin);
        return from.begin + static_cast<int>(std::floor(share * (from.end - from.begin)));
    }

    const ImageBuf& picture_;
    Axis from_x_, from_y_, to_x_, to_y_;
};

}  // namespace

ResizeSize parse_resize(std::string_view text) {
    if (text.ends_with('%')) {
        const std::string_view number = text.substr(0, text.size() - 1);
        double percent = 0;
        const char* const end = number.data() + number.size();
        const auto [stop, error] =
            std::from_chars(number.data(), end, percent, std::chars_format::fixed);
        if (error != std::errc() || stop != end || !(percent > 0) || !std::isfinite(percent))
            refuse_text(text);
        return {0, 0, percent};
    }
    const std::size_t x = text.find('x');
    if (x == std::string_view::npos) return {parse_side(text, text), 0, 0};
    return {parse_side(text.substr(0, x), text), parse_side(text.substr(x + 1), text), 0};
}

ImageSpec resized_spec(const ImageSpec& picture, std::string_view size, double max_pixels) {
    if (picture.depth > 1) {
        throw PictureError(Problem{.value = fmt::format("picture has {} slices", picture.depth),
                                   .expected = "a flat picture with <<resize>>"});
    }
    const ResizeSize requested = parse_resize(size);
    const Axis x = axis_x(picture);
    const Axis y = axis_y(picture);
    double width = x.end - x.begin;
    double height = y.end - y.begin;
    // Orientations 5 to 8 lie on their side: JEITA CP-3451, 4.6.4.
    const bool lies = orientation_of(picture_spec(picture)) >= 5;
    if (lies) std::swap(width, height);
    if (requested.percent > 0) {
        width *= requested.percent / 100;
        height *= requested.percent / 100;
    } else {
        height = requested.height > 0 ? requested.height : height * requested.width / width;
        width = requested.width;
    }
    width = std::max(std::round(width), 1.0);
    height = std::max(std::round(height), 1.0);
    const auto check = [&](double w, double h) {
        if (w * h <= max_pixels) return;
        throw PictureError(
            {.parameter = "resize",
             .value = fmt::format("{}: {:.0f} x {:.0f} pixels", size, w, h),
             .expected = fmt::format("at most {:.0f} in all (<<max_pixels>>)", max_pixels)});
    };
    check(width, height);
    if (lies) std::swap(width, height);
    const Axis to_x = resized(x, static_cast<int>(width));
    const Axis to_y = resized(y, static_cast<int>(height));
    check(to_x.data_end - to_x.data_begin, to_y.data_end - to_y.data_begin);

    ImageSpec spec = picture;
    spec.x = to_x.data_begin;
    spec.width = to_x.data_end - to_x.data_begin;
    spec.full_x = to_x.begin;
    spec.full_width = to_x.end - to_x.begin;
    spec.y = to_y.data_begin;
    spec.height = to_y.data_end - to_y.data_begin;
    spec.full_y = to_y.begin;
    spec.full_height = to_y.end - to_y.begin;
    spec.tile_width = spec.tile_height = spec.tile_depth = 0;
    if (requested.height > 0)
        keep_shape(spec, width / (x.end - x.begin), height / (y.end - y.begin));
    for (const char* name : {"Exif:PixelXDimension", "Exif:PixelYDimension"})
        erase_attribute(spec, name);
    return spec;
}

ImageSpec light_spec(const ImageSpec& resized, const SourceColor& color,
                     TonemapOptions::Unpremult unpremult) {
    ImageSpec spec = resized;
    spec.set_format(OIIO::TypeFloat);
    spec.channelformats.clear();
    if (unpremult == TonemapOptions::Unpremult::automatic)
        erase_attribute(spec, "oiio:UnassociatedAlpha");
    change_spec(spec, [&](PictureSpec& of) { tag_as_light(of, color); });
    return spec;
}

ImageBuf resized_light(const ImageBuf& picture, const SourceColor& color,
                       const TonemapOptions& options, const ImageSpec& target, int nthreads) {
    const LightRows rows(picture, color, options);
    const int colors = rows.colors();
    ImageBuf light = light_of(picture, rows, target, nthreads);
    const bool has_alpha = rows.alpha() >= 0;
    const auto [least_alpha, most_alpha] =
        has_alpha ? alpha_range(light, colors) : std::pair(0.0F, 1.0F);
    const double white = std::exp2(-options.exposure_stops) /
                         scene_scale(in_units(color, options.input_units), options.reference_white);
    std::optional<ImageBuf> lamps = take_lamps(light, colors, static_cast<float>(white), nthreads);
    ImageBuf small = filtered(light, kFilter, target, nthreads);
    light.clear();
    if (lamps) lamps = filtered(*lamps, kFilterOfLamps, target, nthreads);

    ImageBuf result = black_picture(target);
    const NearestPixel nearest(picture, target);
    const auto n = static_cast<std::size_t>(target.width);
    const auto all = static_cast<std::size_t>(target.nchannels);
    const auto some = static_cast<std::size_t>(small.nchannels());
    const auto color_count = static_cast<std::size_t>(colors);
    const float most = most_alpha;
    const bool limits = has_alpha && least_alpha >= 0;
    for_rows(rows_of(result.roi()), nthreads, [&](int y) {
        float* from = row_of(small, y);
        const float* lamp = lamps ? row_of(*lamps, y) : nullptr;
        float* to = row_of(result, y);
        for (std::size_t i = 0; i < n; ++i) {
            float* pixel = from + i * some;
            if (limits) limit_alpha(pixel, colors, most);
            if (all > some) nearest.read(target.x + static_cast<int>(i), y, to + i * all);
            for (std::size_t c = 0; c < color_count; ++c)
                to[i * all + c] = pixel[c] + (lamp ? lamp[i * color_count + c] : 0);
            if (has_alpha) to[i * all + static_cast<std::size_t>(rows.alpha())] = pixel[colors];
        }
    });
    return result;
}

ImageBuf resized_picture(const ImageBuf& picture, std::string_view size,
                         const TonemapOptions& options, double max_pixels, int nthreads) {
    const SourceColor color = source_color(picture_spec(picture.spec()), options.input);
    const ImageSpec target =
        light_spec(resized_spec(picture.spec(), size, max_pixels), color, options.unpremult);
    return resized_light(picture, color, options, target, nthreads);
}

TONEWRIGHT_NAMESPACE_END
