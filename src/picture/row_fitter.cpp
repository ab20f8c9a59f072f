// SPDX-License-Identifier: Apache-2.0
#include "picture/row_fitter.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

#include "picture/color_tags.h"
#include "picture/compression.h"
#include "picture/pixel_access.h"
#include "picture/row_pass.h"
#include "picture/source_pixels.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Bytes = std::vector<std::byte>;
constexpr OIIO::TypeDesc kFloat(OIIO::TypeDesc::FLOAT);

/// The bits of 1 in a pixel type; integers have their largest value.
Bytes one_of(const OIIO::TypeDesc& type) {
    Bytes bytes(size_of(type));
    const float one = 1;
    pixel_access(type)->store_float(&one, bytes.data(), 0, 1);
    return bytes;
}

/// Rows in memory of their own, if a step changes them.
class ChangedRows {
  public:
    ChangedRows(const RowFitter::Rows& rows, std::size_t count, std::size_t channels)
        : rows_(rows), count_(count), channels_(channels) {}

    [[nodiscard]] const RowFitter::Rows& rows() const { return rows_; }
    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] std::size_t channels() const { return channels_; }

    /// Floats that may be changed.
    [[nodiscard]] float* floats() {
        if (!is_own_ || rows_.type != kFloat) {
            Bytes converted(count_ * channels_ * sizeof(float));
            auto* const to = reinterpret_cast<float*>(converted.data());
            pixel_access(rows_.type)->run_to_float(rows_.pixels, to, count_ * channels_);
            take(std::move(converted), kFloat, channels_);
        }
        return reinterpret_cast<float*>(own_.data());
    }
    [[nodiscard]] std::byte* bytes() {
        if (!is_own_) {
            const std::size_t size = count_ * channels_ * size_of(rows_.type);
            take(Bytes(rows_.pixels, rows_.pixels + size), rows_.type, channels_);
        }
        return own_.data();
    }
    void take(Bytes&& pixels, const OIIO::TypeDesc& type, std::size_t channels) {
        own_ = std::move(pixels);
        is_own_ = true;
        rows_.type = type;
        rows_.pixels = own_.data();
        channels_ = channels;
    }

  private:
    RowFitter::Rows rows_;
    std::size_t count_;
    std::size_t channels_;
    Bytes own_;
    bool is_own_ = false;
};

void select_channels(ChangedRows& rows, const std::vector<int>& channels) {
    const OIIO::TypeDesc type = rows.rows().type;
    const std::size_t size = size_of(type);
    const PixelAccess& access = *pixel_access(type);
    const auto stride = static_cast<std::ptrdiff_t>(size * rows.channels());
    const auto to_stride = static_cast<std::ptrdiff_t>(size * channels.size());
    const Bytes one = one_of(type);
    Bytes selected(rows.count() * size * channels.size());
    for (std::size_t c = 0; c < channels.size(); ++c) {
        std::byte* const to = selected.data() + c * size;
        if (channels[c] < 0) {
            access.copy(one.data(), 0, to, to_stride, rows.count());
        } else {
            access.copy(rows.rows().pixels + static_cast<std::size_t>(channels[c]) * size, stride,
                        to, to_stride, rows.count());
        }
    }
    rows.take(std::move(selected), type, channels.size());
}

void put_over(ChangedRows& rows, int alpha, const std::array<float, 3>& background) {
    const auto at = static_cast<std::size_t>(alpha);
    const std::size_t colors = std::min<std::size_t>(at, 3);
    float* pixel = rows.floats();
    for (std::size_t i = 0; i < rows.count(); ++i, pixel += rows.channels()) {
        const float cover = std::isfinite(pixel[at]) ? std::clamp<float>(pixel[at], 0, 1) : 0;
        for (std::size_t c = 0; c < colors; ++c)
            pixel[c] = pixel[c] + (1 - cover) * background.at(c);
    }
}

/// Does what OIIO::ImageBufAlgo::unpremult() does: all channels but alpha and depth.
void divide_by_alpha(float* pixel, std::size_t count, std::size_t channels, int alpha, int depth) {
    for (std::size_t i = 0; i < count; ++i, pixel += channels) {
        const float cover = pixel[alpha];
        if (cover == 0 || cover == 1) continue;
        for (std::size_t c = 0; c < channels; ++c) {
            const auto channel = static_cast<int>(c);
            if (channel != alpha && channel != depth) pixel[c] /= cover;
        }
    }
}

}  // namespace

PixelWindow data_window(const PictureSpec& spec) {
    return {spec.x, spec.x + spec.width, spec.y, spec.y + spec.height};
}

PixelWindow display_window(const PictureSpec& spec) {
    return {spec.full_x, spec.full_x + spec.full_width, spec.full_y,
            spec.full_y + spec.full_height};
}

std::string percent_text(double share) {
    return fmt::format("{:.3g}", std::ceil(1000 * share) / 10);
}

std::string title_of_type(const OIIO::TypeDesc& type) {
    if (type == OIIO::TypeDesc::UINT8) return "8 bits";
    if (type == OIIO::TypeDesc::UINT16) return "16 bits";
    return name_of(type);
}

OIIO::TypeDesc openexr_type(const OIIO::TypeDesc& source) {
    return source == OIIO::TypeDesc::HALF || size_of(source) == 1 ? OIIO::TypeDesc::HALF
                                                                  : OIIO::TypeDesc::FLOAT;
}

void multiply_by_alpha(float* pixels, std::size_t count, std::size_t channels, int alpha) {
    const int colors = std::min(alpha, 3);
    for (std::size_t i = 0; i < count; ++i, pixels += channels) {
        for (int c = 0; c < colors; ++c)
            pixels[c] = pixels[c] * pixels[alpha];
    }
}

void take_alpha(TonemapOptions& tonemap, const WriteOptions& write) {
    const bool is_ignored = write.alpha == WriteOptions::Alpha::ignore;
    if (!is_ignored && write.alpha != WriteOptions::Alpha::opaque) return;
    if (tonemap.unpremult == TonemapOptions::Unpremult::yes) {
        throw Error({.parameter = "alpha",
                     .value = is_ignored ? "ignore" : "opaque",
                     .expected = "keep with <<unpremult=yes>>, which divides by alpha"});
    }
    tonemap.unpremult = TonemapOptions::Unpremult::no;
}

RowFitter::RowFitter(std::string_view format, std::string_view codec, WriteOptions options)
    : format_(format), codec_(codec), options_(std::move(options)) {}

void RowFitter::keep_type(const OIIO::TypeDesc& source) {
    if (format_ != "openexr" || options_.type != OIIO::TypeDesc::UNKNOWN ||
        source == OIIO::TypeDesc::UNKNOWN)
        return;
    options_.type = openexr_type(source);
}

void RowFitter::plan_alpha(PictureSpec& spec) {
    using Alpha = WriteOptions::Alpha;
    const bool is_straight =
        spec.alpha_channel >= 0 && spec.get_int_attribute("oiio:UnassociatedAlpha") != 0;
    const FileAlpha kind = format_limits(format_).alpha;
    const bool keeps = kind == FileAlpha::straight || kind == FileAlpha::either;
    multiplies_by_alpha_ =
        is_straight && (options_.alpha == Alpha::over || (options_.alpha == Alpha::keep && !keeps));
    if (multiplies_by_alpha_ || spec.alpha_channel < 0 || options_.alpha == Alpha::ignore)
        spec.erase_attribute("oiio:UnassociatedAlpha");
}

void RowFitter::plan_channels(PictureSpec& spec, const FormatLimits& limits) {
    const bool is_over = options_.alpha == WriteOptions::Alpha::over && spec.alpha_channel >= 0;
    const std::array<float, 3>& back = options_.background;
    if (is_over && spec.nchannels < 3 && (back[0] != back[1] || back[1] != back[2])) {
        throw FileError(
            fmt::format("alpha is over:{},{},{}; expected three equal numbers, because the picture "
                        "is gray",
                        back[0], back[1], back[2]));
    }
    plan_alpha(spec);
    channels_ =
        file_channels(spec, limits, options_.alpha == WriteOptions::Alpha::ignore || is_over);
    if (channels_.empty()) {
        throw FileError(fmt::format("the picture is in color; expected gray for {}", limits.title));
    }
    std::vector<int> all(static_cast<std::size_t>(spec.nchannels));
    std::iota(all.begin(), all.end(), 0);
    if (channels_ == all) {
        channels_.clear();
        return;
    }
    const PictureSpec whole = spec;
    const bool becomes_rgb = channels_.size() >= 3 && channels_[0] == channels_[1];
    spec.nchannels = static_cast<int>(channels_.size());
    spec.channelnames.clear();
    spec.alpha_channel = spec.z_channel = -1;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        constexpr std::array kNew = {'R', 'G', 'B', 'A'};
        const bool is_new = (becomes_rgb && c < 3) || channels_[c] < 0;
        spec.channelnames.push_back(is_new ? std::string(1, kNew.at(c))
                                           : std::string(whole.channel_name(channels_[c])));
        if (whole.alpha_channel >= 0 && channels_[c] == whole.alpha_channel)
            spec.alpha_channel = static_cast<int>(c);
        if (is_equal_but_for_case(spec.channelnames.back(), "Z"))
            spec.z_channel = static_cast<int>(c);
    }
}

void RowFitter::plan_window(PictureSpec& spec, const FormatLimits& limits) {
    // Viewers show the display window. Formats without data windows store only that.
    const PixelWindow window = display_window(picture_);
    const PixelWindow data = data_window(picture_);
    window_.reset();
    next_row_ = data.ybegin;
    const bool is_kept = limits.windows == FileWindows::all ||
                         (limits.windows == FileWindows::not_negative && data.xbegin >= 0 &&
                          data.ybegin >= 0 && window.xbegin == 0 && window.ybegin == 0 &&
                          window.xend >= data.xend && window.yend >= data.yend);
    if (window == data || is_kept || picture_.depth > 1) return;
    const auto pixels = [](const PixelWindow& of) {
        return static_cast<double>(of.width()) * of.height();
    };
    const double most = std::max(options_.max_pixels, 4 * pixels(data));
    if (pixels(window) > most) {
        throw FileError(Problem{
            .value = fmt::format("the display window is {} x {} pixels, the data window {} x {}",
                                 window.width(), window.height(), data.width(), data.height()),
            .expected =
                fmt::format("at most {:.0f} pixels (<<max_pixels>>) to fill with black", most)});
    }
    window_ = window;
    next_row_ = window.ybegin;
    spec.x = spec.y = spec.z = spec.full_x = spec.full_y = spec.full_z = 0;
    spec.width = spec.full_width = window.width();
    spec.height = spec.full_height = window.height();
}

void RowFitter::plan_cover(PictureSpec& spec, const FormatLimits& limits) {
    // OIIO's writers divide integers, rounding down, and for "Gamma2.2" and similar spaces some
    // divide by a power of alpha: 0.25 of 0.5 becomes 1.
    const bool is_associated =
        spec.alpha_channel >= 0 && spec.get_int_attribute("oiio:UnassociatedAlpha") == 0;
    divides_by_alpha_ = is_associated && limits.alpha == FileAlpha::straight;
    if (divides_by_alpha_) spec.attribute("oiio:UnassociatedAlpha", 1);
    // Displays end at 1, light does not: above it, an opaque surface is clipped, too.
    const std::optional<TaggedColor> shown = tagged_color(picture_);
    const bool is_light = shown && shown->curve && shown->curve->exponent == 1;
    surface_light_ = is_light ? static_cast<float>(kMostSurfaceLight) : 1.0F;
    becomes_straight_ =
        divides_by_alpha_ || (is_associated && limits.alpha == FileAlpha::straight_by_writer);
    alpha_ = spec.alpha_channel < spec.nchannels ? spec.alpha_channel : -1;
    z_ = spec.z_channel;
    // OpenEXR's viewers show color with zero alpha, and elements such as flames have nothing else.
    watches_cover_ =
        alpha_ >= 0 && options_.alpha == WriteOptions::Alpha::keep && format_ != "openexr";
}

void RowFitter::plan_type(PictureSpec& spec, const FormatLimits& limits) const {
    OIIO::TypeDesc type = limits.is_8_bit ? OIIO::TypeDesc(OIIO::TypeDesc::UINT8) : options_.type;
    const std::optional<TaggedColor> color = tagged_color(picture_);
    // ITU-R BT.2100-2 has 10 and 12 bits: 8 show bands.
    if (type == OIIO::TypeDesc::UNKNOWN && format_ == "png" && color && color->code_points &&
        is_floating_point(picture_.format)) {
        type = OIIO::TypeDesc::UINT16;
    }
    spec.format = type == OIIO::TypeDesc::UNKNOWN ? picture_.format : type;
    if (type != OIIO::TypeDesc::UNKNOWN)
        spec.erase_attribute("oiio:BitsPerSample");  // overrules the type
    if (options_.bits > 0) spec.attribute("oiio:BitsPerSample", options_.bits);
}

PictureSpec RowFitter::open(const PictureSpec& picture) {
    picture_ = picture;
    PictureSpec spec = picture;
    spec.tile_width = spec.tile_height = spec.tile_depth = 0;  // those of the file it came from
    spec.channelformats.clear();
    // A single level is not a texture: OpenEXR's writer would wait for the others.
    if (spec.get_string_attribute("textureformat") == "Plain Texture")
        spec.erase_attribute("textureformat");
    const FormatLimits& limits = format_limits(format_);
    plan_channels(spec, limits);
    plan_window(spec, limits);
    if (const std::string refusal = size_refusal(limits, spec.width, spec.height); !refusal.empty())
        throw FileError(refusal);
    plan_cover(spec, limits);
    plan_type(spec, limits);
    channel_count_ = spec.nchannels;
    set_compression(spec, codec_, {options_.compression, options_.quality, options_.subsampling});
    if (format_ == "openexr") return spec;  // the only format whose color tags they are
    erase_attributes(spec, "colorInteropID");
    if (format_ != "png" || !options_.write_provenance) erase_attributes(spec, "tonewright:*");
    return spec;
}

OIIO::TypeDesc RowFitter::row_type(const OIIO::TypeDesc& file) const {
    return file == OIIO::TypeDesc::HALF && !divides_by_alpha_ && !multiplies_by_alpha_
               ? OIIO::TypeDesc::HALF
               : OIIO::TypeDesc::FLOAT;
}

std::string RowFitter::cut_off() const {
    const PixelWindow data = data_window(picture_);
    PixelWindow shown = data;
    if (window_) {
        shown = {std::max(data.xbegin, window_->xbegin), std::min(data.xend, window_->xend),
                 std::max(data.ybegin, window_->ybegin), std::min(data.yend, window_->yend)};
    }
    const double lost = shown.width() > 0 && shown.height() > 0
                            ? 1 - static_cast<double>(shown.width()) * shown.height() /
                                      (static_cast<double>(data.width()) * data.height())
                            : 1;
    if (lost <= 0) return {};
    if (lost >= 1) {
        return fmt::format(
            "all of the data window lies outside the display window, so the picture "
            "is black; {} has no data window",
            format_);
    }
    return fmt::format(
        "{} % of the data window lies outside the display window and is left out; {} has no data "
        "window",
        percent_text(lost), format_);
}

void RowFitter::watch_cover(const float* pixels, std::size_t count) {
    const auto channels = static_cast<std::size_t>(channel_count_);
    const auto colors = std::min(alpha_, 3);
    // Operators lift black by up to two codes of 8 bits (AgX: 0.7), also where nothing is.
    constexpr float kVisible = 2.0F / 255;
    for (std::size_t i = 0; i < count; ++i, pixels += channels) {
        const float alpha = pixels[alpha_];
        if (alpha != 0) has_cover_ = true;
        const float most = *std::max_element(pixels, pixels + colors);
        const float carried = surface_light_ * std::max(alpha, 0.0F);
        if (alpha < 1 && most > carried + kVisible) ++lost_count_;
    }
    pixel_count_ += static_cast<double>(count);
}

std::string RowFitter::lost_cover() const {
    if (!watches_cover_) return {};
    if (!has_cover_) {
        return "alpha is 0 everywhere, so viewers show nothing; <<alpha=ignore>> leaves it out, "
               "<<alpha=opaque>> makes it 1";
    }
    if (!becomes_straight_ || lost_count_ == 0) return {};
    return fmt::format(
        "{} % of the pixels have more light than their alpha carries (flames, "
        "glass), and {} cannot hold it; <<alpha=opaque>> or ignore keeps it, as "
        "does EXR",
        percent_text(lost_count_ / std::max(pixel_count_, 1.0)), format_);
}

void RowFitter::run(const Rows& given, const std::function<void(const Rows&)>& write) {
    check_pixel_type("source", given.type);
    const auto width = static_cast<std::size_t>(picture_.width);
    const std::size_t count = width * static_cast<std::size_t>(given.yend - given.ybegin) *
                              static_cast<std::size_t>(std::max(picture_.depth, 1));
    ChangedRows rows(given, count, static_cast<std::size_t>(picture_.nchannels));
    if (multiplies_by_alpha_)
        multiply_by_alpha(rows.floats(), count, rows.channels(), picture_.alpha_channel);
    if (options_.alpha == WriteOptions::Alpha::over && picture_.alpha_channel >= 0)
        put_over(rows, picture_.alpha_channel, options_.background);
    if (!channels_.empty()) select_channels(rows, channels_);
    if (watches_cover_ && (!has_cover_ || becomes_straight_)) {
        constexpr std::size_t kPixels = 4096;
        std::vector<float> part(std::min(count, kPixels) * rows.channels());
        const PixelAccess& access = *pixel_access(rows.rows().type);
        const std::size_t bytes = rows.channels() * size_of(rows.rows().type);
        for (std::size_t i = 0; i < count; i += kPixels) {
            const std::size_t n = std::min(kPixels, count - i);
            access.run_to_float(rows.rows().pixels + i * bytes, part.data(), n * rows.channels());
            watch_cover(part.data(), n);
        }
    }
    if (alpha_ >= 0 && options_.alpha == WriteOptions::Alpha::opaque) {
        const OIIO::TypeDesc type = rows.rows().type;
        const auto stride = static_cast<std::ptrdiff_t>(rows.channels() * size_of(type));
        std::byte* const pixels = rows.bytes();
        pixel_access(type)->copy(one_of(type).data(), 0,
                                 pixels + static_cast<std::size_t>(alpha_) * size_of(type), stride,
                                 count);
    }
    if (!window_) {
        write_part(rows.rows(), width, write);
        return;
    }
    // Adds the black rows above the first and below the last, some at a time.
    const PixelWindow data = data_window(picture_);
    const int end = given.yend == data.yend ? window_->yend : std::min(given.yend, window_->yend);
    const auto shown_width = static_cast<std::size_t>(window_->width());
    const std::size_t pixel = rows.channels() * size_of(rows.rows().type);
    const int step =
        rows_of_batch(shown_width * rows.channels() * sizeof(float), 1, window_->height());
    const int left = std::max(window_->xbegin, data.xbegin);
    const int right = std::min(window_->xend, data.xend);
    while (next_row_ < end) {
        Rows part = rows.rows();
        part.ybegin = next_row_;
        part.yend = std::min(next_row_ + step, end);
        next_row_ = part.yend;
        Bytes shown(shown_width * static_cast<std::size_t>(part.yend - part.ybegin) * pixel);
        for (int y = std::max(part.ybegin, given.ybegin);
             right > left && y < std::min(part.yend, given.yend); ++y) {
            const std::size_t from = static_cast<std::size_t>(y - given.ybegin) * width +
                                     static_cast<std::size_t>(left - data.xbegin);
            const std::size_t to = static_cast<std::size_t>(y - part.ybegin) * shown_width +
                                   static_cast<std::size_t>(left - window_->xbegin);
            std::memcpy(shown.data() + to * pixel, rows.rows().pixels + from * pixel,
                        static_cast<std::size_t>(right - left) * pixel);
        }
        part.ybegin -= window_->ybegin;
        part.yend -= window_->ybegin;
        part.pixels = shown.data();
        write_part(part, shown_width, write);
    }
}

void RowFitter::write_part(const Rows& rows, std::size_t width,
                           const std::function<void(const Rows&)>& write) {
    if (!divides_by_alpha_) {
        write(rows);
        return;
    }
    const std::size_t count = width * static_cast<std::size_t>(rows.yend - rows.ybegin) *
                              static_cast<std::size_t>(std::max(picture_.depth, 1));
    ChangedRows divided(rows, count, static_cast<std::size_t>(channel_count_));
    divide_by_alpha(divided.floats(), count, divided.channels(), alpha_, z_);
    write(divided.rows());
}

TONEWRIGHT_NAMESPACE_END
